"""Range finders: /NAME/range, the distance to the nearest that returns something of their beam or cone."""

import math
from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np

from sojourn_contract.codecs.ros_library import stamped
from sojourn_contract.field_rules import FLOAT32_TOLERANCE
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.types import message_class
from sojourn_contract.values import NOT_MEASURED
from sojourn_physics.imaging.camera import noise_of
from sojourn_physics.imaging.range_finder import RangeFinderParams, cone_of, nearest_return
from sojourn_physics.imaging.ranging import within
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_sensors.seeing import SeeingParams, SeeingSensor
from sojourn_sensors.sensor import SensorSite, Truth

ROW = Topic(
    "/{name}/range",
    "sensor_msgs/Range",
    "sensors",
    (),
    5,
    0.5,
    "measured distance along x of its link to the nearest thing in its cone; NaN without power",
    (
        FieldRule(
            "range", "m", low=0.0, high=5000.0, tolerance=FLOAT32_TOLERANCE, optional=True, infinite=True
        ),
    ),
)  # fmt: skip
ULTRASOUND, INFRARED = 0, 1
"""What a Range says that it is measured with."""
TOLD = {"infrared": INFRARED, "ultrasound": ULTRASOUND, "radar": INFRARED}
"""The message knows no radar: it is told as the other that is no sound."""


class RangeFinderSensorParams(RangeFinderParams, SeeingParams):
    """A range finder on its link, along x."""

    kind: str = "range_finder"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    quantities: ClassVar[tuple[str, ...] | None] = ("",)

    @property
    def needs_air(self) -> bool:
        return self.radiation == "ultrasound"

    def sensor(self, name: str, site: SensorSite) -> "RangeFinder":
        """The range finder of a machine."""
        return RangeFinder(name, self, site)


class RangeFinder(SeeingSensor[RangeFinderSensorParams, float]):
    """Its reading is a distance [m], infinite where it is none."""

    every: ClassVar[int] = ROW.every

    def __init__(self, name: str, params: RangeFinderSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._cone = cone_of(params)

    def read(self, ground: GroundMemory, truth: Truth) -> float:
        here = self.outlook(truth)
        distance, returned = self.site.scene.scenery.sound(self._cone, ground, here.body, here.turn, here.place)
        return nearest_return(self.params, distance, returned, noise_of(self.site.seed, self.name, truth.stamp))

    def messages(self, stamp: int, reading: float | None) -> Iterator[tuple[str, Any]]:
        params = self.params
        said = message_class(ROW.type)(
            radiation_type=TOLD[params.radiation],
            field_of_view=math.radians(params.field_of_view_deg),
            min_range=params.nearest,
            max_range=params.range,
            range=NOT_MEASURED if reading is None else float(within(params, np.asarray(reading))),
        )
        yield self.topic, stamped(said, stamp, params.link)
