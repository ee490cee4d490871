"""Plant, camera and drive together: the rover goes round, stops, refuses; it never touches and never tips."""

import json
import math
from typing import Any

import numpy as np
import pytest
from rover_in_a_loop import Loop

from sojourn_config.scenario import load_scenario
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.planning.goal import Goal

ROCK = (3.2, 0.1, 0.3)
"""x, y, radius [m]."""
FRONT = 0.84
"""Foremost point of a wheel in base_link [m]."""


def loop(width: float = 20.0, overrides: tuple[str, ...] = (), **terrain: Any) -> Loop:
    """The explorer at the origin, facing x, on level ground of a width with what is put on it."""
    given = [f"terrain.{key}={json.dumps(value)}" for key, value in terrain.items()]
    size = [f"terrain.size_y={width}", "terrain.size_x=16", "terrain.center_x=4.0", "terrain.resolution=0.05"]
    return Loop(load_scenario("flat_drive", ["steps=[]", "start.x=0.0", *size, *given, *overrides]))


def rock() -> dict[str, Any]:
    return {"rocks": [{"x": ROCK[0], "y": ROCK[1], "diameter": 2 * ROCK[2], "height": 0.35}]}


def assert_safe(made: Loop) -> None:
    assert made.touched == set(), "nothing but the wheels has met the ground"
    assert made.worst_tilt < math.radians(6.0)


def test_it_goes_round_a_rock_on_the_line_and_arrives() -> None:
    made = loop(**rock())
    (outcome,) = made.run(160.0, Goal.at(5.6, 0.0))
    assert outcome.kind == "reached" and math.hypot(made.place[0] - 5.6, made.place[1]) < 0.3
    assert_safe(made)
    outline = [(x, y) for x in np.linspace(-FRONT, FRONT, 15) for y in np.linspace(-0.61, 0.61, 11)]
    nearest = min(
        math.hypot(px + c * x - s * y - ROCK[0], py + s * x + c * y - ROCK[1])
        for px, py, yaw in made.track
        for c, s in [(math.cos(yaw), math.sin(yaw))]
        for x, y in outline
    )
    assert nearest > ROCK[2], "no point of the outline has been above the rock, by the truth"
    avoidance = made.drive.avoidance
    assert avoidance is not None and 1 <= avoidance.detours <= 4


@pytest.mark.parametrize(
    "terrain,kinds,edge",
    [
        ({"features": [dict(kind="step", x=3.0, y=0.0, heading_deg=0.0, length=2.0, width=9.0, height=0.25)]}, ["step"],
         3.0),
        ({"features": [dict(kind="step", x=3.0, y=0.0, heading_deg=0.0, length=4.0, width=9.0, height=-0.6)]},
         ["drop", "hidden ground"], 3.0),
        ({"craters": [dict(x=5.5, y=0.0, diameter=6.0, depth=1.0)]}, ["drop", "descent", "hidden ground"], 2.5),
    ],
    ids=["step", "cliff", "crater"],
)  # fmt: skip
def test_it_stops_before_what_is_too_wide_to_go_round(terrain: dict[str, Any], kinds: list[str], edge: float) -> None:
    """With 1.5 m more than asked for, where 4 m and more would be needed."""
    made = loop(overrides=("drive.obstacles.max_detour=1.5",), **terrain)
    (outcome,) = made.run(120.0, Goal.at(10.0, 0.0))
    assert outcome.kind == "stopped" and outcome.reason.endswith("no way round with 2 m more than asked for")
    assert any(outcome.reason.startswith(kind) for kind in kinds), outcome.reason
    assert "drop?" in outcome.reason or "limit" in outcome.reason
    assert made.output is not None and made.output.status["obstacle"] == outcome.reason.partition(": no way")[0]
    made.run(3.0)
    assert made.place[0] + FRONT < edge
    assert_safe(made)


def test_a_goal_in_a_rock_is_given_up_when_it_is_seen_and_refused_when_it_is_known() -> None:
    made = loop(**rock())
    goal = Goal.at(ROCK[0], ROCK[1])
    (first,) = made.run(60.0, goal)
    assert first.kind == "stopped"
    (second,) = made.run(1.0, goal)
    assert second.kind == "refused" and math.isnan(second.distance_to_go)
    for outcome in (first, second):
        assert outcome.reason.startswith("the goal (3.20, 0.10) lies in an obstacle: step of 0.")
        assert outcome.reason.endswith("limit 0.12 m")
    assert made.place[0] < 1.5
    assert_safe(made)


def test_an_operator_is_stopped_before_an_obstacle_and_may_drive_away_from_it() -> None:
    made = loop(**rock())
    ahead, back = PlanarTwist(0.1, 0.0, 0.0), PlanarTwist(-0.1, 0.0, 0.0)
    made.run(30.0, twist=ahead)
    assert made.output is not None and made.output.wheel_rates.max() == 0.0
    assert made.drive.text.startswith("stopped before step of 0.")
    stopped = made.place[0]
    assert 1.0 < stopped < ROCK[0] - ROCK[2] - FRONT
    made.run(4.0, twist=back)
    assert made.place[0] < stopped - 0.15 and made.drive.text == "driving by /cmd_vel"
    assert_safe(made)


def test_the_guard_can_be_taken_off_cmd_vel() -> None:
    made = loop(overrides=("drive.obstacles.guard_cmd_vel=false",), **rock())
    made.run(24.0, twist=PlanarTwist(0.1, 0.0, 0.0))
    assert made.place[0] > 1.9 and made.output is not None and made.output.wheel_rates.max() > 0.0


def test_without_a_camera_and_without_the_parameters_it_drives_as_ever() -> None:
    for overrides in (("sensors.hazcam=null",), ("drive.obstacles=null",)):
        made = loop(overrides=overrides)
        assert made.model.avoidance is None and made.drive.avoidance is None
        made.run(0.1, Goal.at(1.0, 0.0))
        assert made.output is not None and made.output.status["obstacle"] == ""


def test_a_blind_rover_waits() -> None:
    """Without clouds for longer than blind_timeout it stands, and goes on with the next cloud."""
    made = loop()
    camera, made.camera = made.camera, None
    made.run(8.0, Goal.at(6.0, 0.0))
    assert made.output is not None and made.output.wheel_rates.max() == 0.0
    assert made.drive.text == "waiting for the hazard camera, nothing seen for 5 s"
    made.camera = camera
    made.run(3.0)
    assert made.output.wheel_rates.min() > 0.0
