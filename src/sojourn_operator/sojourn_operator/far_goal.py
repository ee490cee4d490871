"""A goal beyond the camera's sight: a route over the map of the site, and another where the rover finds it closed."""

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sojourn_config.command_errors import CommandError
from sojourn_contract.link_topics import on_earth
from sojourn_contract.topics import topic
from sojourn_contract.values import Message, OccupancyGrid
from sojourn_flight.planning.global_route import NoRouteError, SiteMap
from sojourn_flight.planning.goal import Point
from sojourn_machine.params import FloatArray
from sojourn_operator.desk import Desk
from sojourn_operator.goal_messages import route_goal

REPLANS = 8
"""So often a route is planned anew."""
CLOSED, NOT_KNOWN = 100, -1
"""In a cell of /local_costmap/costmap."""
ODOMETRY = "/odom"
COSTMAP = "/local_costmap/costmap"


class Driver(Protocol):
    """Who brings a route to the rover."""

    def here(self) -> Point:
        """Where the rover is now, by its own estimate [m]."""
        ...

    def drive(self, route: Message) -> tuple[str, str]:
        """Send it and follow it to its end: outcome and reason."""
        ...

    def stands_before(self) -> str:
        """The obstacle for which the drive has stopped last, in its own words; empty for none."""
        ...

    def found(self) -> FloatArray:
        """Places that it has found closed, shape (n, 2) [m]."""
        ...


class FoundCells:
    """What a drive has found closed on its way, of which its own map forgets the most: of each cell the last word."""

    def __init__(self) -> None:
        self._cells = np.zeros((0, 2), dtype=np.int64)
        """Column and row, counted from the origin of odom."""
        self._side = 0.0

    @property
    def places(self) -> FloatArray:
        """Middles of the cells, shape (n, 2) [m]."""
        return np.asarray(self._side * (self._cells + 0.5), dtype=np.float64)

    def hear(self, grid: OccupancyGrid) -> None:
        """What it says of the ground round it now."""
        if not grid.width * grid.height:
            return
        if grid.resolution != self._side:
            self._cells, self._side = np.zeros((0, 2), dtype=np.int64), grid.resolution
        corner = np.rint(grid.position[:2] / grid.resolution).astype(np.int64)
        column, row = (self._cells - corner).T
        here = (column >= 0) & (row >= 0) & (column < grid.width) & (row < grid.height)
        kinds = _kinds(grid)
        here[here] = kinds[row[here], column[here]] != NOT_KNOWN
        closed = np.argwhere(kinds == CLOSED)[:, ::-1] + corner
        self._cells = np.concatenate([self._cells[~here], closed])


class RoverEars:
    """Hears, at a desk, where the rover is and what it has found.

    Args:
        over_link: whether it hears what a link to Earth brings of it, some time later.
    """

    def __init__(self, desk: Desk, over_link: bool = False) -> None:
        self.place: Point | None = None
        """[m]; None before it has been heard."""
        self.found = FoundCells()
        odometry, costmap = topic(ODOMETRY), topic(COSTMAP)
        if over_link:
            odometry, costmap = on_earth(odometry), on_earth(costmap)
        self._readers = [
            desk.listen(odometry, self._stands, lockstep=False),
            desk.listen(costmap, self.found.hear, lockstep=False),
        ]

    def _stands(self, message: Message) -> None:
        self.place = float(message.position[0]), float(message.position[1])


def closed_places(grid: OccupancyGrid | None) -> FloatArray:
    """Middles of the closed cells of a costmap, shape (n, 2) [m]."""
    if grid is None or not grid.width * grid.height:
        return np.zeros((0, 2))
    rows, columns = np.nonzero(_kinds(grid) == CLOSED)
    return np.asarray(grid.position[:2] + grid.resolution * (np.stack([columns, rows], axis=1) + 0.5))


def _kinds(grid: OccupancyGrid) -> NDArray[np.int8]:
    """What its cells are, shape (height, width)."""
    return np.frombuffer(grid.data, dtype=np.int8).reshape(grid.height, grid.width)


def drive_far(
    driver: Driver, site: SiteMap, goal: Point, yaw: float | None, say: Callable[[str], None]
) -> tuple[str, str]:
    """Drive to a place over the map, planned again as often as the drive finds the way closed. Outcome and reason.

    Args:
        yaw: heading at the goal [rad], None for any. say: takes what is done, in words.
    """
    outcome, reason = "refused", ""
    for attempt in range(REPLANS + 1):
        try:
            points = site.route(driver.here(), goal)
        except NoRouteError as error:
            return "refused", f"{error}; {reason}" if reason else str(error)
        say(("again " if attempt else "") + route_words(points))
        outcome, reason = driver.drive(route_goal(0, points, yaw))
        if not finds_it_closed(outcome, reason, driver.stands_before()):
            return outcome, reason
        say(f"{outcome}: {reason}")
        found = with_new(site, driver.found())
        if found is None:
            return outcome, f"{reason}; nothing new has been found to plan by"
        site = found
    return outcome, f"{reason}; planned {REPLANS} times anew"


def finds_it_closed(outcome: str, reason: str, obstacle: str) -> bool:
    """Whether a drive has ended so because of an obstacle in the words of its status, and not for another reason."""
    return outcome in ("stopped", "refused") and bool(obstacle) and reason.startswith(obstacle)


def with_new(site: SiteMap, places: FloatArray) -> SiteMap | None:
    """The map with what has been found closed, shape (n, 2) [m]; None where it had all of it."""
    found = site.with_found(places)
    if site.found is not None and found.found is not None and (site.found == found.found).all():
        return None
    return found


def route_words(points: Sequence[Point]) -> str:
    """A route over the map in words."""
    return "over the map: " + " ".join(f"({x:.1f}, {y:.1f})" for x, y in points)


def site_of(name: str, overrides: Sequence[str] = ()) -> SiteMap:
    """The map of a scenario's site, with KEY=VALUE texts over its files. Raises ConfigError, CommandError."""
    from sojourn_config.scenario import load_scenario
    from sojourn_config.site_map import site_map
    from sojourn_machine.errors import MachineError

    try:
        return site_map(load_scenario(name, overrides))
    except MachineError as error:
        raise CommandError(f"--over {name}: {error}") from error
