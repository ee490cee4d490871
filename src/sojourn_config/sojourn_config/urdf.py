"""What the configuration needs to know of a URDF: joints, links, limits, wheels, and places at zero pose.

Only what other files refer to is read here, with no physics library: so a wrong name is found, with its file
and key, before any model is built. Rotations: rpy is roll, pitch, yaw about fixed axes, R = Rz(yaw) Ry(pitch)
Rx(roll) (URDF specification). Mimic joints, transmissions and meshes are not used here.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar
from xml.etree import ElementTree

import numpy as np

from sojourn_config.errors import MISSING, ConfigError, Problem, single
from sojourn_config.paths import display
from sojourn_config.urdf_checks import MOST_BYTES, element_problems
from sojourn_machine.params import FloatArray

Part = TypeVar("Part")

LIMITED = ("revolute", "prismatic")
MOVING = ("revolute", "prismatic", "continuous")


@dataclass(frozen=True, slots=True, eq=False)
class UrdfJoint:
    """One joint.

    Args:
        transform_parent_to_joint: homogeneous transform at zero pose, shape (4, 4) [m].
        axis: unit vector that it turns about or slides along, in its own frame, shape (3,).
        lower, upper: position limits, infinite where there are none [rad or m].
        velocity, effort: limits, infinite where there are none [rad/s or m/s; N m or N].
    """

    name: str
    kind: str
    parent: str
    child: str
    transform_parent_to_joint: FloatArray
    lower: float
    upper: float
    velocity: float
    effort: float
    axis: FloatArray

    @property
    def unit(self) -> str:
        """Of its position."""
        return "m" if self.kind == "prismatic" else "rad"

    @property
    def effort_unit(self) -> str:
        """Of its effort."""
        return "N" if self.kind == "prismatic" else "N m"


@dataclass(frozen=True, slots=True, eq=False)
class UrdfInertial:
    """Mass [kg], inertia of a link about its centre of mass, shape (3, 3) [kg m^2], and that centre in it, (3,) [m]."""

    mass: float
    inertia: FloatArray
    centre: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class UrdfSummary:
    """A machine description as text and as the names that other files may use.

    Args:
        file: name for messages.
        text: the XML.
        joints: by name, in the order of the file.
        links: names, in the order of the file.
        cylinders: (radius, length) of the collision cylinder of each link that has exactly one [m].
        inertials: of the links that have one.
    """

    file: str
    text: str
    joints: dict[str, UrdfJoint]
    links: tuple[str, ...]
    cylinders: dict[str, tuple[float, float]]
    inertials: dict[str, UrdfInertial]

    @property
    def moving_joints(self) -> tuple[str, ...]:
        """Names of the joints that are not fixed."""
        return tuple(name for name, joint in self.joints.items() if joint.kind in MOVING)

    @property
    def root(self) -> str:
        """The outermost link."""
        children = {joint.child for joint in self.joints.values()}
        return next(link for link in self.links if link not in children)

    def joints_above(self, link: str) -> list[str]:
        """Joints that carry a link, the first one first."""
        above = {joint.child: joint for joint in self.joints.values()}
        found: list[str] = []
        while link in above:
            found.insert(0, above[link].name)
            link = above[link].parent
        return found

    def below(self, link: str) -> tuple[str, ...]:
        """A link and all that hang on it, in the order of the file."""
        found, frontier = {link}, [link]
        while frontier:
            here = frontier.pop()
            children = [joint.child for joint in self.joints.values() if joint.parent == here]
            found.update(children)
            frontier += children
        return tuple(name for name in self.links if name in found)

    def position_in_link(self, joint: str, link: str) -> FloatArray:
        """Origin of a joint in the frame of a link above it, at zero pose: shape (3,) [m].

        Raises:
            ConfigError: the link is not above the joint.
        """
        return self.point_in_link(self.joints[joint].child, (0.0, 0.0, 0.0), link)

    def point_in_link(self, link: str, point: Sequence[float], above: str) -> FloatArray:
        """A point of a link, (3,) [m], in the frame of the link itself or of one above it, at zero pose: shape (3,)
        [m].

        Raises:
            ConfigError: the one link is not above the other.
        """
        carriers = {entry.child: entry for entry in self.joints.values()}
        place, here = np.array((*point, 1.0)), link
        while here != above:
            if here not in carriers:
                raise single(self.file, f"link {link}", MISSING, f"allowed is a link below {above}")
            place = carriers[here].transform_parent_to_joint @ place
            here = carriers[here].parent
        return np.array(place[:3])


def read_urdf(path: Path) -> UrdfSummary:
    """Read a URDF file.

    Raises:
        ConfigError: it cannot be read, is not XML, or lacks what a URDF must have.
    """
    file = display(path)
    try:
        if path.stat().st_size > MOST_BYTES:
            raise single(file, "", MISSING, f"allowed are at most {MOST_BYTES} bytes")
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise single(file, "", MISSING, f"cannot be read: {error}") from error
    return parse_urdf(text, file, path.parent)


def parse_urdf(text: str, file: str, folder: Path | None = None) -> UrdfSummary:
    """Read the text of a URDF. `file`: its name, for messages. `folder`: where it lies, to look for its meshes.

    Raises:
        ConfigError: it is not XML, or lacks what a URDF must have.
    """
    try:
        root = ElementTree.fromstring(text.encode("utf-8"))
    except ElementTree.ParseError as error:
        raise single(file, "", MISSING, f"not an XML document: {error}", error.position[0]) from error
    if root.tag != "robot":
        raise ConfigError([Problem(file, root.tag, "", "allowed as the outermost element is robot")])
    if wrong := list(element_problems(root, file, folder)):
        raise ConfigError(wrong)
    faults: list[str] = []
    joints = _each(_joint, root.findall("joint"), faults)
    links = tuple(_each(lambda element: _attribute(element, "name"), root.findall("link"), faults))
    cylinders = dict(_each(_cylinder, [link for link in root.findall("link") if _has_one_cylinder(link)], faults))
    inertials = dict(
        _each(_inertial, [link for link in root.findall("link") if link.find("inertial") is not None], faults)
    )
    if faults:
        raise ConfigError(Problem(file, "", "", fault) for fault in faults)
    problems = [
        Problem(file, f"joint {joint.name}", link, "not a link of this file")
        for joint in joints
        for link in (joint.parent, joint.child)
        if link not in links
    ]
    for kind, names in (("joint", [joint.name for joint in joints]), ("link", list(links))):
        problems += [
            Problem(file, f"{kind} {name}", "", f"is there {names.count(name)} times: allowed is once")
            for name in sorted(set(names))
            if names.count(name) > 1
        ]
    problems = problems or list(_tree_problems(file, joints, links))
    if problems:
        raise ConfigError(problems)
    return UrdfSummary(file, text, {joint.name: joint for joint in joints}, links, cylinders, inertials)


def _each(
    read: Callable[[ElementTree.Element], Part], elements: Iterable[ElementTree.Element], faults: list[str]
) -> list[Part]:
    """What `read` makes of the elements; its faults are collected, so that all of them are told together."""
    found = []
    for element in elements:
        try:
            found.append(read(element))
        except ValueError as error:
            faults.append(str(error))
    return found


def _tree_problems(file: str, joints: list[UrdfJoint], links: tuple[str, ...]) -> Iterator[Problem]:
    """Where the joints do not make one tree of the links."""
    children = [joint.child for joint in joints]
    for link in sorted({child for child in children if children.count(child) > 1}):
        above = ", ".join(joint.name for joint in joints if joint.child == link)
        yield Problem(file, f"link {link}", "", f"is below several joints ({above}): allowed is one")
    roots = [link for link in links if link not in children]
    if len(roots) != 1:
        found = ", ".join(roots) if roots else "none"
        yield Problem(
            file, "robot", "", f"links that are below no joint: {found}; allowed is one, the root of all others"
        )
        return
    reached, frontier = {roots[0]}, [roots[0]]
    while frontier:
        here = frontier.pop()
        below = [joint.child for joint in joints if joint.parent == here and joint.child not in reached]
        reached.update(below)
        frontier += below
    for link in links:
        if link not in reached:
            yield Problem(file, f"link {link}", "", f"its joints make a ring: allowed is a tree from {roots[0]}")


def _joint(element: ElementTree.Element) -> UrdfJoint:
    name = _attribute(element, "name")
    kind = _attribute(element, "type")
    limit = element.find("limit")
    if kind in LIMITED and (limit is None or "lower" not in limit.attrib or "upper" not in limit.attrib):
        raise ValueError(f"joint {name}: a {kind} joint needs a limit with lower and upper")
    bounded = kind in LIMITED
    return UrdfJoint(
        name=name,
        kind=kind,
        parent=_attribute(_child(element, "parent", name), "link"),
        child=_attribute(_child(element, "child", name), "link"),
        transform_parent_to_joint=_transform(element.find("origin")),
        lower=_number(limit, "lower", name) if bounded else -math.inf,
        upper=_number(limit, "upper", name) if bounded else math.inf,
        velocity=_number(limit, "velocity", name),
        effort=_number(limit, "effort", name),
        axis=_axis(element.find("axis"), name),
    )


def _axis(element: ElementTree.Element | None, joint: str) -> FloatArray:
    """Unit vector; x where the URDF says nothing, as its specification has it."""
    if element is None:
        return np.array([1.0, 0.0, 0.0])
    axis = _triple(element, "xyz")
    length = float(np.linalg.norm(axis))
    if length < 1e-9:
        raise ValueError(f"joint {joint}: axis = {element.get('xyz')!r}: allowed is a direction")
    return np.asarray(axis / length)


def _inertial(link: ElementTree.Element) -> tuple[str, UrdfInertial]:
    name = _attribute(link, "name")
    mass, inertia = link.find("inertial/mass"), link.find("inertial/inertia")
    if mass is None or inertia is None:
        raise ValueError(f"link {name}: its inertial needs mass and inertia")
    value = {key: _number(inertia, key, f"link {name}") for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")}
    matrix = np.array(
        [
            [value["ixx"], value["ixy"], value["ixz"]],
            [value["ixy"], value["iyy"], value["iyz"]],
            [value["ixz"], value["iyz"], value["izz"]],
        ]
    )
    centre = _transform(link.find("inertial/origin"))[:3, 3]
    found = UrdfInertial(_number(mass, "value", f"link {name}"), matrix, centre)
    if not (np.isfinite(found.mass) and np.all(np.isfinite(matrix))):
        raise ValueError(f"link {name}: mass and ixx, ixy, ixz, iyy, iyz, izz are all needed, and finite")
    return name, found


def _has_one_cylinder(link: ElementTree.Element) -> bool:
    return len(link.findall("collision/geometry/cylinder")) == 1


def _cylinder(link: ElementTree.Element) -> tuple[str, tuple[float, float]]:
    name = _attribute(link, "name")
    cylinder = link.find("collision/geometry/cylinder")
    return name, (_number(cylinder, "radius", name), _number(cylinder, "length", name))


def _transform(origin: ElementTree.Element | None) -> FloatArray:
    transform = np.eye(4)
    if origin is None:
        return transform
    position, angles = _triple(origin, "xyz"), _triple(origin, "rpy")
    (cr, cp, cy), (sr, sp, sy) = np.cos(angles), np.sin(angles)
    transform[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    transform[:3, 3] = position
    return transform


def _triple(origin: ElementTree.Element, name: str) -> FloatArray:
    text = origin.get(name, "0 0 0")
    try:
        values = np.array([float(part) for part in text.split()])
    except ValueError as error:
        raise ValueError(f"origin {name} = {text!r}: allowed are three numbers") from error
    if values.shape != (3,) or not np.all(np.isfinite(values)):
        raise ValueError(f"origin {name} = {text!r}: allowed are three numbers")
    return values


def _number(element: ElementTree.Element | None, name: str, owner: str) -> float:
    text = None if element is None else element.get(name)
    if text is None:
        return math.inf
    try:
        value = float(text)
    except ValueError as error:
        raise ValueError(f"{owner}: {name} = {text!r}: allowed is a number") from error
    if math.isnan(value):
        raise ValueError(f"{owner}: {name} = {text!r}: allowed is a number")
    return value


def _attribute(element: ElementTree.Element, name: str) -> str:
    value = element.get(name)
    if not value:
        raise ValueError(f"an element {element.tag} has no {name}")
    return value


def _child(element: ElementTree.Element, tag: str, owner: str) -> ElementTree.Element:
    child = element.find(tag)
    if child is None:
        raise ValueError(f"joint {owner} has no {tag}")
    return child
