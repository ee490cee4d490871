"""Brings routes over a map to the rover of a running stack, and tells of it what planning needs."""

import time

from sojourn_contract.heartbeat import status_values
from sojourn_contract.values import Message
from sojourn_machine.params import FloatArray
from sojourn_operator.far_goal import RoverEars
from sojourn_operator.goal_sending import GOALS, STOPPED_S, GoalClient, NoStackError


class RouteClient:
    """A `Driver` of `far_goal`.

    Args:
        client: that sends routes. timeout_s: for each [s].
    """

    def __init__(self, client: GoalClient, timeout_s: float) -> None:
        self._client, self._timeout_s, self._ears = client, timeout_s, RoverEars(client)

    def here(self) -> tuple[float, float]:
        end = time.monotonic() + STOPPED_S
        while self._ears.place is None and time.monotonic() < end and not self._client.stop.is_set:
            self._client.spin(0.05)
        if self._ears.place is None:
            raise NoStackError(f"no running stack on {self._client.place}: nobody tells on /odom where the rover is")
        return self._ears.place

    def drive(self, route: Message) -> tuple[str, str]:
        who, name = GOALS["route"]
        self._client.send(who, name, route)
        return self._client.follow("route", self._timeout_s)

    def stands_before(self) -> str:
        status = self._client.statuses.get("drive")
        return "" if status is None else status_values(status).get("obstacle", "")

    def found(self) -> FloatArray:
        return self._ears.found.places
