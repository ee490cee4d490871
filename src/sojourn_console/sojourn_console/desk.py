"""What an operator can do to a run, whoever the machine is: send a goal, stop, cancel, pause, go on.

A machine knows no pause of its drive: it is stopped, and the goal is sent again when it is to go on, without the points
that have been passed. The arm knows one.
"""

import math
from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from sojourn_console.draft import Draft
from sojourn_console.errors import GoalError
from sojourn_console.feed import Mouth
from sojourn_console.model import RunScene
from sojourn_contract.heartbeat import status_message
from sojourn_contract.values import TwistStamped
from sojourn_operator.goal_messages import QUESTION, stop_messages

PASSED = 0.6
"""A point of a route counts as passed within so much of it [m]."""
MOVING = "moving"
ROLES = ("drive", "arm")
"""That are stopped, in the order of `stop_messages`."""


@dataclass(frozen=True)
class Sent:
    """What has been sent last for a role.

    Args:
        draft: the goal. stamp: of it [ns]. passed: points of its way that have been passed. is_paused: stopped, to go
            on.
    """

    draft: Draft
    stamp: int
    passed: int = 0
    is_paused: bool = False

    def rest(self) -> Draft:
        """The goal without what has been passed; its last point stays."""
        return replace(self.draft, points=self.draft.points[min(self.passed, len(self.draft.points) - 1) :])


class CommandDesk:
    """Of one run.

    Args:
        mouth: to the run.
    """

    def __init__(self, mouth: Mouth) -> None:
        self._mouth = mouth
        self.driven: Sent | None = None
        self._arm_is_paused = False

    def send(self, draft: Draft) -> int:
        """Send a goal. Returns its stamp [ns], by which its role reports on it. Raises GoalError."""
        stamp = self._mouth.now
        self._mouth.send(*draft.message(stamp))
        if draft.is_way:
            self.driven = Sent(draft, stamp)
        return stamp

    def ask(self, draft: Draft) -> int:
        """Ask the drive what a goal would take. Returns the stamp of the question [ns]. Raises GoalError."""
        stamp = self._mouth.now
        self._mouth.send(QUESTION, draft.question(stamp))
        return stamp

    def stop(self) -> tuple[str, ...]:
        """Stop drive and arm, softly, as their own limits have it. Returns who hears it. Raises GoalError: nobody."""
        self.driven, self._arm_is_paused = None, False
        problems, told = list[GoalError](), list[str]()
        for role, (name, message) in zip(ROLES, stop_messages(0), strict=True):  # without a stamp: never too old
            try:
                self._mouth.send(name, message)
                told.append(role)
            except GoalError as error:
                problems.append(error)
        if not told:
            raise problems[0]
        return tuple(told)

    def cancel(self, scene: RunScene, sent: Collection[str] = ()) -> str:
        """End the goal that is under way. Returns what was ended, in words. Raises GoalError.

        Args:
            sent: roles to which a goal is on its way.
        """
        self.driven, self._arm_is_paused = None, False
        ended = []
        for role, (name, message) in zip(ROLES, stop_messages(0), strict=True):
            if role in sent or scene.status(f"/{role}/status").get("state") == MOVING:
                self._mouth.send(name, message)
                ended.append(role)
        return f"goal of {' and '.join(ended)} cancelled" if ended else "there is no goal under way"

    def pause(self, scene: RunScene) -> str:
        """Come to rest, to go on. Returns what was paused, in words. Raises GoalError."""
        paused = []
        if scene.status("/drive/status").get("state") == MOVING and self.driven is not None:
            self._mouth.send("/cmd_vel", TwistStamped(0, "base_link", np.zeros(3), np.zeros(3)))
            self.driven = replace(self.driven, is_paused=True)
            paused.append("drive")
        if scene.status("/arm/status").get("state") == MOVING:
            self._mouth.send("/arm/task", status_message(self._mouth.now, "pause", {}))
            self._arm_is_paused = True
            paused.append("arm")
        if paused:
            return f"{' and '.join(paused)} paused"
        return "there is nothing under way that was sent from here"

    def resume(self) -> str:
        """Go on. Returns with what, in words. Raises GoalError."""
        going = []
        if self.driven is not None and self.driven.is_paused:
            self.send(self.driven.rest())
            going.append("drive")
        if self._arm_is_paused:
            self._arm_is_paused = False
            self._mouth.send("/arm/task", status_message(self._mouth.now, "resume", {}))
            going.append("arm")
        return f"{' and '.join(going)} goes on" if going else "nothing is paused"

    def forget(self) -> None:
        """Another run has begun: what was sent belongs to the one before."""
        self.driven, self._arm_is_paused = None, False

    def look(self, scene: RunScene) -> None:
        """See which points of the way have been passed."""
        sent = self.driven
        if sent is None or scene.pose is None or sent.passed >= len(sent.draft.points):
            return
        x, y = sent.draft.points[sent.passed][:2]
        if math.hypot(scene.pose.position[0] - x, scene.pose.position[1] - y) < PASSED:
            self.driven = replace(sent, passed=sent.passed + 1)
