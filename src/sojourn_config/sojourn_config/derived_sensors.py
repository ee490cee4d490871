"""Encoders of a machine's joints where sensors.yaml names none: from its drives and its other joints that move."""

from sojourn_config.derived import Derivation, DerivedValue
from sojourn_config.machine import MachineConfig
from sojourn_config.urdf import UrdfSummary
from sojourn_config.yaml_file import Data

ON_MOTOR: dict[str, Data] = {"bits": 12, "side": "motor", "rate_window": 1}
ON_JOINT: dict[str, Data] = {"bits": 14, "side": "output", "rate_window": 5}
STEPS_OF_EFFORT = 800.0
"""Steps of a measured effort from none to the servo's largest [-]."""


def derived_sensors(config: MachineConfig, urdf: UrdfSummary) -> Derivation:
    """The key `joint_groups`: every motor has an encoder of 12 bits and tells its current, every other joint that moves
    and turns has an encoder of 14 bits, and so has one whose drive says that its encoder is on the joint.
    """
    groups: dict[str, Derivation] = {}
    for place, drive in enumerate(config.drives):
        why = f"drives[{place}] of machine.yaml"
        ratio = drive.encoder_ratio
        step = float(f"{drive.largest_torque / STEPS_OF_EFFORT:.2g}")
        groups[f"{drive.load}_{place}"] = {
            "joints": DerivedValue(list(drive.joints), why),
            "encoder": DerivedValue(dict(ON_JOINT) if ratio is None else {**ON_MOTOR, "gear_ratio": ratio}, why),
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
            "encoder": DerivedValue(dict(ON_JOINT), why),
            "effort_resolution": DerivedValue(0.1, why),
            "effort_noise": DerivedValue(0.1, why),
        }
    return {"joint_groups": groups}
