"""One URDF of two: an arm's, bolted to a link of a machine's.

The arm's links and joints get a prefix; its first link is fixed to the machine by a joint of its own. What neither the
plant nor the arm's node reads is left out: the arm's transmissions (its drives are in `config/arms`) and anything else
outside links, joints and materials; a material of the machine's goes before one of that name of the arm's.
"""

from copy import deepcopy
from xml.etree import ElementTree

from sojourn_config.errors import ConfigError, Problem
from sojourn_config.machine import ArmMountParams
from sojourn_config.urdf import UrdfSummary, parse_urdf


def mounted_urdf(machine: UrdfSummary, arm: UrdfSummary, root: str, mount: ArmMountParams) -> UrdfSummary:
    """The machine, which has the mount's link, with the arm on it.

    Args:
        root: link with which the arm begins in its file.

    Raises:
        ConfigError: a name is on both.
    """
    links = arm.below(root)
    joints = [joint.name for joint in arm.joints.values() if joint.parent in links]
    foot = mount.foot
    clashes = [
        Problem(machine.file, f"{kind} {name}", "", f"is in {arm.file} too: allowed is another arm_mount.prefix")
        for kind, theirs, ours in (
            ("link", [mount.prefix + link for link in links], machine.links),
            ("joint", [foot, *(mount.prefix + joint for joint in joints)], tuple(machine.joints)),
        )
        for name in theirs
        if name in ours
    ]
    if clashes:
        raise ConfigError(clashes)
    whole, part = ElementTree.fromstring(machine.text), ElementTree.fromstring(arm.text)
    whole.append(_foot(foot, mount, mount.prefix + root))
    taken = {"link": links, "joint": joints}
    materials = {element.get("name") for element in whole.findall("material")}
    for element in part:
        if element.get("name") in taken.get(element.tag, ()):
            whole.append(_renamed(element, mount.prefix))
        elif element.tag == "material" and element.get("name") not in materials:
            whole.append(element)
    return parse_urdf(ElementTree.tostring(whole, encoding="unicode"), f"{machine.file} with {arm.file}")


def _foot(name: str, mount: ArmMountParams, child: str) -> ElementTree.Element:
    joint = ElementTree.Element("joint", {"name": name, "type": "fixed"})
    ElementTree.SubElement(joint, "parent", {"link": mount.link})
    ElementTree.SubElement(joint, "child", {"link": child})
    place = {"xyz": " ".join(map(repr, mount.xyz)), "rpy": " ".join(map(repr, mount.rpy))}
    ElementTree.SubElement(joint, "origin", place)
    return joint


def _renamed(element: ElementTree.Element, prefix: str) -> ElementTree.Element:
    """A copy of a link or a joint with the prefix before its own name and before the links that it names."""
    copied = deepcopy(element)
    copied.set("name", prefix + str(copied.get("name")))
    for end in (*copied.findall("parent"), *copied.findall("child")):
        end.set("link", prefix + str(end.get("link")))
    mimic = copied.find("mimic")
    if mimic is not None:
        mimic.set("joint", prefix + str(mimic.get("joint")))
    return copied
