"""scripts/tune: measures in the plant what a machine's drive goes by, and writes it down with where it is from.

    scripts/tune MACHINE

The slip that its odometry expects, the track ratio of one that scrubs in a turn, what driving costs: all of it goes
into `measured.yaml` in the machine's folder, on which `drive` in flight.yaml builds (`extends: ./measured.yaml`). The
first time the file is begun with guesses, so that there is a machine to measure.
"""

import argparse
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from sojourn_config import command_line
from sojourn_config.command_errors import UsageError
from sojourn_config.extends import EXTENDS
from sojourn_config.paths import config_folder, display, is_path
from sojourn_config.yaml_file import read_yaml

FILE = "measured.yaml"
SCENARIO = "flat_drive"
GUESSES: Mapping[str, Any] = {
    "mobility": {"track_ratio": 1.0},
    "odometry": {"mean_slip": 0.1, "slip_per_grade": 1.0, "side_slip_per_grade": 0.7},
    "energy": {
        "grades_deg": [-8.0, -4.0, 0.0, 4.0, 8.0],
        "energy_per_metre": [100.0] * 5,
        "time_per_metre": [10.0] * 5,
        "stop_energy": 10.0,
        "stop_time": 4.0,
        "turn_energy": 10.0,
        "turn_time": 4.0,
        "energy_per_radian": 100.0,
        "time_per_radian": 5.0,
        "house_power": 50.0,
    },
}
"""Of no machine: what stands in the file until it is measured."""


def parser() -> argparse.ArgumentParser:
    """Options of scripts/tune."""
    result = command_line.Parser(
        prog="tune",
        description="Measure in the plant what a machine's drive goes by (slip, turning, energy), and write it into "
        f"its {FILE}. Some minutes.",
    )
    result.add_argument("machine", help="a machine that drives: its name in config/machines, or the path of its folder")
    result.add_argument("--body", default="moon", help="name in config/bodies (default: %(default)s)")
    result.add_argument("--soil", default="lunar_nominal", help="name or file of the soil (default: %(default)s)")
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and write."""
    given = parser().parse_args(arguments)
    folder = Path(given.machine) if is_path(given.machine) else config_folder() / "machines" / given.machine
    if not (folder / "flight.yaml").is_file():
        raise UsageError(f"{given.machine}: there is no {folder / 'flight.yaml'}; allowed is a machine that drives")
    if not builds_on_it(folder / "flight.yaml"):
        raise UsageError(
            f"{display(folder / 'flight.yaml')}: drive does not build on {FILE}: "
            f"allowed is a table drive that begins with  extends: ./{FILE}"
        )
    file = folder / FILE
    if not file.exists():
        write(file, GUESSES, "Guesses, to be measured by scripts/tune.")
    overrides = [f"machine={given.machine}", f"body={given.body}", f"soil={given.soil}"]
    found = measured(overrides, command_line.say)
    write(file, found, f"Measured in the plant on {given.soil}, {given.body}, by scripts/tune; written anew each time.")
    print(f"{display(file)} written")
    return 0


def builds_on_it(flight: Path) -> bool:
    """Whether the table `drive` of a flight.yaml extends the file."""
    table = read_yaml(flight).data.get("drive")
    return isinstance(table, dict) and str(table.get(EXTENDS)).removeprefix("./") == FILE


def measured(overrides: Sequence[str], say: Callable[[str], None]) -> dict[str, Any]:
    """All of the file, by its keys; each measurement goes by those before it."""
    from sojourn_flight.mobility.wheel_table import scrubs  # not above: --help needs none of it
    from sojourn_studies.measure_energy import cost_of_driving
    from sojourn_studies.measure_slip import expected_slip, on_plane
    from sojourn_studies.measure_turning import measured_ratio

    slip = expected_slip(SCENARIO, overrides, say)
    known = [*overrides, *(f"drive.odometry.{name}={value}" for name, value in slip.items())]
    scenario, ratio = on_plane(SCENARIO, known, 0.0, 0.0), 1.0
    if scrubs(scenario.steering.wheels):
        ratio = round(measured_ratio(scenario, say), 2)
        known.append(f"drive.mobility.track_ratio={ratio}")
    say("driving up and down, turning on the spot: what it costs")
    return {"mobility": {"track_ratio": ratio}, "odometry": slip, "energy": cost_of_driving(SCENARIO, known)}


def write(file: Path, found: Mapping[str, Any], where: str) -> None:
    """The file, for the table `drive` of flight.yaml."""
    text = f"# {where}\n# Keys and units are those of `drive` in config/machines/explorer/flight.yaml.\n"
    for key, value in found.items():
        if isinstance(value, Mapping):
            text += f"{key}:\n" + "".join(f"  {name}: {one}\n" for name, one in value.items())
        else:
            text += f"{key}: {value}\n"
    try:
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{display(file)}: cannot be written: {error.strerror}") from error


if __name__ == "__main__":
    command_line.run_script(main)
