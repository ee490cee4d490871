"""Bump switches: /bump/NAME."""

from collections.abc import Iterator
from typing import Any, ClassVar

from sojourn_contract.heartbeat import status_message
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_physics.imaging.camera import noise_of
from sojourn_physics.imaging.touch import BumpSwitchParams, face_of, is_closed
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_sensors.seeing import SeeingParams, SeeingSensor
from sojourn_sensors.sensor import SensorSite, Truth

ROW = Topic(
    "/bump",
    "diagnostic_msgs/DiagnosticArray",
    "sensors",
    (),
    5,
    0.5,
    "`contact`: closed while ground or a stone pushes the plate of the switch, else open; nothing without power",
    (FieldRule("status.values", ""),),
    all_named=True,
)
FARTHER = 10.0
"""The ground is looked for as far as the travel and so many deviations of it [-]."""


class BumpSwitchSensorParams(BumpSwitchParams, SeeingParams):
    """A bump switch on its link."""

    kind: str = "bump_switch"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    quantities: ClassVar[tuple[str, ...] | None] = ()

    def sensor(self, name: str, site: SensorSite) -> "BumpSwitch":
        """The switch of a machine."""
        return BumpSwitch(name, self, site)


class BumpSwitch(SeeingSensor[BumpSwitchSensorParams, bool]):
    """Its reading is whether it is closed."""

    every: ClassVar[int] = ROW.every

    def __init__(self, name: str, params: BumpSwitchSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._farthest = params.travel + FARTHER * params.repeatability

    def read(self, ground: GroundMemory, truth: Truth) -> bool:
        here, scenery = self.outlook(truth), self.site.scene.scenery
        places = face_of(self.params, scenery.node) @ here.turn.T + here.place
        way = scenery.way_ahead(places, here.turn[:, 0], ground, self._farthest)
        return is_closed(self.params, way, noise_of(self.site.seed, self.name, truth.stamp))

    def messages(self, stamp: int, reading: bool | None) -> Iterator[tuple[str, Any]]:
        values = {} if reading is None else {"contact": "closed" if reading else "open"}
        yield self.topic, status_message(stamp, self.name, values)
