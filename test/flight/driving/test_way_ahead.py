"""What is left of the way, as operators see it on a map; and what is known of the ground round the rover."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from obstacle_examples import dense
from rover_in_a_loop import Loop
from test_avoidance import AVOIDANCE, DRIVE, TURNING, at, facing_a_block, sent

from sojourn_config.scenario import load_scenario
from sojourn_flight.hazards.occupancy import CLOSED, NOT_KNOWN, OPEN, occupancy
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.follower_state import FollowerPhase, FollowerState
from sojourn_flight.planning.goal import Goal
from sojourn_flight.planning.goal_follower import accept, turned_about
from sojourn_flight.planning.way_back import way_back
from sojourn_flight.supervision.avoidance import initial_avoidance, see
from sojourn_flight.supervision.drive import DriveModel
from sojourn_flight.supervision.drive_types import DriveState
from sojourn_flight.supervision.way_ahead import EVERY, way_ahead

SCENARIO = load_scenario("flat_drive", ["steps=[]"])


def standing(x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> DriveState:
    return DriveModel(SCENARIO.drive, SCENARIO.mobility(), None).initial_state(x, y, yaw)


def going(goal: Goal) -> DriveState:
    """From the origin."""
    way = accept(DRIVE.follower, TURNING, goal, Pose(0.0, 0.0, 0.0))
    assert isinstance(way, FollowerState)
    return replace(standing(), follower=way)


def test_without_a_goal_there_is_no_way() -> None:
    assert way_ahead(standing()).shape == (0, 3)


@settings(max_examples=60, deadline=None)
@given(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0), st.none() | st.floats(-3.0, 3.0), st.booleans())
def test_it_leads_from_the_rover_to_the_goal_and_every_pose_looks_to_the_next(
    x: float, y: float, yaw: float | None, astern: bool
) -> None:
    if math.hypot(x, y) < 0.5:
        return
    state = going(Goal.at(x, y, yaw))
    assert state.follower is not None
    if astern:
        state = replace(state, follower=turned_about(state.follower, True))
    poses = way_ahead(state)
    assert poses[0, :2] == pytest.approx((0.0, 0.0), abs=0.06)
    assert poses[-1, :2] == pytest.approx((x, y), abs=0.06)
    if yaw is not None:
        assert math.remainder(poses[-1, 2] - yaw, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)
    for one, other in pairwise(poses[:-1]):
        step = math.dist(one[:2], other[:2])
        assert step <= EVERY + 0.06
        if step > 0.1:
            bearing = math.atan2(other[1] - one[1], other[0] - one[0]) + (math.pi if astern else 0.0)
            assert abs(math.remainder(one[2] - bearing, 2.0 * math.pi)) < 0.2


def test_at_the_end_of_the_way_the_goal_is_left() -> None:
    state = going(Goal.at(2.0, 1.0, 0.7))
    assert state.follower is not None
    state = replace(state, follower=replace(state.follower, phase=FollowerPhase.FINAL_ALIGN))
    assert way_ahead(state) == pytest.approx(np.array([[2.0, 1.0, 0.7]]))


def test_while_it_backs_off_the_way_is_behind_it_and_it_looks_on() -> None:
    seen, way = sent(facing_a_block(1.5, 1.9, 1.0), Goal.at(4.0, 0.0), at(0.0, 0.0))
    back = way_back((), Pose(0.0, 0.0, 0.0), seen.clearance, None, 1.0)
    assert back is not None
    poses = way_ahead(replace(standing(), follower=way, avoidance=replace(seen, back=back._replace(gone=0.4))))
    assert poses[0, 0] == pytest.approx(-0.4, abs=0.06) and poses[-1, 0] == pytest.approx(-1.0, abs=0.01)
    assert poses[:, 1] == pytest.approx(0.0, abs=1e-9)
    assert np.cos(poses[:, 2]) == pytest.approx(1.0)


def test_what_is_left_grows_less_as_the_rover_drives_on() -> None:
    loop = Loop(SCENARIO)
    loop.run(1.0, goal=Goal.at(2.0, 0.3))
    lengths = []
    for _ in range(4):
        poses = way_ahead(loop.drive)
        here = np.array([loop.drive.odometry.x, loop.drive.odometry.y])
        assert np.hypot(*(poses[0, :2] - here)) < 0.1
        lengths.append(float(np.hypot(*np.diff(poses[:, :2], axis=0).T).sum()))
        loop.run(3.0)
    assert all(later < sooner - 0.1 for sooner, later in pairwise(lengths))


def test_cells_are_free_closed_or_not_known() -> None:
    nothing = initial_avoidance(AVOIDANCE, 0.0, 0.0)
    assert (occupancy(nothing.map, nothing.ground) == NOT_KNOWN).all()
    cloud = dense(lambda x, y: np.where((x > 2.0) & (x < 2.4) & (abs(y) < 0.4), 0.3, 0.0))
    seen = see(AVOIDANCE, nothing, cloud, at(0.0, 0.0), 0.02)
    cells = occupancy(seen.map, seen.ground)
    assert cells.dtype == np.int8 and set(np.unique(cells)) == {NOT_KNOWN, OPEN, CLOSED}
    places = np.array([seen.map.centre(*cell) for cell in np.argwhere(cells == CLOSED)])
    assert len(places) > 20 and (abs(places - (2.2, 0.0)) < (0.4, 0.6)).all(axis=1).mean() > 0.9
    row, column = (
        round((there - corner) / seen.map.cell) for there, corner in ((0.0, seen.map.y0), (1.2, seen.map.x0))
    )
    assert cells[row, column] == OPEN
