"""Writes a folder with a machine to begin with: scripts/new_machine."""

import argparse
import re
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sojourn_config import command_line
from sojourn_config.command_errors import CommandError, UsageError
from sojourn_config.paths import available

if TYPE_CHECKING:
    from sojourn_config.starter.layout import StarterMachine
    from sojourn_config.starter.size import StarterSize

DEFAULT_BODY = "moon"
_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


@dataclass(frozen=True)
class _Kind:
    """A way to steer: in words, how many wheels it may have, and whether those are asked for at all."""

    words: str
    wheels: tuple[int, ...]


KINDS = {
    "skid": _Kind("{wheels} fixed wheels, skid steering", (4, 6, 8, 10)),
    "ackermann": _Kind("{wheels} wheels, all but the last two steered by Ackermann's law", (4, 6, 8)),
    "all": _Kind("{wheels} wheels, all steered", (4, 6, 8)),
    "articulated": _Kind("{wheels} wheels on two bodies, articulated steering", (4,)),
    "omni": _Kind("{wheels} Mecanum wheels, which drive in every direction", (4,)),
    "tracks": _Kind("two tracks, skid steering", ()),
}
"""Of each --steer; `_layouts` has who makes it."""


def parser() -> argparse.ArgumentParser:
    """Options of scripts/new_machine."""
    result = command_line.Parser(
        prog="new_machine", description="Write a folder with a machine to begin with, and scenarios that it drives."
    )
    result.add_argument("name", help="of the machine and of its folder: lower case, digits and _")
    result.add_argument("--steer", choices=tuple(KINDS), default="skid", help="how it steers (default: %(default)s)")
    result.add_argument("--wheels", type=command_line.count, metavar="N", help="how many (default: 4)")
    result.add_argument("--folder", type=Path, default=Path(), metavar="DIR",
                        help="in which its folder is made (default: the working folder)")  # fmt: skip
    result.add_argument("--body", default=DEFAULT_BODY, metavar="NAME",
                        help="in config/bodies: whose gravity it is sized for (default: %(default)s)")  # fmt: skip
    result.add_argument("--mass", type=command_line.positive, default=60.0, metavar="KG", help="(default: %(default)g)")
    for name, words in (
        ("wheelbase", "from the first to the last axle; of tracks, their flat run"),
        ("track", "between the middles of the wheels of an axle"),
        ("wheel-radius", "of a wheel without grousers, or of the sprocket"),
        ("wheel-width", "of a wheel or a track"),
    ):
        result.add_argument(
            f"--{name}", type=command_line.positive, metavar="M", help=f"{words} (default: by the mass)"
        )
    result.add_argument("--cameras", action="store_true", help="with a hazard camera and a sun sensor")
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the folder; nothing is left of one that would not be valid."""
    given = parser().parse_args(arguments)
    kind = KINDS[given.steer]
    if not _NAME.fullmatch(given.name):
        raise UsageError(f"NAME {given.name!r}: allowed are 1 to 40 lower-case letters, digits and _, a letter first")
    if given.name in available("machines"):
        raise UsageError(f"NAME {given.name}: config/machines has one of this name, allowed is another")
    if not kind.wheels and given.wheels is not None:
        raise UsageError(f"--wheels {given.wheels}: --steer {given.steer} has none, leave it out")
    wheels = given.wheels or 4
    if kind.wheels and wheels not in kind.wheels:
        allowed = ", ".join(map(str, kind.wheels))
        raise UsageError(f"--wheels {wheels}: allowed with --steer {given.steer} is {allowed}")
    folder = given.folder / given.name
    if folder.exists():
        raise UsageError(f"{folder}: is there already, and nothing is overwritten: allowed is another NAME or --folder")
    texts = _texts(given, wheels)
    try:
        folder.mkdir(parents=True)
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")
    except OSError as error:
        raise CommandError(f"{error.filename}: {error.strerror}") from error
    _check(folder)
    scripts = Path(__file__).resolve().parents[3] / "scripts"
    demo = scripts / "demo" if (scripts / "demo").is_file() else "demo"
    print(f"{folder}: {', '.join(sorted(texts))}")
    print(f"drive it: {demo} --scenario {folder / 'flat.yaml'}")
    return 0


def _texts(given: argparse.Namespace, wheels: int) -> dict[str, str]:
    # here and not above: --help needs none of it
    from sojourn_config.load import load_params
    from sojourn_config.starter.files import Purpose, files_of
    from sojourn_config.starter.size import SizeWanted, sized
    from sojourn_physics.environment.body import BodyParams

    gravity = load_params("bodies", given.body, BodyParams).surface_gravity
    wanted = SizeWanted(given.mass, given.wheel_radius, given.wheel_width, given.wheelbase, given.track)
    on_tracks = not KINDS[given.steer].wheels
    size = sized(wanted, 1 if on_tracks else wheels // 2, gravity, on_tracks)
    words = KINDS[given.steer].words.format(wheels=wheels)
    return files_of(_layouts()[given.steer](size, given.cameras), Purpose(given.name, given.body, words, given.cameras))


def _layouts() -> dict[str, Callable[["StarterSize", bool], "StarterMachine"]]:
    from sojourn_config.starter import articulated, rigid, tracks

    return {
        "skid": rigid.skid,
        "ackermann": rigid.ackermann,
        "all": rigid.all_wheel,
        "articulated": articulated.articulated,
        "omni": rigid.omni,
        "tracks": tracks.tracks,
    }


def _check(folder: Path) -> None:
    """Load what has been written. Raises ConfigError for sizes of which no machine can be made, and removes it."""
    from sojourn_config.errors import ConfigError
    from sojourn_config.scenario import load_scenario

    try:
        for scenario in ("flat", "slope"):
            load_scenario(str(folder.resolve() / f"{scenario}.yaml"))
    except ConfigError:
        shutil.rmtree(folder)
        raise


if __name__ == "__main__":
    command_line.run_script(main)
