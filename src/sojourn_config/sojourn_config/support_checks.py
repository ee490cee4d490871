"""Checks of what a machine stands on: wheels and tracks against the URDF and the ground."""

from collections.abc import Iterator

from sojourn_config.errors import MISSING, Problem
from sojourn_config.machine import MachineConfig
from sojourn_config.urdf import UrdfSummary
from sojourn_config.yaml_file import KeyPath, YamlDocument
from sojourn_machine.names import names_text
from sojourn_physics.contact.soil_needs import needs_of_soil
from sojourn_physics.soil.params import SoilParams

SAME_LENGTH = 1e-6
"""Largest difference of two lengths that are meant to be one [m]."""


def support_problems(config: MachineConfig, urdf: UrdfSummary, document: YamlDocument) -> Iterator[Problem]:
    """What does not fit of wheels and tracks."""
    yield from _wheel_problems(config, urdf, document)
    yield from _track_problems(config, urdf, document)


def ground_problems(config: MachineConfig, soil: SoilParams, document: YamlDocument) -> list[Problem]:
    """What the contact models of the supports need of a soil and its file does not give, one problem a key; and a soil
    that has no stiffness under wheels as narrow as these.
    """
    askers: dict[str, list[str]] = {}
    for support, law, lacking in needs_of_soil(config, soil):
        for name in lacking:
            askers.setdefault(name, []).append(f"{support} ({law})")
    missing = [
        document.problem((name,), MISSING, "the key is missing: needed by the contact model of " + ", ".join(supports))
        for name, supports in askers.items()
    ]
    narrow = [f"{one.name} ({one.width:g} m)" for one in config.rolling if one.width <= soil.least_width]
    if narrow:
        allowed = f"allowed is more than {-soil.k_phi:g} times the width, or the ground pulls at {', '.join(narrow)}"
        missing.append(document.problem(("k_c",), soil.k_c, allowed))
    return missing


def joint_problem(document: YamlDocument, path: KeyPath, name: str, urdf: UrdfSummary) -> Problem | None:
    """The problem with a joint's name, or None where the URDF has that joint and it moves."""
    if name in urdf.moving_joints:
        return None
    why = "is fixed" if name in urdf.joints else "is not a joint"
    return document.problem(path, name, f"{why} in {urdf.file}: " + names_text(name, urdf.moving_joints))


def _kind_problems(document: YamlDocument, path: KeyPath, name: str, kind: str, urdf: UrdfSummary) -> Iterator[Problem]:
    """What is wrong with a joint that is to be of a kind."""
    problem = joint_problem(document, path, name, urdf)
    if problem is not None:
        yield problem
    elif urdf.joints[name].kind != kind:
        yield document.problem(path, name, f"is {urdf.joints[name].kind} in {urdf.file}: allowed is {kind}")


def _wheel_problems(config: MachineConfig, urdf: UrdfSummary, document: YamlDocument) -> Iterator[Problem]:
    driven = {joint for drive in config.drives for joint in drive.joints}
    for index, wheel in enumerate(config.wheels):
        path: KeyPath = ("wheels", index)
        yield from _kind_problems(document, (*path, "joint"), wheel.joint, "continuous", urdf)
        if wheel.joint not in urdf.moving_joints:
            continue
        joint = urdf.joints[wheel.joint]
        if wheel.joint not in driven:
            yield document.problem((*path, "joint"), wheel.joint, "has no drive: name it in drives")
        size = urdf.cylinders.get(joint.child)
        if size is None:
            allowed = f"its link {joint.child} has not one collision cylinder in {urdf.file}"
            yield document.problem((*path, "joint"), wheel.joint, allowed)
        else:
            for key, value, wanted in (("radius", wheel.radius, size[0]), ("width", wheel.width, size[1])):
                if abs(value - wanted) > SAME_LENGTH:
                    allowed = f"allowed is {wanted:g} m, that of the cylinder of {joint.child} in {urdf.file}"
                    yield document.problem((*path, key), value, allowed)
        if wheel.steer_joint is not None:
            yield from _kind_problems(document, (*path, "steer_joint"), wheel.steer_joint, "revolute", urdf)


def _track_problems(config: MachineConfig, urdf: UrdfSummary, document: YamlDocument) -> Iterator[Problem]:
    for index, track in enumerate(config.tracks):
        path: KeyPath = ("tracks", index)
        if track.link not in urdf.links:
            allowed = f"is no link of {urdf.file}: " + names_text(track.link, urdf.links)
            yield document.problem((*path, "link"), track.link, allowed)
        yield from _kind_problems(document, (*path, "joint"), track.joint, "continuous", urdf)
        if track.joint in urdf.moving_joints and track.link == urdf.joints[track.joint].child:
            allowed = "turns with the sprocket: allowed is the link that carries it"
            yield document.problem((*path, "link"), track.link, allowed)
