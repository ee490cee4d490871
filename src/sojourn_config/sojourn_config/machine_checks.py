"""Checks of a machine across its files: URDF, wheels, drives, loads, sensors, arm, drive node."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import TypeVar

from sojourn_config.arm_config import ArmConfig
from sojourn_config.errors import MISSING, Problem
from sojourn_config.machine import MachineConfig
from sojourn_config.machine_body import body_layout
from sojourn_config.machine_reader import MachineSets
from sojourn_config.mechanism_checks import BASE_LINK, mass_problems, mechanism_problems
from sojourn_config.sensor_checks import sensor_problems
from sojourn_config.support_checks import joint_problem, support_problems
from sojourn_config.urdf import UrdfSummary
from sojourn_config.yaml_file import KeyPath, YamlDocument
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.power_manager.modes import SLEEP
from sojourn_flight.power_manager.params import PowerLawParams
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.actuator_choice import ActuatorParams
from sojourn_machine.drives import JointDriveParams, PlayParams
from sojourn_machine.names import names_text
from sojourn_machine.power.power_params import PowerParams
from sojourn_physics.sensors.params import JointGroupParams

AnyArm = TypeVar("AnyArm", bound=ArmParams)


def machine_problems(sets: MachineSets) -> list[Problem]:
    """All that does not fit together."""
    config, urdf, power, sensors, arm = (
        sets.joined.config, sets.joined.urdf, sets.joined.power, sets.joined.sensors, sets.joined.arm,
    )  # fmt: skip
    documents = sets.documents
    own_drives = config.drives[: len(config.drives) - len(arm.drives)] if arm else config.drives
    own_groups = {
        name: group for name, group in sensors.joint_groups.items() if not arm or name not in arm.joint_groups
    }
    problems = [
        *mass_problems(config, sets.own_urdf, documents["machine"]),
        *mechanism_problems(config, urdf, documents["machine"], arm.inertias_as_published if arm else ()),
        *support_problems(config, urdf, documents["machine"]),
        *_drive_problems(own_drives, urdf, power, documents["machine"]),
        *_reference_problems(config, urdf, documents["machine"]),
        *sensor_problems(sets),
        *_power_problems(power, sets.joined.law, documents),
        *_group_problems(own_groups, urdf, documents["sensors"]),
    ]
    if arm is not None:
        measured = {joint for group in sensors.joint_groups.values() for joint in group.joints}
        problems += _arm_problems(arm, config, urdf, measured, documents["arm"])
        problems += _drive_problems(arm.drives, urdf, power, documents["arm"])
        prefix = config.arm_mount.prefix if config.arm_mount else ""
        named_in_file = {name.removeprefix(prefix): group for name, group in arm.joint_groups.items()}
        problems += _shaft_problems(arm, config, own_groups, documents["sensors"])
        problems += _shaft_problems(arm, config, named_in_file, documents["arm"])
        problems += _group_problems(named_in_file, urdf, documents["arm"])
    if sets.drive is not None and not problems:
        problems += _limit_problems(config, urdf, sets.drive, documents["flight"])
    return problems


def with_drive_data(arm: AnyArm, config: MachineConfig) -> AnyArm:
    """The arm with rotor inertia and friction of the machine's drives, where its own file leaves them out."""
    drives = {joint: drive for drive in config.drives for joint in drive.joints}
    found = [drives[joint] for joint in arm.joint_names]
    update = {
        "reflected_inertia": tuple(drive.reflected_inertia for drive in found),
        "coulomb_friction": tuple(drive.friction_torque for drive in found),
        "viscous_friction": tuple(drive.viscous_friction for drive in found),
        "gear_efficiency": tuple(drive.efficiency for drive in found),
        "winding_loss": tuple(drive.winding_loss for drive in found),
        "motor_effort": tuple(drive.motor_effort for drive in found),
        **_gear_data(found),
    }
    return arm.model_copy(update={name: value for name, value in update.items() if not getattr(arm, name)})


