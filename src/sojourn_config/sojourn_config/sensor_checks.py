"""Checks of a machine's sensors against the rest of it: links, parts that they are on, loads that feed them."""

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite

from sojourn_config.errors import Problem
from sojourn_config.machine_reader import MachineSets
from sojourn_config.urdf import UrdfSummary
from sojourn_config.yaml_file import KeyPath, YamlDocument
from sojourn_machine.drives import JointDriveParams
from sojourn_machine.names import names_text
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.sensor_choice import SENSORS
from sojourn_physics.sensors.params import JOINTS, SensorSuiteParams

WITHOUT = {
    "node": "is no node of the machine's heat, which thermal.yaml describes",
    "store": "is no store",
    "joint": "is no joint of the URDF that moves",
    "travel": "is no joint of the URDF whose travel has ends",
    "string": "is no load of a bus with a store, whose voltage is its",
    "driven": "is no joint with a motor of ours, whose current is known",
    "motor": "is no joint whose motor's heat is known: the key thermal of its drive",
}
"""What is wrong with the name of a part that is not there, by the kind of part."""

PAIR_ROWS = {f"/{{name}}/{side}/{what}" for side in ("left", "right") for what in ("image", "camera_info")}
"""On which a stereo pair speaks."""
MOST_BYTES_A_SECOND = 40e6
"""Of images: what a bag takes in real time beside all else, with half of a processor."""


def sensor_problems(sets: MachineSets) -> Iterator[Problem]:
    """All that does not fit together."""
    sensors, document = sets.joined.sensors, sets.documents["sensors"]
    yield from _link_problems(sensors, sets.joined.urdf, document)
    yield from _part_problems(sensors, _parts(sets), document)
    yield from _supply_problems(sensors, sets.joined.power, document)
    yield from _rate_problems(sensors, document)
    yield from _pair_problems(sets)
    yield from _demand_problems(sets)
    yield from _fault_problems(sensors, document)


def _fault_problems(sensors: SensorSuiteParams, document: YamlDocument) -> Iterator[Problem]:
    """A fault is of a quantity that its sensor measures."""
    for name, params in sensors.sensors.items():
        at: KeyPath = ("joint_faults",) if name == JOINTS else (name, "faults")
        for called, fault in params.faults.items():
            for key, value, allowed in params.fault_problems(fault):
                yield document.problem((*at, called, key), value, allowed)


def _rate_problems(sensors: SensorSuiteParams, document: YamlDocument) -> Iterator[Problem]:
    """A bag takes what all sensors say."""
    rates = {name: params.bytes_a_second for name, params in sensors.named.items() if not params.on_demand}
    total = sum(rates.values())
    if total > MOST_BYTES_A_SECOND:
        largest = max(rates, key=lambda name: rates[name])
        allowed = f"{1e-6 * MOST_BYTES_A_SECOND:g} MB of images a second from all sensors, for that is what a bag takes"
        yield document.problem((largest,), f"{1e-6 * total:.0f} MB a second in all", f"too much: allowed is {allowed}")


def _pair_problems(sets: MachineSets) -> Iterator[Problem]:
    """Visual odometry goes by a pair that there is, and whose images somebody can rectify."""
    visual = None if sets.drive is None else sets.drive.visual_odometry
    if visual is None:
        return
    named = sets.joined.sensors.named
    pairs = [name for name, params in named.items() if {row.name for row in params.own_rows} >= PAIR_ROWS]
    if visual.camera not in pairs:
        allowed = "is no stereo pair of sensors.yaml: " + (names_text(visual.camera, pairs) or "it has none")
        yield sets.documents["flight"].problem(("drive", "visual_odometry", "camera"), visual.camera, allowed)


def _demand_problems(sets: MachineSets) -> Iterator[Problem]:
    """What a role acts on is there whoever else listens, and in the bag: without it nobody could replay the role."""
    visual = None if sets.drive is None else sets.drive.visual_odometry
    for name, params in sets.joined.sensors.named.items():
        hearers = [role for row in params.own_rows for role in row.subscribers]
        if visual is not None and visual.camera == name:
            hearers.append("drive")
        if params.on_demand and hearers:
            told = f"is not possible: the role {hearers[0]} acts on what {name} says"
            yield sets.documents["sensors"].problem((name, "on_demand"), "true", told)


def _link_problems(sensors: SensorSuiteParams, urdf: UrdfSummary, document: YamlDocument) -> Iterator[Problem]:
    """A sensor sits on a link that there is."""
    for name, params in sensors.named.items():
        for link in params.links:
            if link not in urdf.links:
                allowed = f"is no link of {urdf.file}: " + names_text(link, urdf.links)
                yield document.problem((name, "link"), link, allowed)


def _parts(sets: MachineSets) -> Mapping[str, Sequence[str]]:
    """Names of all parts that a sensor may be on, by their kind."""
    joined = sets.joined
    drives = [drive for drive in joined.config.drives if isinstance(drive, JointDriveParams)]
    return {
        "node": () if sets.thermal is None else tuple(sets.thermal.nodes),
        "store": tuple(joined.power.all_stores),
        "joint": tuple(joined.urdf.moving_joints),
        "travel": tuple(name for name in joined.urdf.moving_joints if isfinite(joined.urdf.joints[name].lower)),
        "string": tuple(
            load.name
            for bus, params in joined.power.all_buses.items()
            for load in params.loads
            if joined.power.stores_on(bus)
        ),
        "driven": tuple(joint for drive in drives for joint in drive.joints),
        "motor": tuple(joint for drive in drives if drive.thermal for joint in drive.joints),
    }


def _part_problems(
    sensors: SensorSuiteParams, parts: Mapping[str, Sequence[str]], document: YamlDocument
) -> Iterator[Problem]:
    """A sensor is on a part that there is, and once on each."""
    for name, params in sensors.named.items():
        for key, kind, parts_of_it in params.parts:
            for place, part in enumerate(parts_of_it):
                path: KeyPath = (name, key) if len(parts_of_it) == 1 else (name, key, place)
                if part not in parts[kind]:
                    yield document.problem(path, part, f"{WITHOUT[kind]}: " + names_text(part, parts[kind]))
                elif part in parts_of_it[:place]:
                    yield document.problem(path, part, "is there above already: allowed is each name once")


def _supply_problems(sensors: SensorSuiteParams, power: PowerParams, document: YamlDocument) -> Iterator[Problem]:
    """A sensor, or one that the machine might have, is fed by a load that there is."""
    loads = [load.name for load in power.loads]
    known = tuple(dict.fromkeys((*sensors.named, *SENSORS.names())))
    for sensor, load in sensors.powered_by.items():
        if sensor not in known:
            yield document.problem(("powered_by", sensor), load, "is no sensor: " + names_text(sensor, known))
        if load not in loads:
            yield document.problem(("powered_by", sensor), load, "is no load of the bus: " + names_text(load, loads))
