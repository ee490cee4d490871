"""A way over the map that was sent from the page: planned again where the drive finds it closed, and only there."""

import numpy as np
import pytest

from sojourn_console.draft import Draft
from sojourn_console.far_way import FarWay
from sojourn_contract.values import OccupancyGrid
from sojourn_flight.hazards.obstacle_params import TiltLimits
from sojourn_flight.planning.global_route import SiteMap
from sojourn_machine.params import FloatArray
from sojourn_operator.far_goal import CLOSED, REPLANS

SITE = SiteMap(0.5, 0.5, 1.0, np.zeros((40, 40)), TiltLimits(0.25, 0.25, 0.2), 1.2)
STEP = "step of 0.25 m at (15.5, 10.5)"
CLOSED_WAY = {"state": "stopped", "reason": f"{STEP}: the map knows no way round", "obstacle": STEP}
HERE = (12.5, 10.5, 0.0)
SENT = Draft("route", ((20.5, 10.5, 0.0), (30.5, 10.5, 0.0)), yaw=0.5, over_map=True)


def level(places: FloatArray) -> FloatArray:
    return np.zeros(len(places))


def wall(first: int, last: int) -> OccupancyGrid:
    """Closed at x from 15 to 16 m, between these y [m]."""
    cells = np.zeros((40, 40), dtype=np.int8)
    cells[first:last, 15] = CLOSED
    return OccupancyGrid(0, "odom", 1.0, 40, 40, np.zeros(3), cells.tobytes())


@pytest.fixture
def far() -> FarWay:
    return FarWay(SITE, SENT, level)


def test_another_way_goes_round_what_was_found_to_the_same_goal(far: FarWay) -> None:
    far.hear(None)
    far.hear(wall(4, 22))
    assert far.after({"state": "moving"}, HERE) == (False, None)
    is_over, way = far.after(CLOSED_WAY, HERE)
    assert not is_over and way is not None and way.over_map and way.kind == "route"
    assert (way.points[-1], way.yaw) == ((30.5, 10.5, 0.0), 0.5) and min(y for _, y, _ in way.points) < 4.0
    assert far.way == way and "Planned again (1)" in far.told and STEP in far.told


@pytest.mark.parametrize(
    "status", [{"state": "reached"}, {"state": "stopped", "reason": "stopped by operator", "obstacle": STEP}]
)
def test_what_ends_otherwise_is_over(far: FarWay, status: dict[str, str]) -> None:
    far.hear(wall(4, 22))
    assert far.after(status, HERE) == (True, None)


def test_it_ends_where_nothing_new_is_found_and_where_no_way_is_left(far: FarWay) -> None:
    far.hear(wall(4, 22))
    far.after(CLOSED_WAY, HERE)
    assert far.after(CLOSED_WAY, HERE) == (True, None) and far.told.endswith("nothing new to plan by")
    shut = FarWay(SITE, SENT, level)
    shut.hear(wall(0, 40))
    assert shut.after(CLOSED_WAY, HERE) == (True, None) and "no route to (30.50, 10.50) m" in shut.told


def test_it_is_planned_so_often_at_most(far: FarWay) -> None:
    for count in range(REPLANS):
        far.hear(wall(4, 12 + count))
        assert far.after(CLOSED_WAY, HERE)[1] is not None
    far.hear(wall(4, 30))
    assert far.after(CLOSED_WAY, HERE) == (True, None) and far.told.endswith(f"planned {REPLANS} times anew")


def test_a_place_that_is_put_by_hand_is_no_way_over_the_map() -> None:
    routed = Draft("drive", ((30.5, 10.5, 0.0),)).over(SITE, HERE, level)
    assert routed.over_map and routed.moved(0, (1.0, 1.0, 0.0)).over_map
    assert not routed.with_point((3.0, 3.0, 0.0)).over_map
