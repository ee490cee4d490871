"""Which joints of a URDF make up an arm, and what its motors and gears are.

Read here and not by Pinocchio: the line of links from base to tip, rotor inertia and gear ratio (element
`transmission`, in Drake's dialect of URDF), friction (element `dynamics`; see dh_urdf.py for its attributes).
"""

import math
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np

from sojourn_flight.arm.friction import JointFriction
from sojourn_machine.errors import MachineError
from sojourn_machine.params import FloatArray

_MOVING = ("revolute", "prismatic", "continuous")
_MANY = ("floating", "planar")
_ONE_TURN = 2.0 * math.pi
UNLIMITED = 1.0e30
"""Stands for a limit of speed or effort that the URDF does not give: its parser knows no infinity."""


class ArmModelError(MachineError):
    """The URDF does not hold the arm that is asked for."""


@dataclass(frozen=True, slots=True, eq=False)
class UrdfChain:
    """An arm's part of a URDF; lists in chain order."""

    name: str
    urdf_xml: str  # continuous joints turned into revolute ones; pictures and meshes taken out
    base_link: str
    tip_link: str
    joint_names: tuple[str, ...]  # of the moving joints
    motor_inertia: FloatArray  # J_m G^2 (n,) [kg m2 or kg]
    friction: JointFriction


