"""Driving astern: when the drive chooses it, and how it gets to its goal over ground that it has seen."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from rolling_rover import DT, RollingRover

from sojourn_config.scenario import load_scenario
from sojourn_flight.planning.follower_state import FollowerPhase, FollowerState
from sojourn_flight.planning.goal import Goal
from sojourn_flight.supervision.astern import choose_sense, is_answered
from sojourn_flight.supervision.drive_types import DriveState
from wheel_drive import WheelDrive

WHEELS = ("front_left", "front_right", "middle_left", "middle_right", "rear_left", "rear_right")


def dead(model: WheelDrive, state: DriveState, *wheels: str) -> DriveState:
    """The state of a drive that knows that these wheels have lost their motors; nothing will change its mind."""
    failed = np.array([name in wheels for name in model.geometry.names])
    doubt = np.where(failed, 1e6, 0.0)
    motors = state.mobility.motors._replace(drive_failed=failed, drive_doubt=doubt)
    return replace(state, mobility=replace(state.mobility, motors=motors))


def rover(**terrain: Any) -> RollingRover:
    size = {"terrain.size_x": 26.0, "terrain.size_y": 20.0, "terrain.center_x": 7.0, "terrain.resolution": 0.05}
    given = [f"{key}={value}" for key, value in size.items()] + [f"terrain.{k}={v}" for k, v in terrain.items()]
    made = RollingRover(load_scenario("flat_drive", ["steps=[]", "start.x=0.0", "terrain.kind=generated", *given]))
    assert made.model.geometry.names == WHEELS
    return made


@pytest.mark.parametrize(
    "wheels,helps",
    [
        ((), False),
        (("front_left",), True),
        (("rear_right",), False),
        (("middle_left",), False),
        (("front_left", "rear_left"), False),
        (("front_left", "front_right", "rear_left"), True),
    ],
)
def test_it_helps_where_dead_wheels_lead(model: WheelDrive, wheels: tuple[str, ...], helps: bool) -> None:
    assert model.mobility.rather_astern(dead(model, model.initial_state(), *wheels).mobility) is helps


def sent(made: RollingRover) -> FollowerState:
    """Two looks, and a goal."""
    for _ in range(20):
        made._step(None)
    made._step(Goal.at(8.0, 0.0))
    way = made.state.follower
    assert way is not None and way.phase is FollowerPhase.DRIVE
    return way


def trailing(made: RollingRover, goal: Goal) -> None:
    """Two looks, a goal, and the word that the dead wheel is to be trailed: the ground gives no slip here."""
    made.dead = ("front_left",)
    for _ in range(20):
        made._step(None)
    made.state = dead(made.model, made.state, "front_left")
    made._step(goal)
    assert made.state.follower is not None
    made.state = replace(made.state, follower=replace(made.state.follower, trails=True))


def test_wheels_that_slip_make_it_look_and_then_turn_about() -> None:
    """Without slip, and with a dead wheel that trails already, it drives on."""
    made = rover()
    way, model, odometry = sent(made), made.model, made.state.odometry
    seen = made.state.avoidance
    assert seen is not None
    seen = replace(seen, fresh=True)
    assert choose_sense(model, seen, way, True, False, odometry).way == way
    assert not choose_sense(model, seen, way, False, True, odometry).way.trails
    observes = choose_sense(model, seen, way, True, True, odometry)
    assert observes.observing and observes.way.trails and not observes.way.astern
    assert is_answered(way, True) and is_answered(observes.way, True)
    observed = replace(observes.way, phase_elapsed=2.0)
    turns = choose_sense(model, seen, observed, True, False, odometry).way
    assert turns.astern and turns.phase is FollowerPhase.ALIGN and is_answered(turns, True)
    blind = replace(seen, map=replace(seen.map, layers=np.zeros_like(seen.map.layers)))
    assert choose_sense(model, blind, observed, True, True, odometry).way == observed, "nothing has been seen"
    given_up = replace(observed, phase_elapsed=3.0)
    assert not choose_sense(model, blind, given_up, True, True, odometry).observing
    assert not is_answered(given_up, True), "then wheels that spin end the goal as ever"
    assert not choose_sense(model, seen, turns, False, False, odometry).way.astern, "the motor is back"


@pytest.mark.parametrize("heading", [None, 1.0])
def test_it_drives_astern_over_what_it_has_seen_and_turns_to_look(heading: float | None) -> None:
    """Seven metres, about two for each look; a rock of 0.35 m on the line is gone round."""
    made = rover(rocks='[{"x": 4.2, "y": 0.1, "diameter": 0.6, "height": 0.35}]')
    trailing(made, Goal.at(7.0, 0.0, heading))
    outcome, unseen, ahead, senses, nearest = None, 0, 0.0, [False], 9.0
    while outcome is None and made.period < 9000:
        seen, odometry, way = made.state.avoidance, made.state.odometry, made.state.follower
        assert seen is not None and way is not None
        if odometry.v_x < -0.005:
            cosine, sine = math.cos(odometry.yaw), math.sin(odometry.yaw)
            for y in (0.53, -0.53):  # the ground under the rear wheels
                x, y = odometry.x - 0.7 * cosine - y * sine, odometry.y - 0.7 * sine + y * cosine
                row, column = seen.clearance.cell_of(x, y)
                unseen += not seen.map.known[row - 1 : row + 2, column - 1 : column + 2].any()
        ahead += max(odometry.v_x, 0.0) * DT
        nearest = min(nearest, math.hypot(odometry.x - 4.2, odometry.y - 0.1))
        if way.astern != senses[-1]:
            senses.append(way.astern)
        outcome = next(iter(made._step(None)), None)
    assert outcome is not None and outcome.kind == "reached", outcome
    assert unseen == 0
    assert made.reversed > 5.0 and ahead < 1.5
    assert 3 <= sum(senses) <= 6, "so often it has turned about"
    assert nearest > 0.6 + 0.3
    assert heading is None or abs(made.state.odometry.yaw - heading) < 0.1


def test_the_status_says_so() -> None:
    made = rover()
    trailing(made, Goal.at(7.0, 0.0))
    said = []
    for _ in range(700):
        made._step(None)
        said.append((made.output.status["astern"], made.state.text.split(",")[0]))
        assert made.state.waits == made.state.text.startswith(("looks", "wheels wait"))
    assert (0.0, "looks where to drive astern") in said
    assert (1.0, "align astern") in said and (1.0, "drive astern") in said
