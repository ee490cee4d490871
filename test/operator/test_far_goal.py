"""Goals over the map: planned again where the drive finds it closed, and not where an operator has stopped it."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from sojourn_config.command_errors import UsageError
from sojourn_contract.values import Message, OccupancyGrid
from sojourn_flight.hazards.obstacle_params import TiltLimits
from sojourn_flight.planning.global_route import SiteMap
from sojourn_machine.params import FloatArray
from sojourn_operator.far_goal import CLOSED, FoundCells, closed_places, drive_far, site_of
from sojourn_operator.goal_client import main

GOAL = (30.5, 10.5)
STEP = "step of 0.25 m at (15.5, 10.5)"


def site() -> SiteMap:
    return SiteMap(0.5, 0.5, 1.0, np.zeros((40, 40)), TiltLimits(0.25, 0.25, 0.2), 1.2)


def wall(first: int, last: int) -> OccupancyGrid:
    """Closed at x from 15 to 16 m, between these y [m]."""
    cells = np.zeros((40, 40), dtype=np.int8)
    cells[first:last, 15] = CLOSED
    return OccupancyGrid(0, "odom", 1.0, 40, 40, np.zeros(3), cells.tobytes())


@dataclass
class FakeRover:
    """Finds one costmap after the other, and gives up before each."""

    costmaps: list[OccupancyGrid]
    ends: list[tuple[str, str]]
    routes: list[list[tuple[float, float]]] = field(default_factory=list)

    def here(self) -> tuple[float, float]:
        return (2.5, 10.5) if not self.routes else (12.5, 10.5)

    def drive(self, route: Message) -> tuple[str, str]:
        self.routes.append([tuple(pose.position[:2].tolist()) for pose in route.poses])
        return self.ends[len(self.routes) - 1]

    def stands_before(self) -> str:
        return STEP

    def found(self) -> FloatArray:
        return closed_places(self.costmaps[len(self.routes) - 1])


def test_a_closed_way_is_planned_again_round_what_was_found() -> None:
    gave_up = ("stopped", f"{STEP}: the map knows no way round")
    rover = FakeRover([wall(4, 22), wall(22, 30), wall(0, 0)], [gave_up, gave_up, ("reached", "")])
    said: list[str] = []
    assert drive_far(rover, site(), GOAL, None, said.append) == ("reached", "")
    straight, round_low, again = rover.routes
    assert straight == [GOAL] and min(y for _, y in round_low[:-1]) < 4.0 and again[-1] == GOAL
    assert sum("again over the map" in words for words in said) == 2


@pytest.mark.parametrize("reason", ["stopped by operator", "no headway"])
def test_what_somebody_stopped_is_not_sent_again(reason: str) -> None:
    rover = FakeRover([wall(4, 22)], [("stopped", reason)])
    assert drive_far(rover, site(), GOAL, None, lambda _: None) == ("stopped", reason)
    assert len(rover.routes) == 1


def test_it_ends_where_nothing_new_is_found_or_no_way_is_left() -> None:
    gave_up = ("stopped", f"{STEP}: the map knows no way round")
    rover = FakeRover([wall(4, 22), wall(4, 22)], [gave_up, gave_up])
    assert drive_far(rover, site(), GOAL, None, lambda _: None)[1].endswith("nothing new has been found to plan by")
    rover = FakeRover([wall(0, 40)], [gave_up])
    outcome, reason = drive_far(rover, site(), GOAL, None, lambda _: None)
    assert outcome == "refused" and "no route to (30.50, 10.50) m" in reason and STEP in reason


def costmap(x: float, y: float, *rows: str) -> OccupancyGrid:
    """A corner, and cells of half a metre: # closed, . free, ? not known; the first row is that of the least y."""
    kinds = {"#": CLOSED, ".": 0, "?": -1}
    cells = np.array([[kinds[one] for one in row] for row in rows], dtype=np.int8)
    return OccupancyGrid(0, "odom", 0.5, cells.shape[1], cells.shape[0], np.array([x, y, 0.0]), cells.tobytes())


def test_what_the_drive_forgets_is_remembered_and_what_it_corrects_is_corrected() -> None:
    found = FoundCells()
    found.hear(costmap(-1.0, 2.0, "#..", "..#"))
    assert sorted(found.places.tolist()) == [[-0.75, 2.25], [0.25, 2.75]]
    found.hear(costmap(0.0, 2.0, "..", "?#"))  # one cell beyond it, one not known to it any more, one new
    assert sorted(found.places.tolist()) == [[-0.75, 2.25], [0.25, 2.75], [0.75, 2.75]]
    found.hear(costmap(0.0, 2.0, "..", ".."))
    assert found.places.tolist() == [[-0.75, 2.25]]
    found.hear(OccupancyGrid(0, "odom", 0.0, 0, 0, np.zeros(3), b""))
    assert found.places.tolist() == [[-0.75, 2.25]]


def test_the_map_is_that_of_the_run_with_what_was_set_of_it() -> None:
    usual, other = site_of("obstacle_course"), site_of("obstacle_course", ["seed=77"])
    assert usual.heights.shape == other.heights.shape and (usual.heights != other.heights).any()
    assert site_of("obstacle_course", ["terrain.size_x=30.0"]).heights.shape == (16, 30)


def test_what_was_set_is_of_the_map_alone() -> None:
    with pytest.raises(UsageError, match="--set: allowed with --over alone"):
        main(["drive", "1", "0", "--set", "seed=77"])


def test_the_map_of_a_scenario_is_coarse_and_not_the_truth() -> None:
    found = site_of("obstacle_course")
    assert found.cell == pytest.approx(1.0) and found.heights.shape == (16, 24)
    assert found.route((0.0, 0.0), (15.0, 0.0))[-1] == (15.0, 0.0)
