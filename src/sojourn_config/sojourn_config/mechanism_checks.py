"""Checks of a machine's mechanism: masses and inertias of its URDF, axes of its wheels, couplings of its joints."""

from collections.abc import Collection, Iterator

import numpy as np

from sojourn_config.errors import Problem
from sojourn_config.machine import MachineConfig
from sojourn_config.urdf import UrdfSummary
from sojourn_config.yaml_file import YamlDocument
from sojourn_machine.names import names_text
from sojourn_machine.params import FloatArray

SAME_MASS = 1e-3
"""Largest difference of two masses that are meant to be one, as a part of them."""
SAME_DIRECTION = 1e-6
BASE_LINK = "base_link"
UPRIGHT = 0.866
"""Least vertical part of a steering axis: its wheels are steered as if it were vertical."""
FAR = 20.0
"""Preload of a spring: greatest distance of its relaxed end from the middle of the joint, in travels."""
TRIANGLE = 1e-6
"""Slack of the inequality of the principal moments of inertia, as a part of the largest: rounding of the file."""


def mechanism_problems(
    config: MachineConfig, urdf: UrdfSummary, document: YamlDocument, as_published: Collection[str] = ()
) -> Iterator[Problem]:
    """All that is wrong.

    Args:
        document: the machine's file, for messages. as_published: links whose inertia is not judged.
    """
    yield from _inertia_problems(urdf, as_published)
    yield from _weightless_problems(urdf)
    yield from _axis_problems(config, urdf)
    yield from _steering_problems(config, urdf)
    yield from _suspension_problems(config, urdf, document)
    yield from _coupling_problems(config, urdf, document)


def mass_problems(config: MachineConfig, urdf: UrdfSummary, document: YamlDocument) -> Iterator[Problem]:
    """A machine, without an arm that is mounted on it, weighs what its file says."""
    total = sum(inertial.mass for inertial in urdf.inertials.values())
    if config.mass is not None and abs(total - config.mass) > SAME_MASS * config.mass:
        yield document.problem(("mass",), config.mass, f"the masses of {urdf.file} sum up to {total:g} kg")


def _inertia_problems(urdf: UrdfSummary, as_published: Collection[str]) -> Iterator[Problem]:
    """A body has a mass above zero, and moments of inertia that some distribution of mass can have."""
    for name, inertial in urdf.inertials.items():
        if name in as_published:
            continue
        key = f"link {name}"
        if inertial.mass <= 0.0:
            yield Problem(urdf.file, f"{key}, mass", f"{inertial.mass:g}", "allowed is more than 0 kg")
        moments = np.linalg.eigvalsh(inertial.inertia)
        shown = ", ".join(f"{moment:.4g}" for moment in moments)
        if moments[0] <= 0.0:
            yield Problem(urdf.file, f"{key}, inertia", shown, "allowed are principal moments of more than 0 kg m2")
        elif moments[0] + moments[1] < moments[2] * (1.0 - TRIANGLE):
            allowed = "no body has these principal moments: each is at most the sum of the other two"
            yield Problem(urdf.file, f"{key}, inertia", shown, allowed)


def _weightless_problems(urdf: UrdfSummary) -> Iterator[Problem]:
    """A moving joint needs mass below it, down to the next moving joints' bodies and with them."""

    def mass_below(link: str) -> float:
        own = urdf.inertials[link].mass if link in urdf.inertials else 0.0
        return own + sum(mass_below(joint.child) for joint in urdf.joints.values() if joint.parent == link)

    for name in urdf.moving_joints:
        if mass_below(urdf.joints[name].child) == 0.0:
            allowed = "moves nothing that has a mass: allowed is an inertial in a link below it"
            yield Problem(urdf.file, f"joint {name}", urdf.joints[name].child, allowed)


def _axis_problems(config: MachineConfig, urdf: UrdfSummary) -> Iterator[Problem]:
    """The plant takes the y axis of a wheel's or a sprocket's joint for its axle, and that to the left at zero pose."""
    for wheel in config.rolling:
        joint = urdf.joints.get(wheel.joint)
        if joint is None or joint.kind == "fixed":
            continue  # told elsewhere
        own = " ".join(f"{value:g}" for value in joint.axis)
        if np.abs(joint.axis - [0.0, 1.0, 0.0]).max() > SAME_DIRECTION:
            allowed = f"allowed is 0 1 0: it is the axle of {wheel.name}"
            yield Problem(urdf.file, f"joint {wheel.joint}, axis", own, allowed)
        elif _direction_in_root(urdf, wheel.joint)[1] <= 0.0:
            allowed = f"points to the right at zero pose, so that {wheel.name} would drive backwards"
            yield Problem(urdf.file, f"joint {wheel.joint}, axis", own, allowed)


