"""Checks of a scenario against its ground and its arm: goals on the map, named poses that exist."""

import typing
from collections.abc import Iterator

import numpy as np

from sojourn_config.bundle import Bundle
from sojourn_config.errors import Problem
from sojourn_config.steps import Step
from sojourn_config.yaml_file import KeyPath, YamlDocument
from sojourn_config.zone_checks import zone_place_problems, zone_problems
from sojourn_flight.power_manager.activities import activity_problems
from sojourn_machine.errors import InvalidValueError, MachineError
from sojourn_machine.fault_choice import FaultableMachine
from sojourn_machine.names import names_text
from sojourn_physics.environment.sun.over import sun_path
from sojourn_physics.terrain.params import TerrainParams

if typing.TYPE_CHECKING:
    from sojourn_config.scenario import ScenarioConfig

AFLOAT = ("z", "velocity", "rates_deg_per_s")
"""Keys of `start` that are for a machine that floats."""
EDGE = 2.0
"""Drive goals and the start keep this far from the edge of the map [m]."""


def scenario_problems(config: "ScenarioConfig", bundle: Bundle | None, document: YamlDocument) -> Iterator[Problem]:
    """All that does not fit. Without a bundle (its files have problems) only the goals are looked at."""
    places: list[tuple[KeyPath, float, float]] = []
    if bundle is None or not bundle.machine.floats:
        places.append((("start",), config.start.x, config.start.y))
    for index, step in enumerate(config.steps):
        path: KeyPath = ("steps", index, step.kind)
        action: Step = step.action
        lacking = "" if bundle is None else _lacking(action.role, bundle)
        if lacking:
            yield document.problem(path, step.kind, f"the machine {config.machine} {lacking}")
            continue
        asked = [((*path, *at), x, y) for at, x, y in action.places()]
        places += asked
        if action.role == "drive":
            yield from zone_place_problems(config, asked, document)
        for at, value, allowed in () if bundle is None else action.problems(bundle):
            yield document.problem((*path, *at), value, allowed)
    yield from zone_problems(config, document)
    places += [(("waypoints", name), place.x, place.y) for name, place in config.waypoints.items()]
    if bundle is not None and bundle.body.free_fall and bundle.machine.stands_on:
        allowed = f"is in free fall, where {config.machine} does not press on the ground: allowed is a planet, "
        yield document.problem(("body",), config.body, allowed + "a moon or an asteroid")
    if bundle is not None:
        yield from _afloat_problems(config, bundle, document)
    if bundle is not None and config.wind is not None:
        try:
            bundle.body.air_at(bundle.site)
        except MachineError as error:
            yield document.problem(("wind",), config.body, str(error))
    if bundle is not None and not bundle.body.ground:
        yield document.problem(
            ("body",), config.body, "has no ground: allowed is a planet, a moon or an asteroid that has"
        )
    if bundle is not None:
        yield from _fault_problems(config, bundle, document)
        yield from _sun_problems(config, bundle, document)
        yield from _link_problems(config, bundle, document)
        yield from _air_problems(config, bundle, document)
        yield from _magnetic_problems(bundle, document)
        yield from _soil_problems(bundle, document)
        if bundle.thermal is not None and bundle.body.regolith is None:
            allowed = f"has no table regolith, which the heat of {config.machine} goes by"
            yield document.problem(("body",), config.body, allowed)
        for place, key, value, allowed in activity_problems(bundle.power_manager, config.activities):
            yield document.problem(("activities", place, key), value, allowed)
    for index, thing in enumerate(config.objects):
        path = ("objects", index)
        places.append((path, thing.x, thing.y))
        if any(other.name == thing.name for other in config.objects[:index]):
            yield document.problem((*path, "name"), thing.name, "is there above already: allowed is each name once")
    for path, x, y in places:
        yield from _place_problems(config.terrain, path, x, y, document)


def _lacking(role: str, bundle: Bundle) -> str:
    """Why a machine has no use for a role, "" where it has."""
    if role == "drive" and bundle.driving is None:
        return bundle.machine.why_it_stays
    return "has no arm" if role == "arm" and bundle.arm is None else ""


