"""What the estimate of slip goes by besides the curves that scripts/tune measures: from wheels, motors, IMU."""

from collections.abc import Iterator, Mapping

from sojourn_config.derived import Derivation, DerivedValue
from sojourn_config.derived_flight import sensor_of
from sojourn_config.machine import MachineConfig
from sojourn_config.yaml_file import Data
from sojourn_machine.supports import WheelParams

MICRO_G = 9.80665e-6
"""[m/s^2]"""
OF_THE_IMU = {
    "force_noise": "accelerometer_noise_micro_g_per_sqrt_hz",
    "accelerometer_bias": "accelerometer_bias_micro_g",
    "accelerometer_flicker": "accelerometer_bias_instability_micro_g",
}


def derived_slip(config: MachineConfig, sensors: Mapping[str, Data]) -> Derivation:
    """Keys of `drive.mobility.slip`; none of a machine without wheels. sensors: its sensors.yaml."""
    return dict(_from_wheels(config, config.wheels[0])) | dict(_from_imu(sensors)) if config.wheels else {}


def _from_wheels(config: MachineConfig, wheel: WheelParams) -> Iterator[tuple[str, DerivedValue]]:
    free = 1.0 - wheel.radius / wheel.shear_radius
    yield "free_slip", DerivedValue(free, "grousers of the first wheel: what rolls freely rolls on the rim")
    yield "rut_width", DerivedValue(0.5 * wheel.width, "half the width of the first wheel")
    for drive in config.drives:
        if wheel.joint in drive.joints:
            why = "rotor of the drive motor, through its gear"
            yield "rotor_inertia", DerivedValue(drive.reflected_inertia, why)


def _from_imu(sensors: Mapping[str, Data]) -> Iterator[tuple[str, DerivedValue]]:
    imu = sensor_of(sensors, "imu")
    for key, error in OF_THE_IMU.items():
        if isinstance(size := imu.get(error), int | float):
            yield key, DerivedValue(size * MICRO_G, "the IMU of sensors.yaml")
