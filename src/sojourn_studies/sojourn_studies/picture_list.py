"""The pictures of the manuals, each with what draws it: the work of scripts/pictures."""

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.figure import Figure
from PIL import Image

from sojourn_config.command_errors import UsageError
from sojourn_config.paths import repository_root
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_studies.picture_style import STYLE
from sojourn_studies.pictures_of_ground import terrain, wheel
from sojourn_studies.pictures_of_machines import arm, course, explorer, steering
from sojourn_studies.pictures_of_power import power
from sojourn_studies.pictures_of_views import view
from sojourn_studies.power_days import power_days
from sojourn_studies.power_days_plot import figure_of


def report(run: Path) -> None:
    """The picture of a run, reduced."""
    picture = Image.open(run / "report.png").convert("RGB")
    height = round(picture.height * 1400 / picture.width)
    reduced = picture.resize((1400, height), Image.Resampling.LANCZOS)
    target = repository_root() / "src" / "sojourn_bags" / "doc" / "demo_report.jpg"
    target.parent.mkdir(exist_ok=True)
    reduced.save(target, quality=85, subsampling=0, optimize=True)
    print(f"{target.relative_to(repository_root())}: {target.stat().st_size // 1024} kB")


def _view(run: Path, camera: str, time: str) -> None:
    """What a camera has seen."""
    try:
        seconds = float(time)
    except ValueError:
        raise UsageError(f"pictures: time {time!r}, allowed is a number of seconds") from None
    plt.rcParams.update(STYLE)
    target = repository_root() / "src" / "sojourn_sensors" / "doc" / f"{camera}.jpg"
    target.parent.mkdir(exist_ok=True)
    view(run, camera, seconds).savefig(target, pil_kwargs={"quality": 85})
    print(f"{target.relative_to(repository_root())}: {target.stat().st_size // 1024} kB")


def sols(_: LoadedScenario) -> Figure:
    """Three sols of a rover with a photovoltaic array."""
    return figure_of(power_days(load_scenario("mars_sol"), 3.0, 60.0))


FIGURES: dict[str, tuple[Callable[[LoadedScenario], Figure], str]] = {
    "wheel": (wheel, "sojourn_physics/doc/wheel_on_soil.png"),
    "terrain": (terrain, "sojourn_physics/doc/terrain.jpg"),
    "explorer": (explorer, "sojourn_config/doc/explorer.png"),
    "arm": (arm, "sojourn_arm/doc/reach.png"),
    "steering": (steering, "sojourn_drive/doc/steering.png"),
    "sols": (sols, "sojourn_studies/doc/sols.png"),
    "power": (power, "sojourn_power/doc/shedding.png"),
}


def run(given: argparse.Namespace) -> int:
    """Draw what is asked for."""
    wanted: Sequence[str] = given.names or list(FIGURES)
    if wanted[0] == "report" and len(wanted) == 2:
        report(Path(wanted[1]))
        return 0
    if wanted[0] == "course" and len(wanted) in (2, 3):
        plt.rcParams.update(STYLE)
        course(Path(wanted[1]), *wanted[2:])
        return 0
    if wanted[0] == "view" and len(wanted) == 4:
        _view(Path(wanted[1]), wanted[2], wanted[3])
        return 0
    unknown = [name for name in wanted if name not in FIGURES]
    if unknown:
        allowed = f"allowed is one of {', '.join(FIGURES)}, report RUN, course RUN [NAME], or view RUN CAMERA TIME"
        raise UsageError(f"pictures: {unknown[0]!r} is unknown, {allowed}")
    scenario = load_scenario("lunar_sample")
    plt.rcParams.update(STYLE)
    for name in wanted:
        draw, path = FIGURES[name]
        target = repository_root() / "src" / path
        target.parent.mkdir(exist_ok=True)
        figure = draw(scenario)
        figure.savefig(target)
        plt.close(figure)
        print(f"src/{path}: {target.stat().st_size // 1024} kB")
    return 0
