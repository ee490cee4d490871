"""Checks of a machine that carries an arm on a mount: balance, what its joints hold, the voltage of its bus."""

from collections.abc import Iterator, Mapping

import numpy as np

from sojourn_config.arm_config import ArmConfig
from sojourn_config.errors import Problem
from sojourn_config.machine import MachineConfig
from sojourn_config.mechanism_checks import BASE_LINK
from sojourn_config.mounting import LoadedMachine
from sojourn_config.still_machine import StillMachine
from sojourn_config.urdf import UrdfSummary
from sojourn_config.yaml_file import YamlDocument
from sojourn_machine.drives import JointDriveParams, MotorParams
from sojourn_machine.params import FloatArray
from sojourn_machine.power.power_params import PowerParams


def carrying_problems(
    machine: LoadedMachine, gravity: float, documents: Mapping[str, YamlDocument]
) -> Iterator[Problem]:
    """All that does not fit of an arm that is mounted on a machine; nothing of one that is in the machine's own URDF.

    Args:
        machine: joined with its arm. documents: files by role (`machine`, `arm`).
    """
    arm, urdf = machine.arm, machine.urdf
    if arm is None or machine.config.arm_mount is None:
        return
    document = documents["arm"]
    yield from _voltage_problems(arm, machine.power, document)
    for pose, positions in arm.named_poses.items():
        still = StillMachine(urdf, dict(zip(arm.joint_names, positions, strict=True)))
        yield from _holding_problems(arm, urdf, still, pose, gravity, document)
        if machine.config.stands_on:
            yield from _balance_problems(machine.config, urdf, still, pose, documents["machine"])


def _voltage_problems(arm: ArmConfig, power: PowerParams, document: YamlDocument) -> Iterator[Problem]:
    """A motor at its largest speed, against friction: V = k N w + R (F_0 + b w)/(N k n), from empty stores."""
    lowest = power.lowest_voltage()
    for index, name in enumerate(arm.joint_names):
        drive = next((drive for drive in arm.drives if name in drive.joints), None)
        if not (isinstance(drive, JointDriveParams) and isinstance(drive.electric, MotorParams)):
            continue
        motor, gear = drive.electric, drive.transmission
        gain, rate = motor.torque_constant * gear.ratio, arm.max_velocity[index]
        effort = (drive.friction_torque + drive.viscous_friction * rate) / gear.efficiency
        needed = gain * rate + motor.resistance * effort / gain
        if needed > lowest:
            allowed = f"needs {needed:.3g} V from the bus, but empty stores give {lowest:.3g} V: "
            allowed += f"allowed is some {rate * lowest / needed:.2g} at most"
            yield document.problem(("max_velocity", index), rate, allowed)


def _holding_problems(
    arm: ArmConfig, urdf: UrdfSummary, still: StillMachine, pose: str, gravity: float, document: YamlDocument
) -> Iterator[Problem]:
    for drive in arm.drives:
        for name in drive.joints:
            held = abs(still.held_by(name, gravity))
            if held > drive.motor_effort:
                unit = urdf.joints[name].effort_unit
                allowed = f"{name} would hold {held:.4g} {unit} at {gravity:.3g} m/s2: "
                allowed += f"allowed is {drive.motor_effort:.4g} {unit} at most, what its drive can give"
                yield document.problem(("named_poses", pose), list(arm.named_poses[pose]), allowed)


def _balance_problems(
    config: MachineConfig, urdf: UrdfSummary, still: StillMachine, pose: str, document: YamlDocument
) -> Iterator[Problem]:
    """On level ground the machine stands on its wheels as long as its centre of mass is above the area between them."""
    in_base = np.linalg.inv(still.place(BASE_LINK))
    _, centre = still.weight_of(urdf.links)
    centre = (in_base @ np.append(centre, 1.0))[:2]
    feet = np.array([(in_base @ still.place(urdf.joints[wheel.joint].child))[:2, 3] for wheel in config.wheels])
    outside = _distance_outside(feet, centre)
    if outside > 0.0:
        where = f"x {centre[0]:.2f}, y {centre[1]:.2f} m, {outside:.2f} m outside the wheels"
        allowed = f"tips the machine over in pose {pose!r}, its centre of mass at {where}: "
        allowed += "allowed is a lighter arm or another place for it"
        yield document.problem(("arm_mount",), config.arm, allowed)


def _distance_outside(feet: FloatArray, point: FloatArray) -> float:
    """How far a point is outside the convex outline of others, (k, 2) [m]; negative inside.

    The largest distance beyond a line that has all others on one side: of wheels in one line the distance from it.
    """
    worst = -np.inf
    for angle in np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False):
        normal = np.array([np.cos(angle), np.sin(angle)])
        worst = max(worst, float(normal @ point - (feet @ normal).max()))
    return worst
