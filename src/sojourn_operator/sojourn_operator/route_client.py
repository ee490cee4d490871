"""Brings routes over a map to the rover of a running stack, and tells of it what planning needs.

Over a link to Earth that is what the link has brought: where the rover stood when it was sent. The routes go to the
link; planned again is where the costmap is among its telemetry.
"""

import time

from sojourn_contract.heartbeat import status_values
from sojourn_contract.link_topics import on_earth
from sojourn_contract.topics import topic
from sojourn_contract.values import Message
from sojourn_machine.params import FloatArray
from sojourn_operator.far_goal import ODOMETRY, RoverEars
from sojourn_operator.goal_sending import GOALS, STOP_SETTLE_S, STOPPED_S, GoalClient, NoStackError


class RouteClient:
    """A `Driver` of `far_goal`.

    Args:
        client: that sends routes. timeout_s: for each [s]. over_link: whether the run has a link to Earth.

    Raises NoStackError for a link that does not tell where the rover is.
    """

    def __init__(self, client: GoalClient, timeout_s: float, over_link: bool = False) -> None:
        self._client, self._timeout_s, self._ears = client, timeout_s, RoverEars(client, over_link)
        self._over_link = over_link
        client.spin(STOP_SETTLE_S)
        if over_link and not client.node.count_publishers(on_earth(topic(ODOMETRY)).name.lstrip("/")):
            raise NoStackError(
                f"the link takes no {ODOMETRY} to the Earth, where so nobody knows where the rover is: "
                f"allowed is a link with {ODOMETRY} among its telemetry; or send a route instead"
            )

    def here(self) -> tuple[float, float]:
        end = time.monotonic() + (self._timeout_s if self._over_link else STOPPED_S)
        while self._ears.place is None and time.monotonic() < end and not self._client.stop.is_set:
            self._client.spin(0.05)
        if self._ears.place is None:
            if self._over_link:
                raise NoStackError(f"the link has not told within {self._timeout_s:g} s where the rover is")
            raise NoStackError(f"no running stack on {self._client.place}: nobody tells on /odom where the rover is")
        return self._ears.place

    def drive(self, route: Message) -> tuple[str, str]:
        who, name = GOALS["route"]
        self._client.send(who, name, route)
        return self._client.follow("route", self._timeout_s)

    def stands_before(self) -> str:
        told = self._client.link.telemetry if self._over_link else self._client.statuses
        status = told.get("drive")
        return "" if status is None else status_values(status).get("obstacle", "")

    def found(self) -> FloatArray:
        return self._ears.found.places