def _afloat_problems(config: "ScenarioConfig", bundle: Bundle, document: YamlDocument) -> Iterator[Problem]:
    """What floats free is in an orbit, and only it is let go high up or with a speed."""
    if bundle.machine.floats and not bundle.body.free_fall:
        allowed = f"is no orbit: {config.machine} floats free and would fall: allowed is low_earth_orbit"
        yield document.problem(("body",), config.body, allowed)
    for key in AFLOAT if not bundle.machine.floats else ():
        value = getattr(config.start, key)
        if np.any(value):
            allowed = f"{config.machine} does not float free: allowed is 0, as the ground says how it stands"
            yield document.problem(("start", key), value, allowed)


def _sun_problems(config: "ScenarioConfig", bundle: Bundle, document: YamlDocument) -> Iterator[Problem]:
    """A date goes with a site on a body that has an ephemeris, a Sun by its place with no other latitude."""
    try:
        sun_path(config.sun, bundle.body, bundle.site)
    except InvalidValueError as error:
        key = "body" if error.name == "body" else error.name.removeprefix("sun.")
        yield document.problem(("body",) if key == "body" else ("sun", key), error.value, "allowed is " + error.allowed)


def _link_problems(config: "ScenarioConfig", bundle: Bundle, document: YamlDocument) -> Iterator[Problem]:
    """A link that goes by the sky has a site and a date to go by."""
    if config.link is None:
        return
    try:
        config.link.check(config.link.sky(bundle.body, bundle.site, config.sun))
    except InvalidValueError as error:
        path = [int(part) if part.isdigit() else part for part in error.name.split(".")]
        at: KeyPath = ("body",) if error.name == "body" else ("link", *path)
        yield document.problem(at, error.value, "allowed is " + error.allowed)


def _air_problems(config: "ScenarioConfig", bundle: Bundle, document: YamlDocument) -> Iterator[Problem]:
    """A sensor that goes by sound is where there is air."""
    if bundle.body.surface_pressure == 0.0:
        for name, params in bundle.sensors.named.items():
            if params.needs_air:
                allowed = f"has no air, which the sensor {name} of {config.machine} needs: allowed is a body with air"
                yield document.problem(("body",), config.body, allowed)


def _magnetic_problems(bundle: Bundle, document: YamlDocument) -> Iterator[Problem]:
    """A magnetometer on a body with a field is at a place of which that is known."""
    try:
        bundle.body.magnetic_field_over(bundle.site)
    except InvalidValueError as error:
        for name, params in bundle.sensors.named.items():
            if params.needs_magnetic_site:
                yield document.problem(
                    (error.name,), error.value, f"is asked for by the sensor {name}: allowed is {error.allowed}"
                )


def _soil_problems(bundle: Bundle, document: YamlDocument) -> Iterator[Problem]:
    """A sensor that tells soils apart knows those that there are."""
    for name, params in bundle.sensors.named.items():
        for soil in bundle.soils if params.soils else ():
            if soil not in params.soils:
                allowed = f"is a soil that the sensor {name} does not know: " + names_text(soil, params.soils)
                yield document.problem(("soil",), soil, allowed)


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


def faultable(bundle: Bundle, terrain: TerrainParams) -> FaultableMachine:
    """What of a machine on its ground may have a fault."""
    joints = bundle.urdf.joints
    travel = {name: (joints[name].lower, joints[name].upper) for name in bundle.urdf.moving_joints}
    efforts = {name: joints[name].effort for name in travel}
    return FaultableMachine(bundle.machine, travel, efforts, bundle.power, bundle.sensors.sensors, terrain.bounds)


def _fault_problems(config: "ScenarioConfig", bundle: Bundle, document: YamlDocument) -> Iterator[Problem]:
    """A fault is one of what the machine has, also with those above, comes at some time, and has a name of its own."""
    machine = faultable(bundle, config.terrain)
    for index, fault in enumerate(config.faults):
        path: KeyPath = ("faults", index)
        if fault.at is None and fault.when is None:
            yield document.problem((*path, "at"), "", "the key is missing: allowed is at, a time, or when, an event")
        if fault.when is not None and (fault.when.after_step or 0) > len(config.steps):
            allowed = f"is no step of this scenario: allowed is 1 to {len(config.steps)}"
            yield document.problem((*path, "when", "after_step"), fault.when.after_step, allowed)
        if any(other.called == fault.called for other in config.faults[:index]):
            allowed = "is the name of a fault above already: allowed is each name once, said by the key name"
            yield document.problem((*path, "name"), fault.called, allowed)
        found = list(fault.problems(machine))
        yield from (document.problem((*path, key), value, allowed) for key, value, allowed in found)
        machine = machine if found else fault.left_of(machine)