def _gear_data(drives: Sequence[ActuatorParams]) -> dict[str, tuple[float, ...]]:
    """Play and give that the arm's law has to make up for: of gears whose encoder is on the motor."""
    seen = [_unseen_play(drive) for drive in drives]
    if not any(seen):
        return {}
    return {
        "gear_compliance": tuple(0.0 if play is None else 1.0 / play.stiffness for play in seen),
        "gear_backlash": tuple(0.0 if play is None else play.backlash for play in seen),
        "bearing_friction": tuple(0.0 if play is None else play.bearing_friction for play in seen),
    }


def _unseen_play(drive: ActuatorParams) -> PlayParams | None:
    """Behind the encoder that the servo is closed on."""
    return drive.play if isinstance(drive, JointDriveParams) and drive.servo.encoder == "motor" else None


def _drive_problems(
    drives: Sequence[ActuatorParams], urdf: UrdfSummary, power: PowerParams, document: YamlDocument
) -> Iterator[Problem]:
    loads = {load.name: load for load in power.loads}
    commanded = [load.name for load in power.loads if load.kind == "commanded"]
    for index, drive in enumerate(drives):
        path: KeyPath = ("drives", index)
        if drive.load not in commanded:
            why = "is no commanded load" if drive.load in loads else "is no load of the bus"
            allowed = f"{why}: " + names_text(drive.load, commanded)
            yield document.problem((*path, "load"), drive.load, allowed)
        for number, name in enumerate(drive.joints):
            problem = joint_problem(document, (*path, "joints", number), name, urdf)
            if problem is not None:
                yield problem
            elif drive.largest_torque > urdf.joints[name].effort:
                effort = urdf.joints[name].effort
                unit = urdf.joints[name].effort_unit
                allowed = f"allowed is at most {effort:g} {unit}, the effort of {name} in {urdf.file}"
                yield document.problem((*path, *drive.torque_key), drive.largest_torque, allowed)


def _reference_problems(config: MachineConfig, urdf: UrdfSummary, document: YamlDocument) -> Iterator[Problem]:
    for index, coupling in enumerate(config.couplings):
        for key, name in (("first", coupling.first), ("second", coupling.second)):
            problem = joint_problem(document, ("couplings", index, key), name, urdf)
            if problem is not None:
                yield problem
    for index, pad in enumerate(config.pads):
        if pad.link not in urdf.links:
            allowed = f"is not a link of {urdf.file}: " + names_text(pad.link, urdf.links)
            yield document.problem(("pads", index, "link"), pad.link, allowed)
    if BASE_LINK not in urdf.links:
        yield document.problem(("urdf",), config.urdf, f"has no link {BASE_LINK}")


def _group_problems(
    groups: Mapping[str, JointGroupParams], urdf: UrdfSummary, document: YamlDocument
) -> Iterator[Problem]:
    for group, params in groups.items():
        for number, name in enumerate(params.joints):
            problem = joint_problem(document, ("joint_groups", group, "joints", number), name, urdf)
            if problem is not None:
                yield problem


def _shaft_problems(
    arm: ArmConfig, config: MachineConfig, groups: Mapping[str, JointGroupParams], document: YamlDocument
) -> Iterator[Problem]:
    """Servo and encoder of an arm's joint must be on the same shaft where its gear has play: the arm's law makes up for
    what the gear gives in both, or in neither."""
    drives = {joint: drive for drive in config.drives for joint in drive.joints}
    for group, params in groups.items():
        for name in params.joints:
            drive = drives.get(name)
            if name not in arm.joint_names or not isinstance(drive, JointDriveParams) or drive.play is None:
                continue
            wanted = "motor" if drive.servo.encoder == "motor" else "output"
            if params.encoder.side != wanted:
                closed = f"the servo of {name} is closed on its {drive.servo.encoder}"
                why = f"{closed} and its gear has play: allowed is {wanted}"
                yield document.problem(("joint_groups", group, "encoder", "side"), params.encoder.side, why)


