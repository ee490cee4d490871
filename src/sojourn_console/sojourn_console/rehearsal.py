"""A drive rehearsed: all apps of the run as one value, from where the machine believes to be, as fast as they go.

The world of a rehearsal is what is believed: the scenario's files with `belief.` values in place of the truth's, the
map for the ground, no faults. So what a run has been given as truth alone, another soil say, is not in it. It begins
at rest, at the pose and the charge that drive and power manager tell, with the arm stowed and the Sun where it stands
now; what is planned for the hours ahead (`activities`) is that of the run's start. The goal is the machine's own from
the first: no link to Earth is in it.

It is a program of its own, for it keeps a core busy; it prints what it has found so far, a line of JSON a time: first
what is reckoned (`reckoning`), within seconds, then what all apps together find. Started without arguments it loads
what it needs and waits for them, a list in JSON on its standard input: so it is there when it is wanted.
"""

import itertools
import json
import math
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, replace
from datetime import timedelta
from typing import NamedTuple

import numpy as np

from sojourn_config import command_line
from sojourn_config.machine_reader import TABLES
from sojourn_config.overrides import split_beliefs
from sojourn_config.scenario import HEADS, TRUTH_ALONE, LoadedScenario, load_scenario
from sojourn_console.draft import Draft
from sojourn_console.errors import GoalError
from sojourn_console.model import BasePose
from sojourn_console.reckoning import reckon
from sojourn_console.rehearsed import RehearsedDrive
from sojourn_contract.clouds import columns_of
from sojourn_contract.heartbeat import status_values
from sojourn_contract.messages import yaw_of
from sojourn_contract.run_table import table_of
from sojourn_machine.params import FloatArray
from sojourn_operator.steps.wait import WaitStep
from sojourn_stack.apps import make_apps
from sojourn_stack.stack import Said, Stack

ROLES = ("plant", "sensors", "drive", "arm", "power", "operator")
TELL_S = 0.5
"""Wall time between two lines."""
BEARING_N = 5.0
"""A wheel that bears less slips as it likes, and it does not matter."""
ROLLING = 0.02
"""Speed below which a wheel's slip says little: it is 1 when the machine begins to move [m/s]."""
LONGEST_S = 7200.0
STANDS_S = 3.0
"""Before it begins [s], as the machine does of which it is a rehearsal: so the drive knows what sources give."""
LOOKS = 5
"""Times that a drive is reckoned, each with other noise of the camera."""
TRUTHS_ALONE = ("faults", "soil", "rock_soil", *TRUTH_ALONE)
"""First words of what no machine believes."""


class Now(NamedTuple):
    """How the machine stands: where, its charge, 0 to 1, and how long the run has gone on [s]."""

    pose: BasePose
    charge: float
    time_s: float = 0.0


def believed(scenario: LoadedScenario, now: Now, draft: Draft) -> list[str]:
    """What goes over the files of a run's scenario for a rehearsal of a goal. Raises GoalError for one of the arm."""
    if not draft.is_way or not draft.points:
        raise GoalError(draft.kind, "ways alone can be rehearsed, with a point at least")
    told, beliefs = split_beliefs(scenario.overrides, HEADS, TABLES)
    known = [text for text in told if text.partition("=")[0].partition(".")[0].partition("[")[0] not in TRUTHS_ALONE]
    x, y = (float(one) for one in now.pose.position[:2])
    return [
        *known,
        *beliefs,
        *_sun(scenario, now.time_s),
        f"start={json.dumps({'x': x, 'y': y, 'yaw': yaw_of(now.pose.orientation) or 0.0})}",
        f"battery_soc={min(max(now.charge, 0.0), 1.0)}",
        f"steps={json.dumps([{'wait_s': STANDS_S}, {**draft.step(), 'timeout_s': LONGEST_S}])}",
        f"duration_limit_s={LONGEST_S}",
        "faults=[]",
        "link=null",
    ]


def _sun(scenario: LoadedScenario, time_s: float) -> list[str]:
    """What puts the Sun where it stands so long after the start."""
    sun = scenario.config.sun
    if sun.time is not None:
        return [f"sun.time={json.dumps((sun.time + timedelta(seconds=time_s)).isoformat())}"]
    east, north, up = scenario.sun_over().path.direction(time_s)
    return [
        f"sun.azimuth_deg={math.degrees(math.atan2(east, north))}",
        f"sun.elevation_deg={math.degrees(math.atan2(up, math.hypot(east, north)))}",
    ]


def rehearse(loaded: LoadedScenario) -> Iterator[RehearsedDrive]:
    """Run a rehearsal, and tell after each control period what has been found. Raises StackError.

    Time is told from the end of a first step that waits.
    """
    first = loaded.config.steps[0].action
    stood_s = first.root if isinstance(first, WaitStep) else 0.0
    roles = [role for role in ROLES if role != "arm" or loaded.arm is not None]
    stack = Stack(make_apps(loaded, roles), roles, table_of(loaded))
    state, said = stack.begin()
    found, place = RehearsedDrive(), None
    while not state.finished:
        state, said = stack.step(state)
        found, place = after(found, place, said)
        yield replace(found, time_s=max(found.time_s - stood_s, 0.0))
    yield replace(found, time_s=max(found.time_s - stood_s, 0.0), is_over=True)


def after(
    found: RehearsedDrive, place: FloatArray | None, said: Iterable[Said]
) -> tuple[RehearsedDrive, FloatArray | None]:
    """What has been found after a period, and where the machine is then."""
    speed = 0.0
    for row, message in said:
        if row.name == "/truth/odom":
            speed = float(np.linalg.norm(message.linear))
            way = 0.0 if place is None else float(np.linalg.norm(message.position[:2] - place[:2]))
            place = message.position
            x, y = message.orientation[:2]
            tilt = math.degrees(math.acos(min(1.0 - 2.0 * float(x * x + y * y), 1.0)))
            found = replace(found, length_m=found.length_m + way, tilt_deg=max(found.tilt_deg, tilt))
        elif row.name == "/truth/contacts" and speed > ROLLING:
            columns = columns_of(row.name, message, ("slip_ratio", "force_z"))
            slips = np.abs(columns["slip_ratio"][columns["force_z"] > BEARING_N])
            found = replace(found, slip=max(found.slip, float(slips.max(initial=0.0))))
        elif row.name == "/drive/status":
            values = status_values(message)
            used = float(values.get("energy_used_wh", found.energy_wh))
            found = replace(
                found, state=values.get("state", ""), reason=values.get("reason", ""), energy_wh=used,
                time_s=message.stamp * 1e-9,
            )  # fmt: skip
        elif row.name == "/battery_state":
            found = replace(found, charge=message.percentage)
        elif row.name == "/power/status":
            found = replace(found, mode=status_values(message).get("mode", ""))
    return found, place


def main(arguments: Sequence[str] | None = None) -> int:
    """Rehearse: SCENARIO OVERRIDE ..., and print a line of JSON from time to time and at the end of each way of it."""
    given = sys.argv[1:] if arguments is None else arguments
    if not given:
        line = sys.stdin.readline()
        if not line:  # whoever might have asked has gone
            return 0
        given = json.loads(line)
    scenario, *overrides = given
    loaded, told = load_scenario(scenario, overrides), 0.0
    reckoned = itertools.chain.from_iterable(reckon(loaded, look) for look in range(LOOKS))
    for found in itertools.chain(reckoned, rehearse(loaded)):
        if found.is_over or time.monotonic() - told > TELL_S:
            told = time.monotonic()
            print(json.dumps(asdict(found)), flush=True)
    return 0


if __name__ == "__main__":
    command_line.run_script(main)
