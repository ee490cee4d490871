"""Who may say and hear what, as a policy of SROS 2: each role its rows of the topic table, and nothing else.

The policy is the file of `ros2 security` (SROS 2 policy schema 0.2.0; Mayoral-Vilches et al. 2022, "SROS2: Usable Cyber
Security Tools for ROS 2"). What it does not allow, DDS security denies.
"""

from collections.abc import Iterable, Sequence
from xml.etree import ElementTree

from sojourn_contract.bundling import REPEATS, bundle_of
from sojourn_contract.topic_table import TopicTable

ENCLAVES = "/sojourn"
RECORDER = "recorder"
SUPERVISOR = "supervisor"
"""The node of start.py, which hears how the others are and says nothing."""
_SUPERVISED = ("/diagnostics", "/drive/status")
_VIEWED = ("/robot_description", "/tf_static", "/tf")
"""What the recorder says to viewers, see `sojourn_bags.live_model`: rows of no contract."""
_EVERY_NODE = ("/parameter_events",)
"""What the ROS library itself says, of every node of ours, see `closed_node`."""


def enclave_of(role: str) -> str:
    """Path of a role's enclave."""
    return f"{ENCLAVES}/{role}"


def access_policy(
    table: TopicTable, participants: Sequence[str], namespace: str = "", companions: Sequence[str] = ()
) -> str:
    """The policy of a run, as XML.

    Args:
        table: of the run's machine. participants: all roles. namespace: of the topics, with its slash, or empty.
        companions: roles that hear each other in bundles.
    """
    root = ElementTree.Element("policy", version="0.2.0")
    enclaves = ElementTree.SubElement(root, "enclaves")
    for role in participants:
        says = [row.name for row in table.outputs_of(role, participants)]
        hears = [row.name for row in table.inputs_of(role, participants)]
        says += _VIEWED if role == RECORDER else ()
        if role in companions:
            says += [bundle_of(role).name, REPEATS.name]
            hears += [*(bundle_of(other).name for other in companions if other != role), REPEATS.name]
        _add_enclave(enclaves, role, namespace, says, hears)
    _add_enclave(enclaves, SUPERVISOR, namespace, (), _SUPERVISED)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _add_enclave(
    enclaves: ElementTree.Element, node: str, namespace: str, says: Iterable[str], hears: Iterable[str]
) -> None:
    enclave = ElementTree.SubElement(enclaves, "enclave", path=enclave_of(node))
    profiles = ElementTree.SubElement(enclave, "profiles")
    profile = ElementTree.SubElement(profiles, "profile", ns=namespace or "/", node=node)
    named = {"publish": {f"{namespace}{name}" for name in says} | set(_EVERY_NODE)}
    named["subscribe"] = {f"{namespace}{name}" for name in hears}
    for what, names in named.items():
        if names:
            topics = ElementTree.SubElement(profile, "topics", {what: "ALLOW"})
            for name in sorted(names):
                ElementTree.SubElement(topics, "topic").text = name
