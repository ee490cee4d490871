"""Checks of a scenario against its ground and its arm: goals on the map, named poses that exist."""

import math
import typing
from collections.abc import Iterator

from sojourn_config.bundle import Bundle
from sojourn_config.errors import Problem
from sojourn_config.steps import ArmGroundStep, ArmJointsStep, ArmPoseStep, DriveGoalStep, DriveRouteStep
from sojourn_config.urdf import UrdfSummary
from sojourn_config.yaml_file import KeyPath, YamlDocument
from sojourn_flight.arm.params import ArmParams
from sojourn_machine.names import names_text
from sojourn_physics.terrain.params import TerrainParams

if typing.TYPE_CHECKING:
    from sojourn_config.scenario import ScenarioConfig

EDGE = 2.0
"""Drive goals and the start keep this far from the edge of the map [m]."""


def scenario_problems(config: "ScenarioConfig", bundle: Bundle | None, document: YamlDocument) -> Iterator[Problem]:
    """All that does not fit. Without a bundle (its files have problems) only the goals are looked at."""
    places: list[tuple[KeyPath, float, float]] = [(("start",), config.start.x, config.start.y)]
    for index, step in enumerate(config.steps):
        path: KeyPath = ("steps", index, step.kind)
        action = step.action
        if isinstance(action, DriveGoalStep | DriveRouteStep) and bundle is not None and bundle.driving is None:
            yield document.problem(path, step.kind, f"the machine {config.machine} stands fast: it has no wheels")
        elif isinstance(action, DriveGoalStep):
            places.append((path, action.x, action.y))
        elif isinstance(action, DriveRouteStep):
            places += [((*path, "points", i), point.x, point.y) for i, point in enumerate(action.points)]
        elif isinstance(action, ArmPoseStep | ArmGroundStep | ArmJointsStep) and bundle is not None:
            if bundle.arm is None:
                yield document.problem(path, step.kind, f"the machine {config.machine} has no arm")
            elif isinstance(action, ArmJointsStep):
                yield from _arm_goal_problems(action, path, bundle.arm, bundle.urdf, document)
    if bundle is not None and bundle.body.free_fall and bundle.machine.stands_on:
        allowed = f"is in free fall, where {config.machine} does not press on the ground: allowed is a planet, "
        yield document.problem(("body",), config.body, allowed + "a moon or an asteroid")
    if bundle is not None:
        yield from _fault_problems(config, bundle, document)
    for index, thing in enumerate(config.objects):
        path = ("objects", index)
        places.append((path, thing.x, thing.y))
        if any(other.name == thing.name for other in config.objects[:index]):
            yield document.problem((*path, "name"), thing.name, "is there above already: allowed is each name once")
    for path, x, y in places:
        yield from _place_problems(config.terrain, path, x, y, document)


def _place_problems(
    terrain: TerrainParams, path: KeyPath, x: float, y: float, document: YamlDocument
) -> Iterator[Problem]:
    rows, columns = terrain.node_counts
    x_min, y_min = terrain.origin
    ranges = (
        ("x", x, x_min + EDGE, x_min + (columns - 1) * terrain.resolution - EDGE),
        ("y", y, y_min + EDGE, y_min + (rows - 1) * terrain.resolution - EDGE),
    )
    for key, value, low, high in ranges:
        if low > high:
            allowed = f"the map is too small: allowed is more than {2.0 * EDGE:g} m in {key}"
            yield document.problem(("terrain", f"size_{key}"), high - low + 2.0 * EDGE, allowed)
        elif not low <= value <= high:
            allowed = f"is off the terrain or within {EDGE:g} m of its edge: allowed is {low:g} to {high:g} m"
            yield document.problem((*path, key), value, allowed)


def _fault_problems(config: "ScenarioConfig", bundle: Bundle, document: YamlDocument) -> Iterator[Problem]:
    """A motor that fails is one of the machine's, and an angle at which it locks one that it can reach."""
    servos = {joint: drive.servo.mode for drive in bundle.machine.drives for joint in drive.joints}
    for index, fault in enumerate(config.faults):
        path: KeyPath = ("faults", index)
        if fault.joint not in servos:
            yield document.problem((*path, "joint"), fault.joint, "has no motor: " + names_text(fault.joint, servos))
            continue
        if any(other.joint == fault.joint for other in config.faults[:index]):
            yield document.problem((*path, "joint"), fault.joint, "fails above already: allowed is one fault a joint")
        if fault.angle_deg is None:
            continue
        joint = bundle.urdf.joints[fault.joint]
        low, high = math.degrees(joint.lower), math.degrees(joint.upper)
        if servos[fault.joint] != "position":
            allowed = "its motor is commanded by rate: allowed is no angle"
            yield document.problem((*path, "angle_deg"), fault.angle_deg, allowed)
        elif not low <= fault.angle_deg <= high:
            allowed = f"allowed is {low:g} to {high:g} degrees, the limits of {fault.joint}"
            yield document.problem((*path, "angle_deg"), fault.angle_deg, allowed)


def _arm_goal_problems(
    action: ArmJointsStep, path: KeyPath, arm: ArmParams, urdf: UrdfSummary, document: YamlDocument
) -> Iterator[Problem]:
    if action.name is not None and action.name not in arm.named_poses:
        allowed = "is no pose of the arm: " + names_text(action.name, arm.named_poses)
        yield document.problem((*path, "name"), action.name, allowed)
    if action.positions is None:
        return
    names = arm.joint_names
    if len(action.positions) != len(names):
        allowed = f"has {len(action.positions)} values: allowed is {len(names)}, for " + ", ".join(names)
        yield document.problem((*path, "positions"), list(action.positions), allowed)
        return
    for index, (value, name) in enumerate(zip(action.positions, names, strict=True)):
        joint = urdf.joints[name]
        if not joint.lower <= value <= joint.upper:
            allowed = f"allowed is {joint.lower:g} to {joint.upper:g} {joint.unit}, the limits of {name}"
            yield document.problem((*path, "positions", index), value, allowed)
