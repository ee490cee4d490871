"""scripts/tune: measures in the plant what a machine's drive goes by, and writes it down with where it is from.

    scripts/tune MACHINE

The slip that its odometry expects, the torque that goes with slip, the track ratio of one that scrubs in a turn, what
driving costs: all of it goes into `measured.yaml` in the machine's folder, which stands for what the table `drive` of
its flight.yaml leaves out; before it is there, guesses do.
"""

import argparse
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sojourn_config import command_line
from sojourn_config.command_errors import UsageError
from sojourn_config.measured_file import MEASURED, UNMEASURED_SLIP
from sojourn_config.paths import config_folder, display, is_path
from sojourn_config.yaml_file import read_yaml

if TYPE_CHECKING:
    from sojourn_config.scenario import LoadedScenario

SCENARIO = "flat_drive"
LEAST_SLIP_PER_GRADE = 0.1
"""On ground that gives less the torque tells nothing: what slips there by 1 % pulls all it can [-]."""
MEASURED_KEYS = {
    "mobility": ("track_ratio", "slip"),
    "odometry": (*UNMEASURED_SLIP, "turn_drift_per_grade"),
    "energy": (),
}
"""Keys of the table `drive` that are measured, by their tables; of energy all."""


def parser() -> argparse.ArgumentParser:
    """Options of scripts/tune."""
    result = command_line.Parser(
        prog="tune",
        description="Measure in the plant what a machine's drive goes by (slip, traction, turning, energy), and write "
        f"it into its {MEASURED}. Some minutes.",
    )
    result.add_argument("machine", help="a machine that drives: its name in config/machines, or the path of its folder")
    result.add_argument("--body", default="moon", help="name in config/bodies (default: %(default)s)")
    result.add_argument("--soil", default="lunar_nominal", help="name or file of the soil (default: %(default)s)")
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and write."""
    given = parser().parse_args(arguments)
    folder = Path(given.machine) if is_path(given.machine) else config_folder() / "machines" / given.machine
    if not (folder / "machine.yaml").is_file():
        raise UsageError(f"{given.machine}: there is no {folder / 'machine.yaml'}; allowed is a machine that drives")
    flight, file = folder / "flight.yaml", folder / MEASURED
    if said := said_already(flight):
        raise UsageError(
            f"{display(flight)}: drive says {', '.join(said)} itself, which comes before {MEASURED}: "
            "allowed is a machine that leaves it to be measured"
        )
    overrides = [f"machine={given.machine}", f"body={given.body}", f"soil={given.soil}"]
    found = measured(overrides, command_line.say)
    write(file, found, f"Measured in the plant on {given.soil}, {given.body}, by scripts/tune; written anew each time.")
    print(f"{display(file)} written")
    return 0


def said_already(flight: Path) -> list[str]:
    """Keys that the table `drive` of a flight.yaml has of those that are measured."""
    table = read_yaml(flight).data.get("drive") if flight.is_file() else None
    found = []
    for name, keys in MEASURED_KEYS.items():
        own = table.get(name) if isinstance(table, dict) else None
        if isinstance(own, dict):
            found += [f"{name}.{key}" for key in (keys or own) if key in own]
    return found


def measured(overrides: Sequence[str], say: Callable[[str], None]) -> dict[str, Any]:
    """All of the file, by its keys; each measurement goes by those before it."""
    from sojourn_flight.mobility.wheel_table import scrubs  # not above: --help needs none of it
    from sojourn_studies.measure_energy import cost_of_driving
    from sojourn_studies.measure_slip import expected_slip, on_plane
    from sojourn_studies.measure_traction import measured_curves
    from sojourn_studies.measure_turn_drift import expected_drift
    from sojourn_studies.measure_turning import measured_ratio

    slip = expected_slip(SCENARIO, overrides, say)
    known = [*overrides, *(f"drive.odometry.{name}={value}" for name, value in slip.items())]
    scenario, ratio = on_plane(SCENARIO, known, 0.0, 0.0), 1.0
    if scrubs(scenario.steering.wheels):
        ratio = round(measured_ratio(scenario, say), 2)
        known.append(f"drive.mobility.track_ratio={ratio}")
    mobility: dict[str, Any] = {"kind": "rolling", "track_ratio": ratio}  # a machine of another kind takes none of it
    if tells_slip(scenario, slip["slip_per_grade"]):
        say("torque against slip")
        mobility["slip"] = measured_curves(SCENARIO, known, say)
    odometry = {**slip, **expected_drift(SCENARIO, known, say)}
    say("driving up and down, turning on the spot: what it costs")
    return {"mobility": mobility, "odometry": odometry, "energy": cost_of_driving(SCENARIO, known)}


def tells_slip(scenario: "LoadedScenario", slip_per_grade: float) -> bool:
    """Whether the torques of a machine tell its slip: on wheels that slip for what they pull, and of which none slides
    sideways in a curve, which takes torque as well.
    """
    from sojourn_flight.mobility.wheel_table import scrubs

    rolls_straight = not scenario.machine.tracks and not scrubs(scenario.steering.wheels)
    return rolls_straight and slip_per_grade > LEAST_SLIP_PER_GRADE


def _lines(table: Mapping[str, Any], indent: str) -> str:
    """A table as YAML, those in it indented by more."""
    return "".join(
        f"{indent}{name}:\n{_lines(one, indent + '  ')}" if isinstance(one, Mapping) else f"{indent}{name}: {one}\n"
        for name, one in table.items()
    )


def write(file: Path, found: Mapping[str, Any], where: str) -> None:
    """The file, for the table `drive` of flight.yaml."""
    text = f"# {where}\n# Keys and units are those of `drive` in config/machines/explorer/flight.yaml.\n"
    for key, value in found.items():
        if isinstance(value, Mapping):
            text += f"{key}:\n" + _lines(value, "  ")
        else:
            text += f"{key}: {value}\n"
    try:
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{display(file)}: cannot be written: {error.strerror}") from error


if __name__ == "__main__":
    command_line.run_script(main)
