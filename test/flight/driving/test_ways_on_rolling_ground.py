"""Minutes of driving with the whole drive, on ground that is rough and tilted: few ways round, none without need."""

import json
import math
from typing import Any

import numpy as np
import pytest
from rolling_rover import RollingRover

from sojourn_config.scenario import load_scenario
from sojourn_flight.planning.goal import Goal


def rover(seed: int, **terrain: Any) -> RollingRover:
    """The explorer at the origin, facing x, on ground of 26 x 30 m."""
    size = {"kind": "generated", "size_x": 26.0, "size_y": 30.0, "center_x": 7.0, "resolution": 0.05}
    given = [f"terrain.{key}={json.dumps(value)}" for key, value in (size | terrain).items()]
    return RollingRover(load_scenario("flat_drive", ["steps=[]", "start.x=0.0", f"seed={seed}", *given]))


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5])
def test_along_a_side_slope_it_goes_straight(seed: int) -> None:
    """15 m along 12 degrees with 1.5 degrees of roughness. A limit of 14 degrees for any direction gave 15 ways round,
    21 m of driving and a stop (seed 1)."""
    made = rover(seed, slope_deg=12.0, slope_direction_deg=90.0, roughness={"rms_slope_deg": 1.5})
    outcome = made.run(400.0, Goal.at(15.0, 0.0))
    assert outcome is not None and outcome.kind == "reached", outcome
    assert made.state.odometry.distance < 16.0 and len(made.ways) <= 1
    assert math.degrees(made.worst_tilt) < 18.0


@pytest.mark.parametrize("seed,north", [(1, 2.0), (2, 2.0), (3, -2.0), (4, 2.0), (5, -2.0)])
def test_a_long_ridge_is_passed_on_its_shorter_side(seed: int, north: float) -> None:
    """Rocks across the way over 12 m, from 4 m on the one side to 8 m on the other: both ends are out of sight from
    where it is met, and the way round is beyond the map."""
    generator = np.random.default_rng(seed)
    rocks = [
        {"x": 5.0 + generator.uniform(-0.1, 0.1), "y": y + generator.uniform(-0.1, 0.1),
         "diameter": generator.uniform(0.6, 0.9), "height": generator.uniform(0.25, 0.45)}
        for y in np.arange(north - 6.0, north + 6.01, 0.6).tolist()
    ]  # fmt: skip
    made = rover(seed, roughness={"rms_slope_deg": 1.0}, rocks=rocks)
    outcome = made.run(700.0, Goal.at(10.0, 0.0))
    assert outcome is not None and outcome.kind == "reached", outcome
    crossing = next(y for x, y, _ in made.track if x > 5.0)
    assert math.copysign(1.0, crossing) == -math.copysign(1.0, north), "past the end that is 4 m away"
    assert made.changes_of_mind <= 2
    assert made.state.odometry.distance < 22.0, "13 m with all known before"


def test_out_of_a_dead_end_it_goes_backwards() -> None:
    """A lane 2.5 m wide, too narrow to turn in (1.16 m to each side, to the cells that the walls close), whose end
    comes into sight when the rover is in it. It goes back to where it can just turn, and turns there."""
    walls = [
        {"kind": "step", "x": 2.0, "y": 1.4, "length": 6.0, "width": 0.3, "height": 0.4},
        {"kind": "step", "x": 2.0, "y": -1.4, "length": 6.0, "width": 0.3, "height": 0.4},
        {"kind": "step", "x": 8.0, "y": 0.0, "length": 0.3, "width": 3.1, "height": 0.4},
    ]
    made = rover(1, features=walls)
    outcome = made.run(700.0, Goal.at(11.0, 0.0))
    assert outcome is not None and outcome.kind == "reached", outcome
    assert max(x for x, y, _ in made.track if abs(y) < 0.3 and x < 8.0) > 3.0, "it was in the lane"
    assert 1.0 < made.reversed < 6.0
