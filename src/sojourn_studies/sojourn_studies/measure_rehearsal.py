"""Measures how soon a rehearsal answers, and how near it comes to what the drive then takes.

    scripts/lib/python -m sojourn_studies.measure_rehearsal              # ten drives of 10 m, beside a standing stack
    scripts/lib/python -m sojourn_studies.measure_rehearsal --scenario mars_sol --drives 4 --first 20

Each drive is a seed: of the ground, the rocks and all noise, of the direction of its goal, and of the soil, which is
the scenario's with parameters off (`measure_odometry.soil_of`) while the rehearsal believes what its file says. It is
rehearsed as the page does it, beside a stack in real time, and then driven by all apps after it has stood for a while,
so that no noise of the drive is that of its rehearsal. Told are when the first answer came, and how far time and energy
are off, of the first answer and of the last, once the way has been reckoned with all looks of the camera. A goal that
the rehearsal foretells as not to be reached, and that is not reached, is told and not counted; another direction is
tried.
"""

import argparse
import json
import math
import tempfile
import time
from collections import deque
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sojourn_config import command_line
from sojourn_config.command_errors import CommandError
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_console.draft import Draft
from sojourn_console.model import BasePose
from sojourn_console.rehearsal import LONGEST_S, LOOKS, Now, believed, rehearse
from sojourn_console.rehearsed import RECKONED, RehearsedDrive
from sojourn_console.rehearser import Rehearser
from sojourn_operator.goal_messages import drive_goal
from sojourn_studies.measure_odometry import soil_of
from sojourn_studies.probed_stack import WAITING, add_options, probed

FAR_M = 10.0
STANDING_S = 5.0
MOST_ANSWER_S, MOST_OFF = 3.0, 0.1
TRIES = 50
"""Directions that are tried for a drive."""
LOOK_S = 0.01


class Trial(NamedTuple):
    """One drive: what its rehearsal answered first, after how long [s], and last; and what it then took."""

    first: RehearsedDrive
    answer_s: float
    last: RehearsedDrive
    taken: RehearsedDrive

    def off(self, foretold: RehearsedDrive) -> tuple[float, float]:
        """Of time and energy foretold, over what was taken; infinite where nothing was."""
        taken = self.taken
        return _part(foretold.time_s, taken.time_s), _part(foretold.energy_wh, taken.energy_wh)

    def is_near(self, foretold: RehearsedDrive) -> bool:
        """Whether the end is as foretold, and time and energy are near."""
        return self.taken.state == foretold.state and all(abs(part) <= MOST_OFF for part in self.off(foretold))


def _part(foretold: float, taken: float) -> float:
    return foretold / taken - 1.0 if taken > 0.0 else math.inf


def goals(name: str, loaded: LoadedScenario, seed: int) -> Iterator[tuple[Draft, LoadedScenario]]:
    """Drives of FAR_M in drawn directions, and the run that stands for a while and then drives so.

    Args:
        name: of the scenario, or its file. loaded: it, with changes.
    """
    random, start = np.random.default_rng(seed), loaded.config.start
    for bearing in random.uniform(-math.pi, math.pi, TRIES):
        draft = Draft("drive", ((start.x + FAR_M * math.cos(bearing), start.y + FAR_M * math.sin(bearing), 0.0),))
        steps = [{"wait_s": STANDING_S}, {**draft.step(), "timeout_s": LONGEST_S}]
        changes = [f"steps={json.dumps(steps)}", f"duration_limit_s={LONGEST_S}", "link=null"]
        try:
            run = load_scenario(name, [*loaded.overrides, *changes])
        except ConfigError:  # it would lead off the map
            continue
        yield draft, run


def answered(name: str, loaded: LoadedScenario, draft: Draft) -> tuple[RehearsedDrive, float, RehearsedDrive]:
    """What the page is answered first of a goal at the start, after how long [s], and once all looks are reckoned.

    See `goals`. Raises CommandError where nothing is answered.
    """
    start, rehearser = loaded.config.start, Rehearser()
    here = drive_goal(0, (start.x, start.y), start.yaw)
    now = Now(BasePose(here.position, here.orientation), loaded.config.battery_soc)
    overrides = believed(loaded, now, draft)
    try:
        rehearser.prepare()  # as the page does where a drive is chosen
        time.sleep(STANDING_S)
        begin = time.monotonic()
        rehearser.begin(name, overrides)
        _wait(rehearser, 1)
        first, answer_s = rehearser.found[RECKONED], time.monotonic() - begin
        _wait(rehearser, LOOKS)
        return first, answer_s, rehearser.found[RECKONED]
    finally:
        rehearser.close()


