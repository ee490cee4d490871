"""A drive rehearsed from what is believed, and what it finds."""

import json
import math
import time
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_console.draft import Draft
from sojourn_console.errors import GoalError
from sojourn_console.goal_words import rehearsal_rows
from sojourn_console.model import BasePose
from sojourn_console.reckoning import reckon
from sojourn_console.rehearsal import STANDS_S, Now, after, believed, rehearse
from sojourn_console.rehearsed import RECKONED, SIMULATED, RehearsedDrive, middle
from sojourn_console.rehearser import Rehearser
from sojourn_contract.messages import contact_cloud
from sojourn_contract.topics import topic
from sojourn_contract.values import Odometry

HALF = math.sin(math.pi / 8)
HERE = BasePose(np.array([1.0, -2.0, 0.5]), np.array([0.0, 0.0, HALF, math.cos(math.pi / 8)]))
GOAL = Draft("drive", ((1.2, -1.8, 0.0),))
FLAT = load_scenario("flat_drive")


def test_the_world_of_a_rehearsal_is_what_is_believed() -> None:
    told = [
        "soil.k_c=1",
        "faults=[]",
        "machine=skid",
        "battery.capacity_ah=9",
        "belief.battery.capacity_ah=20",
        "rock_soil.k_c=1",
    ]
    found = believed(load_scenario("flat_drive", told), Now(HERE, 0.6), GOAL)
    assert found[:2] == ["machine=skid", "battery.capacity_ah=20"] and not any("k_c" in text for text in found)
    values = dict(text.split("=", 1) for text in found)
    assert json.loads(values["start"]) == pytest.approx({"x": 1.0, "y": -2.0, "yaw": math.pi / 4})
    assert float(values["battery_soc"]) == 0.6
    first, step = json.loads(values["steps"])
    assert first == {"wait_s": STANDS_S} and step["drive_to"] == {"x": 1.2, "y": -1.8}
    route = Draft("route", ((1.0, 0.0, 0.0), (2.0, 0.0, 0.0)), yaw=0.5)
    _, step = json.loads(dict(text.split("=", 1) for text in believed(FLAT, Now(HERE, 0.6), route))["steps"])
    assert step["drive_route"] == {"points": [{"x": 1.0, "y": 0.0}, {"x": 2.0, "y": 0.0}], "yaw": 0.5}
    with pytest.raises(GoalError, match="ways alone"):
        believed(FLAT, Now(HERE, 0.6), Draft("task", task="tare"))


@pytest.mark.parametrize("name", ["mars_sol", "flat_drive", "lunar_night"])
@pytest.mark.parametrize("hours", [0.0, 5.5, 30.0])
def test_the_sun_of_a_rehearsal_stands_where_it_is_now(name: str, hours: float) -> None:
    """It stood where it was when the run began: at night the array of a rehearsal gave what it had in the morning."""
    scenario = load_scenario(name)
    rehearsed = load_scenario(name, believed(scenario, Now(HERE, 0.6, hours * 3600.0), GOAL))
    for later in (0.0, 600.0):
        now = scenario.sun_over().path.direction(hours * 3600.0 + later)
        assert rehearsed.sun_over().path.direction(later) == pytest.approx(now, abs=1e-6)


def test_a_sun_whose_height_is_above_one_by_rounding_is_overhead(monkeypatch: pytest.MonkeyPatch) -> None:
    above = np.array([0.0, 0.0, math.nextafter(1.0, 2.0)])
    over = SimpleNamespace(path=SimpleNamespace(direction=lambda _time: above))
    monkeypatch.setattr(LoadedScenario, "sun_over", lambda _scenario: over)
    values = dict(text.split("=", 1) for text in believed(FLAT, Now(HERE, 0.6, 60.0), GOAL))
    assert float(values["sun.elevation_deg"]) == 90.0


def test_no_link_to_earth_is_in_a_rehearsal() -> None:
    """A metre on Mars was told to take 460 s, as the goal waited for a pass of the orbiter."""
    scenario = load_scenario("link_mars")
    start = BasePose(np.array([scenario.config.start.x, 0.0, 0.5]), np.array([0.0, 0.0, 0.0, 1.0]))
    goal = Draft("drive", ((scenario.config.start.x + 0.3, 0.0, 0.0),))
    overrides = believed(scenario, Now(start, 0.6), goal)
    assert load_scenario("link_mars", overrides).link is None
    *_, last = rehearse(load_scenario("link_mars", overrides))
    *_, found = reckon(load_scenario("link_mars", overrides))
    assert last.state == found.state == "reached" and last.time_s < 30.0
    assert last.energy_wh == pytest.approx(found.energy_wh, rel=0.2), "what the array gives is taken, too"


def test_a_short_drive_is_rehearsed_to_its_end() -> None:
    *_, before, last = rehearse(load_scenario("flat_drive", believed(FLAT, Now(HERE, 0.8), GOAL)))
    assert last.is_over and not before.is_over and last.state == "reached"
    apart = math.dist(GOAL.points[0][:2], HERE.position[:2])
    assert 0.5 * apart < last.length_m < 1.5 * apart
    assert last.energy_wh > 0.0 and 0.7 < last.charge < 0.9
    assert last.tilt_deg < 1.0 and 0.0 < last.slip < 0.5  # on the level