def _power_problems(
    power: PowerParams, law: PowerLawParams, documents: Mapping[str, YamlDocument]
) -> Iterator[Problem]:
    """Loads can be fed, those that the power manager limits are there, and it has a charge to go by."""
    for path, value, allowed in power.load_problems():
        yield documents["power"].problem(path, value, allowed)
    if not power.all_stores:
        yield documents["power"].problem(("stores",), MISSING, "the key is missing: allowed is at least one store")
    loads = [load.name for load in power.loads]
    for load, limit in law.load_limits.items():
        if load not in loads:
            path = ("power_manager", "load_limits", load)
            yield documents["flight"].problem(path, limit, "is no load of the bus: " + names_text(load, loads))
    essential = [load.name for load in power.loads if load.essential]
    for place, load in enumerate(() if law.sleep is None else law.sleep.loads):
        if load not in essential:
            allowed = "is no essential load of the bus: " + names_text(load, essential)
            yield documents["flight"].problem(("power_manager", "sleep", "loads", place), load, allowed)
    if SLEEP in loads:
        allowed = "allowed is another name of a load: operators ask by it for the sleep of the machine"
        yield documents["power"].problem(("bus", "loads"), SLEEP, allowed)


def _arm_problems(
    arm: ArmConfig, config: MachineConfig, urdf: UrdfSummary, measured: Collection[str], document: YamlDocument
) -> Iterator[Problem]:
    driven = {joint for drive in config.drives for joint in drive.joints}
    for index, name in enumerate(arm.joint_names):
        problem = joint_problem(document, ("joint_names", index), name, urdf)
        if problem is not None:
            yield problem
            continue
        if name not in driven:
            yield document.problem(("joint_names", index), name, "has no drive in the machine's drives")
        if name not in measured:
            yield document.problem(("joint_names", index), name, "has no encoder: name it in joint_groups")
        joint = urdf.joints[name]
        if arm.max_velocity[index] > joint.velocity:
            allowed = f"allowed is at most {joint.velocity:g} {joint.unit}/s, the velocity of {name} in {urdf.file}"
            yield document.problem(("max_velocity", index), arm.max_velocity[index], allowed)
        for pose, positions in arm.named_poses.items():
            if not joint.lower <= positions[index] <= joint.upper:
                allowed = f"allowed is {joint.lower:g} to {joint.upper:g} {joint.unit}, the limits of {name}"
                yield document.problem(("named_poses", pose, index), positions[index], allowed)
    named: list[tuple[KeyPath, str]] = [(("base_link",), arm.base_link), (("tip_link",), arm.tip_link)]
    named += [(("inertias_as_published", index), link) for index, link in enumerate(arm.inertias_as_published)]
    for key, link in named:
        if link not in urdf.links:
            allowed = f"is not a link of {urdf.file}: " + names_text(link, urdf.links)
            yield document.problem(key, link, allowed)
    if arm.tip_link in urdf.links:
        line = [name for name in urdf.joints_above(arm.tip_link) if name in arm.joint_names]
        if line != list(arm.joint_names) and all(name in urdf.moving_joints for name in arm.joint_names):
            allowed = f"allowed is their order towards {arm.tip_link}, which hangs on " + ", ".join(line)
            yield document.problem(("joint_names",), list(arm.joint_names), allowed)


def _limit_problems(
    config: MachineConfig, urdf: UrdfSummary, drive: DriveParams, document: YamlDocument
) -> Iterator[Problem]:
    """The drive node may not ask for more than the joints can do."""
    for key, value, most in drive.mobility.excesses(body_layout(config, urdf)):
        allowed = f"allowed is at most {most:g} rad/s, the velocity of these joints in {urdf.file}"
        yield document.problem(("drive", "mobility", key), value, allowed)
