"""Point spectrometers: /soil/NAME, the name of the soil that x of their link points at."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from sojourn_contract.heartbeat import status_message
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_physics.imaging.camera import LINK_TO_OPTICAL, DetectorParams, Optics, noise_of
from sojourn_physics.imaging.lens import LensParams
from sojourn_physics.imaging.ranging import WIDEST, Beams
from sojourn_physics.imaging.spectrometer import SpectrometerParams, named
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_sensors.seeing import Outlook, SeeingParams, SeeingSensor
from sojourn_sensors.sensor import SensorSite, Truth

ROW = Topic(
    "/soil",
    "diagnostic_msgs/DiagnosticArray",
    "sensors",
    (),
    50,
    3.0,
    "`soil`: the name that a spectrometer gives the soil before it, else in words why it gives none; nothing without "
    "power",
    (FieldRule("status.values", ""), FieldRule("status.message", "")),
    all_named=True,
)
DARK, NOTHING = "too dark", "no ground within its range"
AHEAD = np.array([[1.0, 0.0, 0.0]])


class SpectrometerSensorParams(SpectrometerParams, SeeingParams):
    """A point spectrometer on its link, along x."""

    kind: str = "spectrometer"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    quantities: ClassVar[tuple[str, ...] | None] = ()

    @property
    def soils(self) -> tuple[str, ...]:
        return tuple(self.confusion)

    def sensor(self, name: str, site: SensorSite) -> "Spectrometer":
        """The spectrometer of a machine."""
        return Spectrometer(name, self, site)


@dataclass(frozen=True, slots=True)
class Named:
    """A reading: a name, or why there is none."""

    soil: str = ""
    why: str = ""


class Spectrometer(SeeingSensor[SpectrometerSensorParams, Named]):
    """It tells the soil of where the middle of its spot meets the ground."""

    every: ClassVar[int] = ROW.every

    def __init__(self, name: str, params: SpectrometerSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._beam = Beams(AHEAD, WIDEST, params.range)
        self._eye = _eye(params.spot_deg)

    def read(self, ground: GroundMemory, truth: Truth) -> Named:
        here, scenery = self.outlook(truth), self.site.scene.scenery
        at, _ = scenery.sound(self._beam, ground, here.body, here.turn, here.place)
        bare, _ = scenery.sound(self._beam, ground, here.body.none(), here.turn, here.place)
        x, y, _ = here.place + float(at[0]) * here.turn[:, 0] if math.isfinite(at[0]) else np.full(3, math.nan)
        field = self.site.ground
        low_x, high_x, low_y, high_y = field.bounds
        if not (at[0] <= self.params.range and at[0] == bare[0] and low_x <= x <= high_x and low_y <= y <= high_y):
            return Named(why=NOTHING)
        if not self.params.lamp and self._light(ground, here, truth) < self.params.least_radiance:
            return Named(why=DARK)
        return Named(named(self.params, field.soil_name(x, y), noise_of(self.site.seed, self.name, truth.stamp)))

    def _light(self, ground: GroundMemory, here: Outlook, truth: Truth) -> float:
        """Radiance of the spot [W/m2/sr]."""
        scene = self.site.scene
        moment = scene.moment(truth.stamp, here.place, ground, here.body)
        ((radiance, _),) = scene.scenery.see(self._eye, moment, here.turn @ LINK_TO_OPTICAL, [here.place])
        return float(radiance[0, 0])

    def messages(self, stamp: int, reading: Named | None) -> Iterator[tuple[str, Any]]:
        told = Named() if reading is None else reading
        values = {"soil": told.soil} if told.soil else {}
        yield self.topic, status_message(stamp, self.name, values, told.why)


def _eye(spot_deg: float) -> Optics:
    """An image of one pixel, as large as the spot."""
    lens = LensParams(columns=2, rows=2, horizontal_view_deg=2.0 * spot_deg)
    ray = np.array([[[0.0, 0.0, 1.0]]], dtype=np.float32)
    return Optics(lens, DetectorParams(), ray, np.ones((1, 1), dtype=np.float32))
