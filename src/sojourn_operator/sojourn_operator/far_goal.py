"""A goal beyond the camera's sight: a route over the map of the site, and another where the rover finds it closed."""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from sojourn_config.command_errors import CommandError
from sojourn_contract.topics import topic
from sojourn_contract.values import Message, OccupancyGrid
from sojourn_flight.planning.global_route import NoRouteError, SiteMap
from sojourn_flight.planning.goal import Point
from sojourn_machine.params import FloatArray
from sojourn_operator.desk import Desk
from sojourn_operator.goal_messages import route_goal

REPLANS = 8
"""So often a route is planned anew."""
CLOSED = 100
"""In a cell of /local_costmap/costmap."""
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

    def costmap(self) -> OccupancyGrid | None:
        """What it has found round it; None where it has not said so."""
        ...


class RoverEars:
    """Hears, at a desk, where the rover is and what it has found."""

    def __init__(self, desk: Desk) -> None:
        self._heard: dict[str, Any] = {}
        self._readers = [desk.listen(topic(name), self._keep(name), lockstep=False) for name in ("/odom", COSTMAP)]

    @property
    def place(self) -> Point | None:
        """[m]; None before it has been heard."""
        odometry = self._heard.get("/odom")
        return None if odometry is None else (float(odometry.position[0]), float(odometry.position[1]))

    @property
    def costmap(self) -> OccupancyGrid | None:
        """Newest."""
        return self._heard.get(COSTMAP)

    def _keep(self, name: str) -> Callable[[Message], None]:
        def keep(message: Message) -> None:
            self._heard[name] = message

        return keep


def closed_places(grid: OccupancyGrid | None) -> FloatArray:
    """Middles of the closed cells of a costmap, shape (n, 2) [m]."""
    if grid is None or not grid.width * grid.height:
        return np.zeros((0, 2))
    cells = np.frombuffer(grid.data, dtype=np.int8).reshape(grid.height, grid.width)
    rows, columns = np.nonzero(cells == CLOSED)
    return np.asarray(grid.position[:2] + grid.resolution * (np.stack([columns, rows], axis=1) + 0.5))


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
        say(f"{'again ' if attempt else ''}over the map: " + " ".join(f"({x:.1f}, {y:.1f})" for x, y in points))
        outcome, reason = driver.drive(route_goal(0, points, yaw))
        obstacle = driver.stands_before()
        if outcome not in ("stopped", "refused") or not (obstacle and reason.startswith(obstacle)):
            return outcome, reason
        say(f"{outcome}: {reason}")
        found = site.with_found(closed_places(driver.costmap()))
        if site.found is not None and found.found is not None and (site.found == found.found).all():
            return outcome, f"{reason}; nothing new has been found to plan by"
        site = found
    return outcome, f"{reason}; planned {REPLANS} times anew"


def site_of(name: str) -> SiteMap:
    """The map of a scenario's site. Raises ConfigError, CommandError."""
    from sojourn_config.scenario import load_scenario
    from sojourn_config.site_map import site_map
    from sojourn_machine.errors import MachineError

    try:
        return site_map(load_scenario(name))
    except MachineError as error:
        raise CommandError(f"--over {name}: {error}") from error
