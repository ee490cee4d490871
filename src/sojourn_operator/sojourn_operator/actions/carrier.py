"""Carries the goals of one action through the contract: sent, watched, told of, stopped, ended."""

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from sojourn_config import command_line
from sojourn_config.command_errors import CommandError
from sojourn_contract.heartbeat import status_values
from sojourn_contract.values import Message
from sojourn_operator.actions.kind import LastHeard, Pursuit
from sojourn_operator.actions.server import GoalServer
from sojourn_operator.actions.watch import ABORTED, BREACH, CANCELED, REPLACED, UNSENT, Ending, GoalWatch
from sojourn_operator.clock_watch import QUIET_S
from sojourn_operator.goal_sending import GoalClient

BESIDE = "the run has a link to Earth, round which no action goes: send goals with scripts/goal"


class Carrier:
    """Of one action.

    Args:
        client: that sends and hears. server: of the action. messages: by topic, what has been heard last.
    """

    def __init__(self, client: GoalClient, server: GoalServer, messages: Mapping[str, Message]) -> None:
        self._client, self._server, self._messages = client, server, messages
        self._goal: Any = None
        self._pursuit: Pursuit | None = None
        self._watch: GoalWatch | None = None
        self._told: object = None
        self._told_at = 0.0

    def step(self) -> None:
        """Do what is to be done now. Where nothing can be sent, the goal ends."""
        try:
            self._look()
        except CommandError as error:
            self.drop(str(error))

    def _look(self) -> None:
        for goal in self._server.taken():
            self.drop(f"another goal of {self._server.name} has taken its place", REPLACED)
            try:
                self._begin(goal)
            except CommandError as error:  # of this one alone: those behind it have been taken, too
                self.drop(str(error))
        if self._watch is None or self._pursuit is None:
            return
        if self._goal.is_cancel_requested and self._watch.stop is None:
            self._watch = replace(self._watch, stop=self._client.send_stop(self._watch.role))
        self._follow(self._watch, self._pursuit)

    def drop(self, reason: str, cause: str = UNSENT) -> None:
        """End the goal, if there is one, as nobody follows it any more."""
        if self._pursuit is not None:
            self._end(self._pursuit, Ending(ABORTED, cause, reason))

    def _begin(self, goal: Any) -> None:
        kind = self._server.kind
        self._goal, pursuit = goal, kind.begin(goal.request)
        self._pursuit = pursuit
        if goal.is_cancel_requested:
            self._end(pursuit, Ending(CANCELED, UNSENT, "taken back before it was sent"))
            return
        if self._client.link.is_there:
            self.drop(BESIDE)
            return
        stamp = self._client.send(kind.role, kind.topic, pursuit.goal)
        command_line.say(f"{self._server.name}: sent on {kind.topic}")
        self._watch = GoalWatch(kind.role, stamp)
        self._told, self._told_at = self._client.statuses.get(kind.role), time.monotonic()

    def _follow(self, watch: GoalWatch, pursuit: Pursuit) -> None:
        status, told = self._client.statuses.get(watch.role), self._client.told(watch.role)
        report, stamp = (None, 0) if told is None else told
        self._watch, ending = watch.step(report, self._client.now, stamp)
        heard = LastHeard(
            self._client.now, watch.stamp, {} if status is None else status_values(status), self._messages
        )
        if status is not self._told:
            self._told, self._told_at = status, time.monotonic()
            if self._watch.is_known and ending is None:
                self._goal.publish_feedback(pursuit.feedback(heard))
        if ending is None and time.monotonic() > self._told_at + QUIET_S:
            ending = Ending(ABORTED, UNSENT, f"the {watch.role} says nothing any more, for {QUIET_S:g} s of wall time")
        if ending is None and watch.stop is None and (why := pursuit.breach(heard)):
            self._client.send_stop(watch.role)
            ending = Ending(ABORTED, BREACH, why)
        if ending is not None:
            self._end(pursuit, pursuit.final(ending, heard))

    def _end(self, pursuit: Pursuit, ending: Ending) -> None:
        goal, self._goal, self._pursuit, self._watch = self._goal, None, None, None
        words = ending.word + (f": {ending.reason}" if ending.reason else "")
        command_line.say(f"{self._server.name}: {words}")
        self._server.end(goal, ending, pursuit.result(ending))
