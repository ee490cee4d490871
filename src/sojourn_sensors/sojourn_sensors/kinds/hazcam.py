"""The hazard camera: /hazcam/points, where asked for of the ground as it is now, and of what of the machine it sees."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sojourn_contract import stamps
from sojourn_contract.clouds import point_cloud
from sojourn_contract.ground import GROUND
from sojourn_contract.topics import topic
from sojourn_machine.sensor_choice import SensorParams
from sojourn_machine.shapes import MachineShapes, Shapes
from sojourn_physics.imaging.ground import changes_within
from sojourn_physics.sensors import hazcam
from sojourn_physics.sensors.hazcam import HazcamParams
from sojourn_physics.sensors.noise import NoiseStream
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_sensors.fault_hooks import FaultNow
from sojourn_sensors.motion import rotation_matrix
from sojourn_sensors.seeing import heard_of
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

ROW = topic("/hazcam/points")
NO_POINTS = np.zeros((0, 3), dtype=np.float32)


class HazcamSensorParams(HazcamParams, SensorParams):
    """A stereo camera on its link."""

    kind: str = "hazcam"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    quantities: ClassVar[tuple[str, ...] | None] = ("",)
    has_lens: ClassVar[bool] = True
    hears: ClassVar[tuple[Any, ...]] = (GROUND,)
    sees_changes: bool = Field(
        default=False,
        description="whether it sees what wheels and tools do to the ground, which the plant tells it then",
    )

    @property
    def heard_rows(self) -> tuple[Any, ...]:
        """See SensorParams."""
        return self.hears if self.sees_changes else ()

    @classmethod
    def silence(cls, stamp: int) -> Iterable[tuple[str, Any]]:
        yield ROW.name, point_cloud(stamp, "base_link", NO_POINTS)

    def sensor(self, name: str, site: SensorSite) -> "HazcamSensor":
        """The camera of a machine."""
        return HazcamSensor(name, self, site)


@dataclass(frozen=True, eq=False, slots=True)
class HazcamMemory:
    """What it remembers: its noise, and what it was told of the ground."""

    noise: NoiseStream
    ground: GroundMemory


class HazcamSensor(Sensor[HazcamSensorParams, HazcamMemory, NDArray[np.float32]]):
    """Points in base_link, (n, 3) [m]; none without power, nor in the dark where it has no lamp."""

    every: ClassVar[int] = ROW.every

    def __init__(self, name: str, params: HazcamSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._camera = hazcam.hazcam_on(params, site.scenario.urdf_xml)
        self._lens_to_base, self._place = site.mounting(params.link)
        self._shapes = MachineShapes(site.scenario.urdf_xml, params.link) if params.sees_body else None
        self._sun = site.scenario.sun_over(lambda: site.ground)

    def initial_state(self, truth: Truth) -> HazcamMemory:
        noise = hazcam.initial_state(self._camera, self.site.seed, self.name)
        return HazcamMemory(noise, heard_of(self.site.untouched, truth))

    def step(self, state: HazcamMemory, truth: Truth, dt: float) -> tuple[HazcamMemory, NDArray[np.float32]]:
        position, rotation = truth.odometry.position, rotation_matrix(truth.odometry.orientation)
        ground = heard_of(state.ground, truth)
        x, y, _ = position + rotation @ self._place
        changes = changes_within(ground, float(x), float(y), self.params.range)
        seen = hazcam.HazcamView(self.site.ground, changes, self._body(truth))
        noise, points = hazcam.step(self._camera, state.noise, seen, position, rotation)
        return HazcamMemory(noise, ground), NO_POINTS if self._is_dark(truth) else points

    def step_without_power(self, state: HazcamMemory, truth: Truth, dt: float) -> tuple[HazcamMemory, None]:
        return self.hear(state, truth), None

    def hear(self, state: HazcamMemory, truth: Truth) -> HazcamMemory:
        ground = heard_of(state.ground, truth)
        return state if ground is state.ground else HazcamMemory(state.noise, ground)

    def _body(self, truth: Truth) -> Shapes | None:
        if self._shapes is None:
            return None
        _, _, body = self._shapes.at(truth.joints.names, truth.joints.position)
        return body

    def _is_dark(self, truth: Truth) -> bool:
        if self.params.least_light == 0.0:
            return False
        x, y, _ = truth.odometry.position
        light = self._sun.light(stamps.seconds(truth.stamp), float(x), float(y))
        return light.direct + light.diffuse < self.params.least_light

    def faulted(self, reading: NDArray[np.float32], fault: FaultNow) -> NDArray[np.float32]:
        """Dust on the lens hides what is behind it; all other faults are on the points."""
        if fault.params.dust == 0.0:
            return super().faulted(reading, fault)
        return reading[~fault.hidden((reading - self._place) @ self._lens_to_base)]

    def messages(self, stamp: int, reading: NDArray[np.float32] | None) -> Iterator[tuple[str, Any]]:
        yield self.topic, point_cloud(stamp, "base_link", NO_POINTS if reading is None else reading)
