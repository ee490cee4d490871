"""A plain machine of any number of wheels, made in code: a rigid chassis on axles of two, each wheel with a motor.

For measuring and for tests, where a machine has to differ in one thing alone: how many wheels it has, where its mass
is, which law its contacts follow. Its files would be a URDF and a YAML as those of every rover.
"""

from collections.abc import Sequence
from typing import NamedTuple

from sojourn_machine.actuator_choice import ActuatorParams
from sojourn_machine.drives import JointFrictionParams
from sojourn_machine.machine import MachineParams, SuspensionParams
from sojourn_machine.supports import WheelParams

WHEEL_MASS = 2.0
STEER_MASS = 0.5
STRUT_MASS = 0.5
SIDES = (("left", 1.0), ("right", -1.0))


class Platform(NamedTuple):
    """Its URDF as text and what the URDF does not say."""

    urdf_xml: str
    machine: MachineParams


class Chassis(NamedTuple):
    """What bears on the axles."""

    mass: float = 100.0
    """[kg]"""
    inertia: tuple[float, float, float] = (10.0, 20.0, 25.0)
    """About its centre of mass, x, y, z [kg m^2]."""
    centre: tuple[float, float] = (0.0, 0.25)
    """Of its mass, x and z in base_link [m]."""


PLAIN = Chassis()


def wheeled_platform(
    places: Sequence[float],
    wheel: WheelParams,
    drives: Sequence[ActuatorParams],
    steering: ActuatorParams | None = None,
    steered: Sequence[int] = (),
    struts: SuspensionParams | None = None,
    chassis: Chassis = PLAIN,
    track: float = 1.0,
) -> Platform:
    """A machine whose base_link is level with its axles.

    Args:
        places: x of the axles, from front to rear [m]. wheel: pattern of all wheels; names and joints are filled in.
        drives: motor of the wheels of each axle, one an axle or one for all; their joints are filled in.
        steering: motor of the steered wheels. steered: numbers of the axles that steer.
        struts: spring and damper of every wheel, which slides straight up; none: rigid.
        track: between the wheels of an axle [m].
    """
    roll, pitch, yaw = chassis.inertia
    x, z = chassis.centre
    links = [
        f'<link name="base_link"><inertial><origin xyz="{x} 0 {z}"/><mass value="{chassis.mass}"/>'
        f'<inertia ixx="{roll}" iyy="{pitch}" izz="{yaw}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    ]
    wheels: list[WheelParams] = []
    turned: list[str] = []
    sprung: list[str] = []
    axles: list[list[str]] = []
    for number, x in enumerate(places):
        axles.append([])
        for side, sign in SIDES:
            name = f"axle_{number}_{side}"
            place = f'<origin xyz="{x} {sign * 0.5 * track} 0"/>'
            parent, steer = "base_link", None
            if number in steered:
                steer = f"steer_{name}_joint"
                links.append(_link(f"steer_{name}_link", STEER_MASS, 0.1))
                links.append(_joint(steer, "revolute", parent, f"steer_{name}_link", place, "0 0 1"))
                turned.append(steer)
                parent, place = f"steer_{name}_link", "<origin/>"
            if struts is not None:
                sprung.append(f"strut_{name}_joint")
                links.append(_link(f"strut_{name}_link", STRUT_MASS, 0.05))
                links.append(_joint(sprung[-1], "prismatic", parent, f"strut_{name}_link", place, "0 0 1"))
                parent, place = f"strut_{name}_link", "<origin/>"
            joint = f"wheel_{name}_joint"
            links.append(_link(f"wheel_{name}_link", WHEEL_MASS, wheel.radius))
            links.append(_joint(joint, "continuous", parent, f"wheel_{name}_link", place, "0 1 0"))
            wheels.append(wheel.model_copy(update={"name": name, "joint": joint, "steer_joint": steer}))
            axles[-1].append(joint)
    if len(drives) == 1:
        groups = [drives[0].model_copy(update={"joints": tuple(joint for axle in axles for joint in axle)})]
    else:
        groups = [drive.model_copy(update={"joints": tuple(axle)}) for drive, axle in zip(drives, axles, strict=True)]
    if steering is not None and turned:
        groups.append(steering.model_copy(update={"joints": tuple(turned)}))
    machine = MachineParams(
        wheels=tuple(wheels),
        drives=tuple(groups),
        passive_joint=JointFrictionParams(friction_torque=0.0, viscous_friction=0.0),
        suspensions=() if struts is None else (struts.model_copy(update={"joints": tuple(sprung)}),),
    )
    return Platform(f'<robot name="platform">{"".join(links)}</robot>', machine)


def _link(name: str, mass: float, radius: float) -> str:
    """A disc about the y axis."""
    about, across = 0.5 * mass * radius**2, 0.25 * mass * radius**2
    inertia = f'<inertia ixx="{across}" iyy="{about}" izz="{across}" ixy="0" ixz="0" iyz="0"/>'
    return f'<link name="{name}"><inertial><mass value="{mass}"/>{inertia}</inertial></link>'


def _joint(name: str, kind: str, parent: str, child: str, place: str, axis: str) -> str:
    limit = '<limit lower="-1.5" upper="1.5" effort="1000" velocity="100"/>' if kind != "continuous" else ""
    return (
        f'<joint name="{name}" type="{kind}">{place}<parent link="{parent}"/><child link="{child}"/>'
        f'<axis xyz="{axis}"/>{limit}</joint>'
    )