def read_chain(urdf_xml: str, base_link: str | None, tip_link: str | None) -> UrdfChain:
    """The line of joints between two links; see `build_serial_arm`.

    Raises:
        ArmModelError: not a URDF, no such link, no moving joint between them, a number that is none.
    """
    try:
        root = ElementTree.fromstring(urdf_xml.encode("utf-8"))
    except ElementTree.ParseError as error:
        raise ArmModelError(f"the URDF is not an XML document: {error}") from error
    if root.tag != "robot":
        raise ArmModelError(f"the outermost element is {root.tag!r}: allowed is robot")
    for link in root.findall("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            if shape.tag == "visual" or shape.find("geometry/mesh") is not None:
                link.remove(shape)
    above = {_link_of(joint, "child"): joint for joint in root.findall("joint")}
    links = [str(link.get("name")) for link in root.findall("link")]
    base = base_link if base_link is not None else _outermost(links, above)
    if base not in links:
        raise ArmModelError(f"{base!r} is not a link of the URDF; there are {', '.join(links)}")
    gripping = _gripping(root)
    tip = tip_link if tip_link is not None else _farthest(links, above, base, gripping)
    if tip not in links:
        raise ArmModelError(f"{tip!r} is not a link of the URDF; there are {', '.join(links)}")
    joints = _line(above, base, tip)
    if joints is None:
        raise ArmModelError(f"link {tip!r} does not hang on link {base!r}")
    moving = [joint for joint in joints if joint.get("type") in _MOVING]
    if not moving:
        raise ArmModelError(f"no joint moves between link {base!r} and link {tip!r}")
    for joint in joints:
        if joint.find("mimic") is not None:
            raise ArmModelError(f"joint {joint.get('name')!r} mimics another: allowed are joints that move alone")
        if joint.get("type") in _MANY:
            raise ArmModelError(f"joint {joint.get('name')!r} is {joint.get('type')}: allowed are {', '.join(_MOVING)}")
    for joint in moving:
        _check_axis(joint)
    for joint in root.findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None:  # of a gripper: it is locked
            joint.remove(mimic)
        if joint.get("type") in _MOVING:
            _complete_limits(joint)
    return UrdfChain(
        name=str(root.get("name", "arm")),
        urdf_xml=ElementTree.tostring(root, encoding="unicode"),
        base_link=base,
        tip_link=tip,
        joint_names=tuple(str(joint.get("name")) for joint in moving),
        motor_inertia=_motor_inertia(root, [str(joint.get("name")) for joint in moving]),
        friction=_friction(moving),
    )


def _outermost(links: list[str], above: dict[str, ElementTree.Element]) -> str:
    free = [name for name in links if name not in above]
    if len(free) != 1:
        raise ArmModelError(f"the URDF has {len(free)} outermost links: allowed is one")
    return free[0]


def _gripping(root: ElementTree.Element) -> set[str]:
    """Names of joints that mimic another, and of those that are mimicked: fingers of a gripper."""
    found: set[str] = set()
    for joint in root.findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None:
            found |= {str(joint.get("name")), str(mimic.get("joint"))}
    return found


def _farthest(links: list[str], above: dict[str, ElementTree.Element], base: str, gripping: set[str]) -> str:
    """The link at the end of the line with most moving joints, before any gripper; of equals, that with most links."""
    best, tip = (-1, -1), base
    for name in links:
        line = _line(above, base, name)
        if line is not None and not any(joint.get("name") in gripping for joint in line):
            length = (sum(joint.get("type") in _MOVING for joint in line), len(line))
            if length > best:
                best, tip = length, name
    return tip


def _line(above: dict[str, ElementTree.Element], base: str, tip: str) -> list[ElementTree.Element] | None:
    line: list[ElementTree.Element] = []
    here = tip
    while here != base:
        if here not in above or len(line) > len(above):
            return None
        line.insert(0, above[here])
        here = _link_of(above[here], "parent")
    return line


def _link_of(joint: ElementTree.Element, tag: str) -> str:
    child = joint.find(tag)
    if child is None or not child.get("link"):
        raise ArmModelError(f"joint {joint.get('name')!r} names no {tag} link")
    return str(child.get("link"))


def _check_axis(joint: ElementTree.Element) -> None:
    element = joint.find("axis")
    words = "1 0 0" if element is None else str(element.get("xyz", "1 0 0"))
    try:
        length = math.hypot(*(float(word) for word in words.split()))
    except ValueError:
        length = math.nan
    if len(words.split()) != 3 or not length > 1e-9 or not math.isfinite(length):
        raise ArmModelError(f"joint {joint.get('name')!r}: axis = {words!r}: allowed are three numbers, not all 0")


def _complete_limits(joint: ElementTree.Element) -> None:
    """Give a joint the limits that it lacks: one turn to either side, any speed and any effort.

    What leaves no room at all (0, or lower = upper) counts as not given: exporters write it so.
    """
    owner = f"joint {joint.get('name')}"
    limit = joint.find("limit")
    if limit is None:
        limit = ElementTree.SubElement(joint, "limit")
    low, high = _value(limit, "lower", owner, 0.0), _value(limit, "upper", owner, 0.0)
    if joint.get("type") == "continuous" or (joint.get("type") == "revolute" and low == high):
        low, high = -_ONE_TURN, _ONE_TURN
    if not low < high:
        raise ArmModelError(f"{owner}: limits {low:g} to {high:g}: allowed is a lower one below the upper one")
    joint.set("type", "revolute" if joint.get("type") == "continuous" else str(joint.get("type")))
    limit.set("lower", repr(low))
    limit.set("upper", repr(high))
    for name in ("effort", "velocity"):
        value = _value(limit, name, owner, 0.0)
        if value < 0.0:
            raise ArmModelError(f"{owner}: {name} = {value:g}: allowed is a number above 0")
        limit.set(name, repr(value or UNLIMITED))


def _motor_inertia(root: ElementTree.Element, names: list[str]) -> FloatArray:
    inertia = dict.fromkeys(names, 0.0)
    for transmission in root.findall("transmission"):
        joint = transmission.find("joint")
        actuator = transmission.find("actuator")
        if joint is None or actuator is None or joint.get("name") not in inertia:
            continue
        values = {part.tag.rpartition("}")[2]: part for part in actuator}
        if "rotor_inertia" in values:
            owner = f"transmission of {joint.get('name')}"
            ratio = _value(values["gear_ratio"], "value", owner, 1.0) if "gear_ratio" in values else 1.0
            inertia[str(joint.get("name"))] = _value(values["rotor_inertia"], "value", owner, 0.0) * ratio**2
    return np.array([inertia[name] for name in names])


def _friction(joints: list[ElementTree.Element]) -> JointFriction:
    columns: dict[str, list[float]] = {
        "damping": [], "friction": [], "backward_friction": [], "static_friction": [], "stribeck_velocity": []
    }  # fmt: skip
    for joint in joints:
        dynamics = joint.find("dynamics")
        owner = f"joint {joint.get('name')}"
        forward = _value(dynamics, "friction", owner, 0.0)
        defaults = {"backward_friction": forward, "stribeck_velocity": 1.0}
        for name, values in columns.items():
            values.append(_value(dynamics, name, owner, defaults.get(name, 0.0)))
    return JointFriction(*(np.array(values) for values in columns.values()))


def _value(element: ElementTree.Element | None, name: str, owner: str, default: float) -> float:
    text = None if element is None else element.get(name)
    if text is None:
        return default
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ArmModelError(f"{owner}: {name} = {text!r}: allowed is a number")
    return value
