"""Encoders of a machine's joints where sensors.yaml names none: from its drives and its other joints that move."""

from sojourn_config.derived import Derivation, DerivedValue
from sojourn_config.machine import MachineConfig
from sojourn_config.urdf import UrdfSummary

MOTOR_BITS, JOINT_BITS = 12, 14
STEPS_OF_EFFORT = 800.0
"""Steps of a measured effort from none to the servo's largest [-]."""


def derived_sensors(config: MachineConfig, urdf: UrdfSummary) -> Derivation:
    """The key `joint_groups`: every motor has an encoder of 12 bits and tells its current, every other joint that moves
    and turns has an encoder of 14 bits.
    """
    groups: dict[str, Derivation] = {}
    for place, drive in enumerate(config.drives):
        why = f"drives[{place}] of machine.yaml"
        step = float(f"{drive.servo.max_torque / STEPS_OF_EFFORT:.2g}")
        groups[f"{drive.load}_{place}"] = {
            "joints": DerivedValue(list(drive.joints), why),
            "encoder": DerivedValue(
                {"bits": MOTOR_BITS, "side": "motor", "gear_ratio": drive.gear.ratio, "rate_window": 1}, why
            ),
            "effort_resolution": DerivedValue(step, why),
            "effort_noise": DerivedValue(2.0 * step, why),
        }
    driven = {joint for drive in config.drives for joint in drive.joints}
    passive = [name for name in urdf.moving_joints if name not in driven]
    with_arm = config.arm is not None and config.arm_mount is None  # which brings its own encoders
    if passive and not with_arm:
        why = "joints of the URDF that no motor drives"
        groups["passive"] = {
            "joints": DerivedValue(list(passive), why),
            "encoder": DerivedValue({"bits": JOINT_BITS, "side": "output", "rate_window": 5}, why),
            "effort_resolution": DerivedValue(0.1, why),
            "effort_noise": DerivedValue(0.1, why),
        }
    return {"joint_groups": groups}
