"""A way over the map that has been sent from the page: where the drive finds it closed, another is planned."""

from collections.abc import Callable, Mapping
from dataclasses import replace

from sojourn_console.draft import Draft, Point
from sojourn_console.errors import GoalError
from sojourn_contract.values import OccupancyGrid
from sojourn_flight.planning.global_route import SiteMap
from sojourn_machine.params import FloatArray
from sojourn_operator.far_goal import REPLANS, FoundCells, finds_it_closed, with_new
from sojourn_operator.steps.step import FINAL_STATES


class FarWay:
    """One way, until it has ended.

    Args:
        site: the map that it was planned over. draft: the route that was sent.
        heights: of the ground at places, shape (n, 2) [m].

    Attributes:
        way: the route under way. told: what became of it last, in words.
    """

    def __init__(self, site: SiteMap, draft: Draft, heights: Callable[[FloatArray], FloatArray]) -> None:
        self._site, self._heights, self._found = site, heights, FoundCells()
        self._goal = replace(draft, points=draft.points[-1:])
        self._times = 0
        self.way, self.told = draft, ""

    def hear(self, grid: OccupancyGrid | None) -> None:
        """What the drive knows of the ground round it."""
        if grid is not None:
            self._found.hear(grid)

    def after(self, status: Mapping[str, str], start: Point) -> tuple[bool, Draft | None]:
        """Whether it is over, and the next way where there is one.

        Args:
            status: of the drive, about this way. start: where the machine stands.
        """
        outcome, reason = status.get("state", ""), status.get("reason", "")
        if outcome not in FINAL_STATES:
            return False, None
        if not finds_it_closed(outcome, reason, status.get("obstacle", "")):
            return True, None
        site = with_new(self._site, self._found.places)
        if site is None or self._times == REPLANS:
            self.told = f"{reason}; " + ("nothing new to plan by" if site is None else f"planned {REPLANS} times anew")
            return True, None
        self._site, self._times = site, self._times + 1
        try:
            self.way = self._goal.over(site, start, self._heights)
        except GoalError as error:
            self.told = f"{error}; {reason}"
            return True, None
        self.told = f"closed: {reason}. Planned again ({self._times}): {len(self.way.points)} points"
        return False, self.way
