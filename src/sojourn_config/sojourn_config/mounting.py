"""A machine with the arm that it carries: the arm's drives, encoders, load and URDF joined with the machine's own."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from sojourn_config.arm_config import ArmConfig
from sojourn_config.composition import mounted_urdf
from sojourn_config.errors import MISSING, Problem
from sojourn_config.machine import ArmMountParams, MachineConfig
from sojourn_config.mechanism_checks import BASE_LINK
from sojourn_config.urdf import UrdfSummary
from sojourn_config.yaml_file import YamlDocument
from sojourn_flight.power_manager.params import PowerLawParams
from sojourn_machine.names import names_text
from sojourn_machine.power.power_params import PowerParams
from sojourn_physics.sensors.params import SensorSuiteParams


@dataclass(frozen=True, slots=True, eq=False)
class LoadedMachine:
    """The parameter sets that a machine and its arm share."""

    config: MachineConfig
    urdf: UrdfSummary
    power: PowerParams
    law: PowerLawParams
    sensors: SensorSuiteParams
    arm: ArmConfig | None


def on_machine(arm: ArmConfig, mount: ArmMountParams, root: str, first_joint_child: str) -> ArmConfig:
    """The arm's set with the names that its joints and links have on the machine; goals are in base_link there.

    Args:
        root: first link of the arm, in its own URDF. first_joint_child: link that its first joint moves: where the
            mount says so, it may touch what the arm stands on.
    """

    def name(own: str) -> str:
        return mount.prefix + own

    pairs = [(name(one), name(other)) for one, other in arm.ignored_link_pairs]
    if mount.touches:
        pairs += [(name(first_joint_child), name(root)), (name(first_joint_child), mount.link)]
    return arm.model_copy(
        update={
            "joint_names": tuple(map(name, arm.joint_names)),
            "base_link": BASE_LINK,
            "tip_link": name(arm.tip_link),
            "locked_positions": {name(joint): value for joint, value in arm.locked_positions.items()},
            "inertias_as_published": tuple(map(name, arm.inertias_as_published)),
            "ground_contact_links": tuple(map(name, arm.ground_contact_links)),
            "ignored_link_pairs": tuple(pairs),
            "drives": tuple(
                drive.model_copy(update={"joints": tuple(map(name, drive.joints))}) for drive in arm.drives
            ),
            "joint_groups": {
                name(group): params.model_copy(update={"joints": tuple(map(name, params.joints))})
                for group, params in arm.joint_groups.items()
            },
            "pads": tuple(pad.model_copy(update={"name": name(pad.name), "link": name(pad.link)}) for pad in arm.pads),
            "wrench_sensor_link": None if arm.wrench_sensor_link is None else name(arm.wrench_sensor_link),
        }
    )


def mount_problems(
    machine: LoadedMachine, arm_urdf: UrdfSummary | None, documents: Mapping[str, YamlDocument]
) -> Iterator[Problem]:
    """Why the arm cannot be put on the machine as it is asked for.

    Args:
        arm_urdf: as for `join`. documents: files by role (`machine`, `arm`), for messages.
    """
    arm, mount, name = machine.arm, machine.config.arm_mount, machine.config.arm
    if arm is None:
        return
    if mount is None:
        if arm.urdf is not None and arm.joint_names[0] not in machine.urdf.joints:
            allowed = f"the key is missing: where {name} stands on the machine, as {{link: {BASE_LINK}}}"
            yield documents["machine"].problem(("arm_mount",), MISSING, allowed)
        return
    if arm_urdf is None:
        allowed = f"{name} has no URDF of its own: allowed is an arm with urdf in its file in config/arms"
        yield documents["machine"].problem(("arm_mount",), MISSING, allowed)
        return
    if mount.link not in machine.urdf.links:
        allowed = f"is no link of {machine.urdf.file}: " + names_text(mount.link, machine.urdf.links)
        yield documents["machine"].problem(("arm_mount", "link"), mount.link, allowed)
    if arm.urdf_root is not None and arm.urdf_root not in arm_urdf.links:
        allowed = f"is no link of {arm_urdf.file}: " + names_text(arm.urdf_root, arm_urdf.links)
        yield documents["arm"].problem(("urdf_root",), arm.urdf_root, allowed)
    first = arm.joint_names[0]
    if first not in arm_urdf.joints:
        allowed = f"is no joint of {arm_urdf.file}: " + names_text(first, arm_urdf.moving_joints)
        yield documents["arm"].problem(("joint_names", 0), first, allowed)


def join(machine: LoadedMachine, arm_urdf: UrdfSummary | None) -> LoadedMachine:
    """The machine with all that its arm brings along; `mount_problems` has found none.

    Args:
        arm_urdf: of an arm on a mount; None: the machine's own URDF has the arm.

    Raises:
        ConfigError: names of links or joints that clash.
    """
    arm, config, urdf = machine.arm, machine.config, machine.urdf
    if arm is None:
        return machine
    if config.arm_mount is not None and arm_urdf is not None:
        root = arm.urdf_root or arm_urdf.root
        urdf = mounted_urdf(urdf, arm_urdf, root, config.arm_mount)
        arm = on_machine(arm, config.arm_mount, root, arm_urdf.joints[arm.joint_names[0]].child)
    if config.fixed_base and arm.ground_height is None:
        arm = arm.model_copy(update={"ground_height": 0.0})  # where a stand stands is known, without wheels to tell it
    power = machine.power
    if arm.load is not None and arm.load.name not in {load.name for load in power.loads}:
        power = power.with_load(arm.load)
    sensors = machine.sensors
    joined = {**sensors.joint_groups, **arm.joint_groups}
    return LoadedMachine(
        config=config.model_copy(
            update={
                "drives": (*config.drives, *arm.drives),
                "pads": (*config.pads, *arm.pads),
                "wrench_sensor_link": config.wrench_sensor_link or arm.wrench_sensor_link,
            }
        ),
        urdf=urdf,
        power=power,
        law=machine.law,
        sensors=sensors.model_copy(update={"joint_groups": joined}).with_sensor("wrist", arm.wrist),
        arm=arm,
    )