def test_the_worst_is_kept() -> None:
    def odometry(x: float, tilt: float) -> Odometry:
        turn = np.array([0.0, math.sin(tilt / 2), 0.0, math.cos(tilt / 2)])
        return Odometry(0, "map", "base_link", np.array([x, 0.0, 0.0]), turn, np.array([0.05, 0.0, 0.0]), np.zeros(3))

    report = np.zeros((2, 16))
    report[:, 4], report[:, 8] = (0.3, 0.9), (100.0, 1.0)  # the second hardly touches
    found, place = RehearsedDrive(), None
    for x, tilt in ((0.0, 0.1), (0.3, 0.2), (0.4, 0.05)):
        said = [(topic("/truth/odom"), odometry(x, tilt)), (topic("/truth/contacts"), contact_cloud(0, report))]
        found, place = after(found, place, said)
    assert found.tilt_deg == pytest.approx(math.degrees(0.2)) and found.length_m == pytest.approx(0.4)
    assert found.slip == pytest.approx(0.3)


def test_a_program_that_waits_reckons_first() -> None:
    rehearser = Rehearser()
    rehearser.prepare()
    ready = rehearser._ready
    rehearser.prepare()
    assert rehearser._ready is ready  # one is enough
    rehearser.begin("flat_drive", believed(FLAT, Now(HERE, 0.8), GOAL))
    while not (RECKONED in rehearser.found and rehearser.found[RECKONED].is_over):
        assert SIMULATED not in rehearser.found and not rehearser.problem
        time.sleep(0.02)
    rows = rehearsal_rows(rehearser)
    assert rows[0][0] == RECKONED and rows[0][1].startswith("reached")
    rehearser.prepare()
    rehearser.close()
    assert not rehearser.is_under_way and ready is not None and ready.poll() is not None


def test_what_depends_on_the_cameras_noise_is_told_as_a_spread() -> None:
    rehearser = Rehearser()
    drive = RehearsedDrive(RECKONED, "reached", time_s=100.0, energy_wh=3.0, is_over=True)
    rehearser.found = {RECKONED: drive}
    rehearser.looks = (drive, replace(drive, look=1, time_s=101.0, energy_wh=3.9))
    rows = dict(rehearsal_rows(rehearser))
    assert rows["driven"].endswith("in 100 s") and rows["energy"] == "3.00 Wh (3.00 to 3.90)"
    rehearser.looks = (*rehearser.looks, replace(drive, look=2, state="refused", time_s=20.0, energy_wh=0.5))
    rows = dict(rehearsal_rows(rehearser))
    assert rows[RECKONED] == "reached in 2 of 3; refused in 1 of 3" and rows["energy"] == "3.00 Wh (3.00 to 3.90)"


def test_what_is_told_first_is_in_the_middle_of_all_looks_that_end_alike() -> None:
    first = RehearsedDrive(RECKONED, "reached", time_s=160.0, is_over=True)
    assert middle([first]) is first
    slow, quick = replace(first, look=1, time_s=220.0), replace(first, look=2, time_s=120.0)
    assert middle([first, slow]) is slow, "of two the slower, for whoever has to be home by dusk"
    assert middle([first, slow, quick]) is first
    stuck = [replace(first, look=look, state="failed", time_s=10.0 * look) for look in (3, 4)]
    assert middle([first, slow, quick, *stuck]) is first
    assert middle([first, *stuck]) is stuck[1]


def test_a_program_that_reckons_is_told_by_its_middle_look() -> None:
    looks = [RehearsedDrive(RECKONED, "reached", time_s=time_s, look=look, is_over=True) for look, time_s in TIMES]
    under_way = RehearsedDrive(RECKONED, "moving", time_s=3.0, look=2)
    lines = [json.dumps(vars(one)) for one in (*looks[:2], under_way, looks[2])]
    rehearser, seen = Rehearser(), []

    class Child:
        @property
        def stdout(self) -> Iterator[str]:
            for line in lines:
                yield line
                seen.append(rehearser.found[RECKONED].time_s)

        stderr = None

        def wait(self) -> int:
            return 0

    rehearser._child = Child()  # type: ignore[assignment]
    rehearser._listen(rehearser._child)  # type: ignore[arg-type]
    assert seen == [122.0, 157.0, 157.0, 154.0] and not rehearser.is_under_way


def test_what_an_older_rehearsal_finds_late_is_not_the_new_ones() -> None:
    rehearser, found = Rehearser(), RehearsedDrive(RECKONED, "reached", time_s=999.0, is_over=True)

    class Old:
        stderr = None

        @property
        def stdout(self) -> Iterator[str]:
            rehearser._child = new  # another goal is rehearsed while this line is on its way
            yield json.dumps(vars(found))

        def wait(self) -> int:
            return 1

    old, new = Old(), Old()
    rehearser._child = old  # type: ignore[assignment]
    rehearser._listen(old)  # type: ignore[arg-type]
    assert not rehearser.found and not rehearser.looks and not rehearser.problem
    assert rehearser._child is new  # type: ignore[comparison-overlap]


TIMES = ((0, 122.0), (1, 157.0), (2, 154.0))
"""Of a drive to a goal behind a rock, as three looks had it."""


def test_one_that_fails_says_why() -> None:
    rehearser = Rehearser()
    rehearser.begin("no_such_scenario", [])
    while rehearser.is_under_way:
        time.sleep(0.05)
    assert "no_such_scenario" in rehearser.problem
    assert rehearsal_rows(rehearser)[0][1] == rehearser.problem
