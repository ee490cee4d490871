"""Draws the pictures of the manuals again, from the models and parameter sets themselves, into src/*/doc/.

    scripts/pictures             all of them
    scripts/pictures arm power   some of them; names are those of FIGURES below
    scripts/pictures report RUN  the report of a finished run (a folder in runs/), reduced, for README.md
    scripts/pictures course RUN  the machine of a run of scripts/demo --rover NAME, and its track, for sojourn_machine

For maintainers, after a change of a model or of a parameter set. Takes about two minutes, most of it for the arm.
"""

import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.figure import Figure
from PIL import Image

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


def main() -> None:
    """Draw what is asked for."""
    wanted = sys.argv[1:] or list(FIGURES)
    if wanted[0] == "report" and len(wanted) == 2:
        report(Path(wanted[1]))
        return
    if wanted[0] == "course" and len(wanted) == 2:
        plt.rcParams.update(STYLE)
        course(Path(wanted[1]))
        return
    unknown = [name for name in wanted if name not in FIGURES]
    if unknown:
        sys.exit(
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


if __name__ == "__main__":
    main()
