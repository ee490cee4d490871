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


def report(run: Path) -> None:
    """The picture of a run, reduced."""
    picture = Image.open(run / "report.png").convert("RGB")
    height = round(picture.height * 1400 / picture.width)
    reduced = picture.resize((1400, height), Image.Resampling.LANCZOS)
    target = repository_root() / "src" / "sojourn_bags" / "doc" / "demo_report.jpg"
    target.parent.mkdir(exist_ok=True)
    reduced.save(target, quality=85, subsampling=0, optimize=True)
    print(f"{target.relative_to(repository_root())}: {target.stat().st_size // 1024} kB")


FIGURES: dict[str, tuple[Callable[[LoadedScenario], Figure], str]] = {
    "wheel": (wheel, "sojourn_physics/doc/wheel_on_soil.png"),
    "terrain": (terrain, "sojourn_physics/doc/terrain.jpg"),
    "explorer": (explorer, "sojourn_config/doc/explorer.png"),
    "arm": (arm, "sojourn_arm/doc/reach.png"),
    "steering": (steering, "sojourn_drive/doc/steering.png"),
    "power": (power, "sojourn_power/doc/shedding.png"),
}


def run(given: argparse.Namespace) -> int:
    """Draw what is asked for."""
    wanted: Sequence[str] = given.names or list(FIGURES)
    if wanted[0] == "report" and len(wanted) == 2:
        report(Path(wanted[1]))
        return 0
    if wanted[0] == "course" and len(wanted) == 2:
        plt.rcParams.update(STYLE)
        course(Path(wanted[1]))
        return 0
    unknown = [name for name in wanted if name not in FIGURES]
    if unknown:
        raise UsageError(
            f"pictures: {unknown[0]!r} is unknown, allowed is one of {', '.join(FIGURES)}, report RUN, or course RUN"
        )
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
