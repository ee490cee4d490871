"""The way back: over the own track, to where there is clearance, and no farther."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from obstacle_examples import PARAMS

from sojourn_config.scenario import load_scenario
from sojourn_flight.hazards.clearance import ClearanceMap, clearance_in
from sojourn_flight.hazards.obstacle_map import empty_map
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.way_back import SET_DOWN, SPACING, Track, driven_on, go_back, way_back

FOLLOWER = load_scenario("flat_drive").drive.follower
TURNING = PARAMS.outline.turn_radius + PARAMS.margin


def walls(west: float) -> ClearanceMap:
    """A corridor along x: walls at y = +-1 from x = west on."""
    map_ = empty_map(PARAMS, 0.0, 0.0)
    rows, columns = np.indices(map_.known.shape)
    east, north = map_.x0 + (columns + 0.5) * map_.cell, map_.y0 + (rows + 0.5) * map_.cell
    return clearance_in(map_, ((abs(north) > 1.0) & (east > west)).astype(np.int64))


def driven(curvature: float, length: float, start: Pose, step: float = 0.01) -> tuple[Track, Pose]:
    """The track of an arc, and where it ends."""
    track, here = driven_on((), start), start
    for _ in range(round(length / step)):
        heading = here.heading + 0.5 * curvature * step
        x, y = here.x + step * math.cos(heading), here.y + step * math.sin(heading)
        here = Pose(x, y, here.heading + curvature * step)
        track = driven_on(track, here)
    return track, here


def test_it_ends_where_there_is_room_to_turn() -> None:
    track, here = driven(0.0, 4.0, Pose(-2.0, 0.0, 0.0))
    way = way_back(track, here, walls(0.0), TURNING, 10.0)
    assert way is not None
    x, y = way.leg.end.x, way.leg.end.y
    assert walls(0.0).at(x, y) >= TURNING and -0.8 < x < 0.0 and y == pytest.approx(0.0)
    short = way_back(track, here, walls(0.0), TURNING, 0.5)
    assert short is not None and short.leg.end.x == pytest.approx(1.5, abs=SPACING)


@settings(max_examples=8, deadline=None)
@given(st.floats(-0.6, 0.6), st.floats(0.5, 5.0), st.floats(-0.05, 0.05), st.floats(-0.05, 0.05))
def test_driven_backwards_it_comes_back_over_its_track(
    curvature: float, length: float, off: float, turn: float
) -> None:
    """From a little beside the track and turned a little; a rover that obeys."""
    start = Pose(0.3, -0.2, 0.4)
    track, end = driven(curvature, length, start)
    way = way_back(track, end, walls(9.0), None, 10.0)
    assert way is not None and way.leg.length == pytest.approx(length, abs=0.02)
    leg = way.leg
    here = Pose(end.x - off * math.sin(end.heading), end.y + off * math.cos(end.heading), end.heading + turn)
    periods = 0
    while way is not None:
        beside = leg.nearest(here.x, here.y, way.gone).lateral
        assert abs(beside) < 1.1 * abs(off) + 0.5 * abs(turn) + 0.01
        way, twist = go_back(FOLLOWER, way, here, 0.05)
        assert twist.v_x <= 0.0 and periods < 1200
        middle = here.heading + 0.05 * twist.yaw_rate
        here = Pose(
            here.x + 0.1 * twist.v_x * math.cos(middle),
            here.y + 0.1 * twist.v_x * math.sin(middle),
            here.heading + 0.1 * twist.yaw_rate,
        )
        periods += 1
    assert math.dist(here[:2], start[:2]) < 0.05 + abs(off) + 0.5 * abs(turn)


def test_the_track_ends_where_the_rover_turned_on_the_spot() -> None:
    track, here = driven(0.0, 1.0, Pose(0.0, 0.0, 0.0))
    for _ in range(20):
        here = here._replace(heading=here.heading + 0.08)
        track = driven_on(track, here)
    for step in range(30):
        track = driven_on(track, Pose(here.x + 0.02 * step * math.cos(here.heading),
                                      here.y + 0.02 * step * math.sin(here.heading), here.heading))  # fmt: skip
    way = way_back(track, track[-1], walls(9.0), None, 10.0)
    assert way is not None and way.leg.length == pytest.approx(0.5, abs=SPACING)


def test_driving_back_takes_the_track_up() -> None:
    track, here = driven(0.0, 2.0, Pose(0.0, 0.0, 0.0))
    whole = track
    for step in range(101):
        track = driven_on(track, here._replace(x=here.x - 0.01 * step))
    assert track == whole[: len(track)] and track[-1].x == pytest.approx(here.x - 1.0, abs=SPACING)


def test_set_down_before_an_obstacle_it_goes_straight_back_for_its_own_length() -> None:
    here = Pose(1.0, 0.0, 0.0)
    way = way_back(driven_on((), here), here, walls(-9.0), TURNING, 4.0)
    assert way is not None and way.leg.length == pytest.approx(SET_DOWN)
    assert (way.leg.end.x, way.leg.end.y) == pytest.approx((0.0, 0.0))
