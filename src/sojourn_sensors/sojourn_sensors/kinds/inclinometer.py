"""Inclinometers: /inclination/NAME."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from sojourn_contract import stamps
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.values import NOT_MEASURED, Vector3Stamped
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.sensors import inclinometer
from sojourn_physics.sensors.inclinometer import InclinometerParams, InclinometerState
from sojourn_sensors.load_temperature import LoadTemperature
from sojourn_sensors.motion import ImuMotion, MotionBefore
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

ROW = Topic(
    "/inclination",
    "geometry_msgs/Vector3Stamped",
    "sensors",
    (),
    5,
    0.5,
    "measured angles by which the x and the y axis of its link point above the horizontal, z is 0; NaN without power "
    "or gravity",
    (FieldRule("vector", "rad", low=-1.5, high=1.5, optional=True),),
    all_named=True,
)
NOTHING = np.full(3, NOT_MEASURED)


class InclinometerKindParams(SensorParams, InclinometerParams):
    """An inclinometer on its link. It is as warm as what its load warms in the machine's `thermal.yaml`."""

    kind: str = "inclinometer"
    temperature: float = Field(
        default=293.15, gt=0.0, le=1000.0, description="of the inclinometer where no thermal.yaml tells it [K]"
    )
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)

    def sensor(self, name: str, site: SensorSite) -> "Inclinometer":
        """The inclinometer of a machine."""
        return Inclinometer(name, self, site)


@dataclass(frozen=True, slots=True)
class InclinometerMemory:
    """Errors and pendulums, temperature [K], the motion at its last reading and the stamp of it [ns]."""

    inclinometer: InclinometerState
    temperature: float
    motion: MotionBefore | None
    stamp: int


class Inclinometer(Sensor[InclinometerKindParams, InclinometerMemory, FloatArray | None]):
    """It feels the mean specific force since its last reading."""

    every: ClassVar[int] = ROW.every

    def __init__(self, name: str, params: InclinometerKindParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._motion = ImuMotion(site.scenario.urdf_xml, site.scenario.gravity_field, params.link)
        self._temperature = LoadTemperature(name, site.scenario, params.temperature)

    def initial_state(self, truth: Truth) -> InclinometerMemory:
        drawn = inclinometer.initial_state(self.params, self.site.seed, self.site.scenario.gravity, self.name)
        return InclinometerMemory(drawn, self._temperature.at_first, None, truth.stamp)

    def step(self, state: InclinometerMemory, truth: Truth, dt: float) -> tuple[InclinometerMemory, FloatArray | None]:
        since = max(stamps.seconds(truth.stamp - state.stamp), dt)
        moved, motion = self._motion.felt(state.motion, truth.odometry, since)
        temperature = self._temperature.told(truth.inputs, state.temperature)
        warmer = temperature - self.params.calibration_temperature
        after, reading = inclinometer.step(self.params, state.inclinometer, motion.specific_force, since, warmer)
        return InclinometerMemory(after, temperature, moved, truth.stamp), reading

    def step_without_power(self, state: InclinometerMemory, truth: Truth, dt: float) -> tuple[InclinometerMemory, None]:
        return self.step(state, truth, dt)[0], None

    def messages(self, stamp: int, reading: FloatArray | None) -> Iterator[tuple[str, Any]]:
        vector = NOTHING if reading is None else np.append(reading, 0.0)
        yield self.topic, Vector3Stamped(stamp, self.params.link, vector)
