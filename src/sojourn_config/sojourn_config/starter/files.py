"""The files of a machine's folder, as texts by their names."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from sojourn_config.load import load_params
from sojourn_config.starter.drives import PULL
from sojourn_config.starter.layout import StarterMachine
from sojourn_config.starter.solids import urdf_text
from sojourn_machine.power.power_params import PowerParams

SOILS = {"moon": "lunar_nominal", "mars": "mars"}
"""On which a body's scenarios are driven; another body's on OTHER_SOIL."""
OTHER_SOIL = "dry_sand"
DEFAULT_POWER = "default_power"
STRING_POWER = 380.0
"""Of a string of eight cells of that set at its largest current, nearly empty [W]."""
HOUSE_POWER = 60.0
"""Of the other loads of that set [W]."""
SPARE_PART = 0.9
"""Of the curvature at the stops that the drive goes to [-]."""
PLANNED_PART = 0.7
"""Of that one, which paths ask for [-]."""
SLOPE_DEG = 8.0
TIME_LIMIT_S = 900.0
FAR = "accept: {drive_m: %.2g} # slip is a guess until scripts/tune has measured it\n"


@dataclass(frozen=True)
class Purpose:
    """What the machine is for: its name, the body that it is sized for, how it steers in words, with cameras or not."""

    name: str
    body: str
    steering: str
    with_cameras: bool


def files_of(machine: StarterMachine, purpose: Purpose) -> dict[str, str]:
    """The texts of all files by name."""
    support = "track" if machine.kind_of_support == "tracks" else "wheel"
    found = {
        f"{purpose.name}.urdf": _urdf(machine, purpose),
        "machine.yaml": _machine(machine, purpose),
        f"{support}.yaml": "\n".join((f"# One {support}; machine.yaml says where each is.", *machine.support, "")),
        "flat.yaml": _flat(machine, purpose),
        "slope.yaml": _slope(machine, purpose),
    }
    if purpose.with_cameras:
        found["sensors.yaml"] = (
            "# Beside IMU, bus and encoders, which every rover has.\n"
            "hazcam: {extends: mer_hazcam, link: hazcam_link}\n"
            "sun: {extends: digital_sun_sensor, link: sun_link}\n"
            "powered_by: {imu: imu, hazcam: cameras}\n"
        )
    power = _power(machine)
    if power:
        found["power.yaml"] = power
    flight = [*_curves(machine), *_slip(machine)]
    if flight:
        found["flight.yaml"] = "\n".join(("drive:", *flight, ""))
    found["README.md"] = _readme(found, machine, purpose)
    return found


def _urdf(machine: StarterMachine, purpose: Purpose) -> str:
    size = machine.size
    words = (
        f"{purpose.name}: {purpose.steering}, {size.mass:g} kg. Frames (REP 103): base_link, x forward, y left, z up; "
        "m, kg, kg m2, rad, N m. Inertias: each link uniform over its own solid. All masses and lengths but those that "
        "were asked for are estimates."
    )
    return urdf_text(purpose.name, words, machine.links, machine.joints)


def _machine(machine: StarterMachine, purpose: Purpose) -> str:
    size = machine.size
    lines = [
        f"# {purpose.name}: {purpose.steering}. Kinematics, masses and joint limits are in {purpose.name}.urdf.",
        f"# Motors, gears, servos: sized for {purpose.body}, {size.gravity:.2f} m/s^2; each rim pulls {PULL:g} times",
        "# its load: estimates. What is not said here follows from the URDF: start.py flat.yaml --resolved says how.",
        "kind: rover",
        f"description: {purpose.steering[0].upper()}{purpose.steering[1:]}, {size.mass:g} kg",
        f"urdf: ./{purpose.name}.urdf",
        f"mass: {size.mass:g} # must be the sum of the URDF",
        "",
        f"{machine.kind_of_support}:",
        *(f"  - {line}" for line in machine.supports),
        "",
        "drives:",
    ]
    for drive in machine.drives:
        lines += [f"  - joints: [{', '.join(drive.joints)}]", f"    load: {drive.load}"]
        lines += [f"    {line}" for line in drive.lines]
    if machine.suspension:
        lines += ["", "suspensions:", f"  - {machine.suspension[0]}"]
        lines += [f"    {line}" for line in machine.suspension[1:]]
    lines += ["", f"passive_joint: {machine.passive}", "", "pads: # where the body would touch the ground"]
    for number, (link, place, radius) in enumerate(machine.belly, 1):
        at = ", ".join(f"{value:.3f}" for value in place)
        lines.append(f"  - {{name: belly_{number}, link: {link}, position: [{at}], radius: {radius:.3g}}}")
    return "\n".join([*lines, ""])


def _power(machine: StarterMachine) -> str:
    """`power.yaml`; "" where the default carries the machine."""
    default = load_params("parts", DEFAULT_POWER, PowerParams)
    wanted = {drive.load: math.ceil(drive.power / 10.0) * 10.0 for drive in machine.drives}
    known = {load.name: load.power_w for load in default.bus.loads}
    if all(power <= known[name] for name, power in wanted.items()):
        return ""
    strings = max(2, math.ceil((sum(wanted.values()) + HOUSE_POWER) / STRING_POWER))
    lines = [
        f"# The bus of config/parts/{DEFAULT_POWER}.yaml, with a battery and loads for larger motors.",
        f"extends: {DEFAULT_POWER}",
        f"battery: {{cells_parallel: {strings}}}",
        "bus:",
        "  loads:",
    ]
    for load in default.bus.loads:
        values = load.model_dump(mode="json", exclude_unset=True)
        values["power_w"] = max(load.power_w, wanted.get(load.name, 0.0))
        lines.append("    - {" + ", ".join(f"{key}: {_yaml(value)}" for key, value in values.items()) + "}")
    return "\n".join([*lines, ""])


def _curves(machine: StarterMachine) -> Iterator[str]:
    """Curves of a machine that does not turn on the spot: a right angle is rounded with the planned radius R, which
    passes its corner within R (sqrt 2 - 1).
    """
    if machine.turns_on_the_spot:
        return
    yield f"  follower: # it turns in {machine.least_radius:.2f} m at its stops; planned are wider curves"
    yield f"    max_curvature: {SPARE_PART / machine.least_radius:.3g}"
    yield f"    planned_curvature: {PLANNED_PART}"
    yield f"    corner_cut: {1.25 * _planned_radius(machine) * (math.sqrt(2.0) - 1.0):.3g}"


def _planned_radius(machine: StarterMachine) -> float:
    """Of the sharpest curve of a path [m]."""
    return machine.least_radius / SPARE_PART / PLANNED_PART


def _slip(machine: StarterMachine) -> Iterator[str]:
    if machine.slip is not None:
        other, mean, grade = machine.slip
        yield f"  odometry: # guesses, of the size measured on the {other} rover, until scripts/tune has measured them"
        yield f"    mean_slip: {mean:g}"
        yield f"    slip_per_grade: {grade:g}"
        yield f"    side_slip_per_grade: {grade:g}"


def _yaml(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _head(machine: StarterMachine, purpose: Purpose, words: str) -> str:
    soil = machine.soil or SOILS.get(purpose.body, OTHER_SOIL)
    return f"description: {words}\nseed: 1\nmachine: ./machine.yaml\nbody: {purpose.body}\nsoil: {soil}\n"


def _flat(machine: StarterMachine, purpose: Purpose) -> str:
    """A square, in one go where it does not turn on the spot."""
    least = 2.5 * (_length(machine) if machine.turns_on_the_spot else _planned_radius(machine))
    side = math.ceil(2.0 * least) / 2.0
    corners = [(side, 0.0), (side, side), (0.0, side), (0.0, 0.0)]
    if not machine.turns_on_the_spot:
        corners.append((0.5 * side, 0.0))
    ground = side + 8.0 * _length(machine) + 4.0
    return (
        _head(machine, purpose, f"Drive a square of {side:g} m on flat ground")
        + f"terrain: {{kind: flat, size_x: {2.0 * ground:.0f}.0, size_y: {2.0 * ground:.0f}.0, resolution: 0.1}}\n"
        + "battery_soc: 0.8\n"
        + f"duration_limit_s: {TIME_LIMIT_S}\n"
        + FAR % max(0.3, 0.1 * side)
        + "steps:\n"
        + _steps(machine, corners)
    )


def _slope(machine: StarterMachine, purpose: Purpose) -> str:
    """Up a ramp and on to the flat above it."""
    length = _length(machine)
    begin, run = math.ceil(2.0 * length), math.ceil(4.0 * length)
    height = run * math.tan(math.radians(SLOPE_DEG))
    plateau = math.ceil(6.0 * length)
    goal = begin + run + 1.5 * length
    ground = 2.0 * (begin + run + plateau + 2.0)
    ramp = (
        f"{{kind: ramp, x: {begin}.0, y: 0.0, length: {run}.0, width: {4 * plateau}.0, "
        f"height: {height:.4f}, plateau: {plateau}.0}}"
    )
    return (
        _head(machine, purpose, f"Climb a slope of {SLOPE_DEG:g} degrees, {run} m long")
        + f"terrain:\n  kind: flat\n  size_x: {ground:.0f}.0\n  size_y: {8 * plateau}.0\n  resolution: 0.1\n"
        + f"  features:\n    - {ramp}\n"
        + "battery_soc: 0.8\n"
        + f"duration_limit_s: {TIME_LIMIT_S}\n"
        + FAR % max(0.3, 0.15 * goal)
        + f"steps:\n  - drive_to: {{x: {goal:.2f}, y: 0.0}}\n"
    )


def _length(machine: StarterMachine) -> float:
    """By which the ways are measured [m]."""
    return max(machine.size.wheelbase, machine.size.track)


def _steps(machine: StarterMachine, corners: list[tuple[float, float]]) -> str:
    points = [f"{{x: {x:g}, y: {y:g}}}" for x, y in corners]
    if machine.turns_on_the_spot:
        return "".join(f"  - drive_to: {point}\n" for point in points)
    return "  - drive_route:\n      points:\n" + "".join(f"        - {point}\n" for point in points)


WHAT = {
    "machine.yaml": "wheels or tracks, motors, gears, servos",
    "wheel.yaml": "radius, width and grousers of a wheel",
    "track.yaml": "lengths of a track",
    "sensors.yaml": "what it senses with beside IMU, bus and encoders",
    "power.yaml": "battery and loads, as the default is too small",
    "flight.yaml": "limits of its curves, or guesses of its slip",
    "flat.yaml": "scenario: a square on flat ground",
    "slope.yaml": "scenario: a slope",
}


def _readme(files: Mapping[str, str], machine: StarterMachine, purpose: Purpose) -> str:
    def rows() -> Iterator[str]:
        for name in files:
            yield f"| `{name}` | {WHAT.get(name, 'kinematics, masses, inertias, limits of the joints')} |"

    firm = "\nIts rollers are for firm ground: its scenarios are on rock.\n" if machine.soil else ""
    return f"""# {purpose.name}

A starter machine of Sojourn: {purpose.steering}, {machine.size.mass:g} kg, sized for
{purpose.body}. Every number that was not asked for is an estimate, to be replaced.
{firm}
| file | what it holds |
|---|---|
{chr(10).join(rows())}

From this folder, with the scripts of Sojourn on the path:

```sh
demo --scenario ./flat.yaml        # drives, and says how it went; also ./slope.yaml
start.py ./flat.yaml --resolved    # every value, and from what it follows
tune .                             # measures slip and energy, and writes measured.yaml
rover_datasheet .
demo --machine . --scenario machine_course
```

What a file does not say follows from others: the manual of `sojourn_config` says from what, and what else may stand in
`flight.yaml`, `sensors.yaml`, `power.yaml`, `thermal.yaml`.
"""
