"""A machine with the arm that it carries: the arm's drives, encoders, load and URDF joined with the machine's own."""

from dataclasses import dataclass

from sojourn_config.arm_config import ArmConfig
from sojourn_config.composition import mounted_urdf
from sojourn_config.errors import single
from sojourn_config.mechanism_checks import BASE_LINK
from sojourn_config.rover import ArmMountParams, RoverConfig
from sojourn_config.urdf import UrdfSummary
from sojourn_mechanics.power.loads import BusParams
from sojourn_mechanics.power.manager_params import PowerLawParams
from sojourn_mechanics.sensors.params import SensorSuiteParams


@dataclass(frozen=True, slots=True, eq=False)
class Machine:
    """The parameter sets that a machine and its arm share."""

    rover: RoverConfig
    urdf: UrdfSummary
    bus: BusParams
    law: PowerLawParams
    sensors: SensorSuiteParams
    arm: ArmConfig | None


def on_machine(arm: ArmConfig, mount: ArmMountParams, root: str, first_joint_child: str) -> ArmConfig:
    """The arm's set with the names that its joints and links have on the machine; goals are in base_link there.

    Args:
        root: first link of the arm, in its own URDF. first_joint_child: link that its first joint moves: it may touch
            what the arm stands on.
    """

    def name(own: str) -> str:
        return mount.prefix + own

    pairs = [*arm.ignored_link_pairs, (first_joint_child, root)]
    return arm.model_copy(
        update={
            "joint_names": tuple(map(name, arm.joint_names)),
            "base_link": BASE_LINK,
            "tip_link": name(arm.tip_link),
            "locked_positions": {name(joint): value for joint, value in arm.locked_positions.items()},
            "inertias_as_published": tuple(map(name, arm.inertias_as_published)),
            "ground_contact_links": tuple(map(name, arm.ground_contact_links)),
            "ignored_link_pairs": (
                *((name(one), name(other)) for one, other in pairs),
                (name(first_joint_child), mount.link),
            ),
            "drives": tuple(
                drive.model_copy(update={"joints": tuple(map(name, drive.joints))}) for drive in arm.drives
            ),
            "joint_groups": {
                name(group): params.model_copy(update={"joints": tuple(map(name, params.joints))})
                for group, params in arm.joint_groups.items()
            },
            "wrench_sensor_link": None if arm.wrench_sensor_link is None else name(arm.wrench_sensor_link),
        }
    )


def join(machine: Machine, arm_urdf: UrdfSummary | None) -> Machine:
    """The machine with all that its arm brings along.

    Args:
        arm_urdf: of an arm on a mount; None: the machine's own URDF has the arm.

    Raises:
        ConfigError: what cannot be put together: names that clash, a link to stand on that is not there.
    """
    arm, rover, urdf = machine.arm, machine.rover, machine.urdf
    if arm is None:
        return machine
    if rover.arm_mount is not None and arm_urdf is not None:
        urdf = mounted_urdf(urdf, arm_urdf, arm.urdf_root, rover.arm_mount)
        first = arm_urdf.joints.get(arm.joint_names[0])
        if first is None:
            allowed = f"is no joint of {arm_urdf.file}: allowed is one of " + ", ".join(arm_urdf.moving_joints)
            raise single(f"config/arms/{rover.arm}.yaml", "joint_names[0]", arm.joint_names[0], allowed)
        arm = on_machine(arm, rover.arm_mount, arm.urdf_root or arm_urdf.root, first.child)
    bus, law = machine.bus, machine.law
    if arm.load is not None and arm.load.name not in {load.name for load in bus.loads}:
        bus = bus.model_copy(update={"loads": (*bus.loads, arm.load)})
        law = law.model_copy(update={"arm_power_limit": arm.load.power_w})
    sensors = machine.sensors
    joined = {**sensors.joint_groups, **arm.joint_groups}
    return Machine(
        rover=rover.model_copy(
            update={
                "drives": (*rover.drives, *arm.drives),
                "wrench_sensor_link": rover.wrench_sensor_link or arm.wrench_sensor_link,
            }
        ),
        urdf=urdf,
        bus=bus,
        law=law,
        sensors=sensors.model_copy(update={"joint_groups": joined}),
        arm=arm,
    )