def _steering_problems(config: MachineConfig, urdf: UrdfSummary) -> Iterator[Problem]:
    """A steering joint is above its wheel and turns it to the left: only then does an angle mean what is commanded."""
    above = {joint.child: joint for joint in urdf.joints.values()}
    for wheel in config.wheels:
        steer, joint = urdf.joints.get(wheel.steer_joint or ""), urdf.joints.get(wheel.joint)
        if steer is None or joint is None:
            continue  # not steered, or told elsewhere
        chain = []
        while joint.parent in above:
            joint = above[joint.parent]
            chain.append(joint.name)
        if steer.name not in chain:
            allowed = f"is not between {BASE_LINK} and wheel {wheel.name}: allowed is one that turns it"
            yield Problem(urdf.file, f"joint {steer.name}", steer.child, allowed)
        elif steer.kind != "fixed" and _direction_in_root(urdf, steer.name)[2] < UPRIGHT:
            own = " ".join(f"{value:g}" for value in steer.axis)
            allowed = "does not point up: allowed is an axis at most 30 degrees from the vertical at zero pose"
            yield Problem(urdf.file, f"joint {steer.name}, axis", own, allowed)


def _direction_in_root(urdf: UrdfSummary, name: str) -> FloatArray:
    """Axis of a joint at zero pose in the root link, shape (3,)."""
    above = {joint.child: joint for joint in urdf.joints.values()}
    joint = urdf.joints[name]
    direction = joint.transform_parent_to_joint[:3, :3] @ joint.axis
    while joint.parent in above:
        joint = above[joint.parent]
        direction = joint.transform_parent_to_joint[:3, :3] @ direction
    return np.asarray(direction)


def _suspension_problems(config: MachineConfig, urdf: UrdfSummary, document: YamlDocument) -> Iterator[Problem]:
    """A spring acts on a joint that moves between stops, and is not relaxed far beyond them."""
    for index, suspension in enumerate(config.suspensions):
        for number, name in enumerate(suspension.joints):
            path = ("suspensions", index, "joints", number)
            joint = urdf.joints.get(name)
            if joint is None or joint.kind not in ("revolute", "prismatic"):
                why = "is not a joint" if joint is None else f"is {joint.kind}"
                able = [other.name for other in urdf.joints.values() if other.kind in ("revolute", "prismatic")]
                yield document.problem(path, name, f"{why} in {urdf.file}: " + names_text(name, able))
            elif abs(suspension.rest - 0.5 * (joint.lower + joint.upper)) > FAR * (joint.upper - joint.lower):
                allowed = f"allowed is at most {FAR:g} times the travel of {name} from its middle, in {urdf.file}"
                yield document.problem(("suspensions", index, "rest"), suspension.rest, allowed)


def _coupling_problems(config: MachineConfig, urdf: UrdfSummary, document: YamlDocument) -> Iterator[Problem]:
    """Couplings must be independent: two that say the same make the equations of motion singular."""
    names = urdf.moving_joints
    rows = np.zeros((0, len(names)))
    for index, coupling in enumerate(config.couplings):
        if coupling.first not in names or coupling.second not in names:
            continue  # told elsewhere
        if coupling.first == coupling.second:
            yield document.problem(
                ("couplings", index, "second"), coupling.second, "allowed is another joint than first"
            )
            continue
        row = np.zeros(len(names))
        row[names.index(coupling.first)] = 1.0
        row[names.index(coupling.second)] = coupling.ratio
        more = np.vstack([rows, row])
        if np.linalg.matrix_rank(more) < len(more):
            pair = f"{coupling.first}, {coupling.second}"
            allowed = "follows from the couplings above, or contradicts them: allowed is each of them once"
            yield document.problem(("couplings", index), pair, allowed)
        else:
            rows = more