def _wait(rehearser: Rehearser, looks: int) -> None:
    """Until so many are reckoned."""
    while len(rehearser.looks) < looks:
        if not rehearser.is_under_way:
            raise CommandError(f"rehearsal: {rehearser.problem or 'nothing was reckoned'}")
        time.sleep(LOOK_S)


def tried(given: argparse.Namespace, seed: int) -> Trial:
    """One drive. Raises CommandError where there is no goal that can be reached."""
    overrides = command_line.changes_of(given)
    soil = soil_of(load_scenario(given.scenario, overrides), seed)
    loaded = load_scenario(given.scenario, [*overrides, f"seed={seed}", *soil])
    for draft, run in goals(given.scenario, loaded, seed):
        trial = Trial(*answered(given.scenario, loaded, draft), deque(rehearse(run), 1)[0])
        if "reached" in (trial.first.state, trial.last.state, trial.taken.state):
            return trial
        words = f"foretold as {trial.last.state} and {trial.taken.state}: {trial.taken.reason}"
        print(f"seed {seed}: {draft.words()}, {words}", flush=True)
    raise CommandError(f"seed {seed}: no place {FAR_M:g} m off can be reached")


def in_words(seed: int, trial: Trial) -> str:
    """One drive, in a line."""
    after = trial.taken
    took = f"took {after.length_m:.2f} m, {after.time_s:.1f} s, {after.energy_wh:.2f} Wh ({after.state})"
    told = f"answered after {trial.answer_s:.2f} s: {_foretold(trial, trial.first)}"
    last = "" if trial.last == trial.first else f"; at last {_foretold(trial, trial.last)}"
    return f"seed {seed:3d}: {took}; {told}{last}"


def _foretold(trial: Trial, found: RehearsedDrive) -> str:
    time_off, energy_off = (100.0 * part for part in trial.off(found))
    return f"{found.time_s:.1f} s ({time_off:+.1f} %), {found.energy_wh:.2f} Wh ({energy_off:+.1f} %), {found.state}"


def measure(given: argparse.Namespace, run_dir: Path) -> bool:
    """Measure and print; whether every drive was foretold soon and well."""
    found = []
    with probed(given, ["--processes"], WAITING, run_dir) as stack:
        stack.wait_for(r": running")
        for seed in range(given.first, given.first + given.drives):
            stack.require_running()
            found.append(tried(given, seed))
            print(in_words(seed, found[-1]), flush=True)
    latest = max(trial.answer_s for trial in found)
    time_off, energy_off = 100.0 * np.abs([trial.off(trial.first) for trial in found]).max(axis=0)
    print(f"answers after {latest:.2f} s at most; time off by {time_off:.1f} %, energy by {energy_off:.1f} % at most")
    first = sum(trial.is_near(trial.first) for trial in found)
    last = sum(trial.is_near(trial.last) for trial in found)
    print(f"within {100.0 * MOST_OFF:g} %: {first} of {len(found)} first answers, {last} of the last")
    return latest <= MOST_ANSWER_S and first == len(found)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; status 1 where a drive was not foretold soon and well."""
    parser = command_line.Parser(prog="measure_rehearsal", description="How soon and how well a drive is foretold.")
    add_options(parser, "lunar_route")
    parser.set_defaults(realtime=True)  # whoever rehearses a drive stands
    parser.add_argument(
        "--drives", type=command_line.count, default=10, metavar="N", help="so many (default: %(default)s)"
    )
    parser.add_argument("--first", type=int, default=1, metavar="SEED", help="of the first (default: %(default)s)")
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="sojourn-rehearsal-") as folder:
        return 0 if measure(given, Path(folder) / "run") else 1


if __name__ == "__main__":
    command_line.run_script(main)
