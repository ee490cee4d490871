"""The inertial measurement unit: /imu/data."""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from sojourn_contract.topics import topic
from sojourn_contract.values import NOT_MEASURED, Imu
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.sensors import imu
from sojourn_physics.sensors.imu import ImuParams, ImuReading
from sojourn_sensors.load_temperature import LoadTemperature
from sojourn_sensors.motion import ImuMotion, MotionBefore
from sojourn_sensors.sensor import Sensor, SensorSite, Truth


class ImuSensorParams(ImuParams, SensorParams):
    """An IMU on the link `imu_link`. It is as warm as what its load warms in the machine's `thermal.yaml`."""

    kind: str = "imu"
    temperature: float = Field(
        default=293.15, gt=0.0, le=1000.0, description="of the IMU where no thermal.yaml tells it [K]"
    )
    speaks_on: ClassVar[tuple[Any, ...]] = (topic("/imu/data"),)
    quantities: ClassVar[tuple[str, ...] | None] = tuple(field.name for field in fields(ImuReading))

    def sensor(self, name: str, site: SensorSite) -> "ImuSensor":
        """The IMU of a machine."""
        return ImuSensor(name, self, site)


@dataclass(frozen=True, slots=True)
class ImuSensorState:
    """Errors, attitude and temperature [K] of the IMU, and the motion of the period before."""

    imu: imu.ImuState
    temperature: float
    motion: MotionBefore | None = None


class ImuSensor(Sensor[ImuSensorParams, ImuSensorState, ImuReading]):
    """Without power its numbers are none, and its errors go on."""

    def __init__(self, name: str, params: ImuSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._motion = ImuMotion(site.scenario.urdf_xml, site.scenario.gravity_field)
        self._temperature = LoadTemperature(name, site.scenario, params.temperature)

    def initial_state(self, truth: Truth) -> ImuSensorState:
        heading = imu.heading_of(self._motion.orientation_imu_in_map(truth.odometry.orientation))
        errors = imu.initial_state(self.params, self.site.seed, heading, self.site.scenario.gravity, self.name)
        return ImuSensorState(errors, self._temperature.at_first)

    def step(self, state: ImuSensorState, truth: Truth, dt: float) -> tuple[ImuSensorState, ImuReading]:
        moved, motion = self._motion.felt(state.motion, truth.odometry, dt)
        rate, force = motion.angular_velocity, motion.specific_force
        temperature = self._temperature.told(truth.inputs, state.temperature)
        after, reading = imu.step(self.params, state.imu, rate, force, dt, temperature)
        return ImuSensorState(after, temperature, moved), reading

    def step_without_power(self, state: ImuSensorState, truth: Truth, dt: float) -> tuple[ImuSensorState, ImuReading]:
        state, reading = self.step(state, truth, dt)
        none = np.full(3, NOT_MEASURED)
        numbers = {"orientation": np.full(4, NOT_MEASURED), "angular_velocity": none, "specific_force": none}
        return state, replace(reading, **numbers)

    def hardware(self, state: ImuSensorState) -> Any:
        """Slow errors and attitude, with the motion up to which it has followed it."""
        errors = state.imu
        return errors.memory, errors.orientation, errors.elapsed, errors.heat, state.temperature, state.motion

    def with_hardware(self, state: ImuSensorState, hardware: Any) -> ImuSensorState:
        memory, orientation, elapsed, heat, temperature, motion = hardware
        errors = replace(state.imu, memory=memory, orientation=orientation, elapsed=elapsed, heat=heat)
        return ImuSensorState(errors, temperature, motion)

    def messages(self, stamp: int, reading: ImuReading | None) -> Iterator[tuple[str, Any]]:
        if reading is not None:
            yield (
                self.topic,
                Imu(
                    stamp,
                    "imu_link",
                    reading.orientation,
                    reading.angular_velocity,
                    reading.specific_force,
                    _covariance(reading.orientation_variance),
                    _covariance(reading.angular_velocity_variance),
                    _covariance(reading.specific_force_variance),
                ),
            )


def _covariance(variance: FloatArray) -> FloatArray:
    """Row by row, (9,), of three variances that have nothing to do with each other."""
    covariance = np.zeros(9)
    covariance[::4] = variance
    return covariance
