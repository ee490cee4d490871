"""What an operator can do to a run, whoever the machine is: send a goal, stop, cancel, pause, go on.

A machine knows no pause of its drive: it is stopped, and the goal is sent again when it is to go on, without the points
that have been passed. The arm knows one.
"""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from sojourn_console.draft import Draft
from sojourn_console.errors import GoalError
from sojourn_console.feed import Mouth
from sojourn_console.model import BasePose, RunScene
from sojourn_contract.heartbeat import status_message
from sojourn_contract.values import TwistStamped
from sojourn_operator.goal_messages import QUESTION, stop_messages
from sojourn_operator.steps.step import REFUSED

PASSED = 0.6
"""A point of a route counts as passed within so much of it [m]."""
MOVING = "moving"
ROLES = ("drive", "arm")
"""That are stopped, in the order of `stop_messages`."""
MOST_EARLIER = 8
"""Ways that are remembered for one that is refused."""
STAMP_OF_NONE = "0"
"""Stamp of no goal, and of any that was sent without one."""


@dataclass(frozen=True)
class Sent:
    """What has been sent last for a role.

    Args:
        draft: the goal. stamp: of it [ns]. passed: points of its way that have been passed. is_paused: stopped, to go
            on. told: state of it that its role has told last, empty before the first.
    """

    draft: Draft
    stamp: int
    passed: int = 0
    is_paused: bool = False
    told: str = ""

    @property
    def status_topic(self) -> str:
        """On which its role tells of it."""
        return "/drive/status" if self.draft.is_way else "/arm/status"

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
        self._earlier: tuple[Sent, ...] = ()
        """Ways that were sent before it: one of them goes on where it is refused."""
        self._arm_is_paused = False
        self._told: dict[str, Mapping[str, str]] = {}
        """Last status of each role but those that refuse another goal: what was under way before that goes on."""

    def send(self, draft: Draft) -> int:
        """Send a goal. Returns its stamp [ns], by which its role reports on it. Raises GoalError."""
        stamp = self._mouth.now
        self._mouth.send(*draft.message(stamp))
        if draft.is_way:
            if self.driven is not None:
                self._earlier = (*self._earlier, self.driven)[-MOST_EARLIER:]
            self.driven = Sent(draft, stamp)
        return stamp

    def ask(self, draft: Draft) -> int:
        """Ask the drive what a goal would take. Returns the stamp of the question [ns]. Raises GoalError."""
        stamp = self._mouth.now
        self._mouth.send(QUESTION, draft.question(stamp))
        return stamp

    def stop(self) -> tuple[str, ...]:
        """Stop drive and arm, softly, as their own limits have it. Returns who hears it. Raises GoalError: nobody."""
        self._let_go()
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
        self._let_go()
        self._hear(scene)
        ended = []
        for role, (name, message) in zip(ROLES, stop_messages(0), strict=True):
            if role in sent or self._moves(role):
                self._mouth.send(name, message)
                ended.append(role)
        return f"goal of {' and '.join(ended)} cancelled" if ended else "there is no goal under way"

    def pause(self, scene: RunScene) -> str:
        """Come to rest, to go on. Returns what was paused, in words. Raises GoalError where the drive may move on."""
        self._hear(scene)
        self._take_back_refused()
        paused = []
        problem = self._unpaused()
        if self._moves("drive") and self.driven is not None and not problem:
            if not self.driven.is_paused:  # a second stop would be told as a new command
                self._mouth.send("/cmd_vel", TwistStamped(0, "base_link", np.zeros(3), np.zeros(3)))
            self.driven = replace(self.driven, is_paused=True)
            paused.append("drive")
        if self._moves("arm"):
            self._mouth.send("/arm/task", status_message(self._mouth.now, "pause", {}))
            self._arm_is_paused = True
            paused.append("arm")
        return _words(paused, "paused", problem) or "there is nothing under way"

    def resume(self, scene: RunScene) -> str:
        """Go on. Returns with what, in words. Raises GoalError where the drive was commanded otherwise since."""
        self._hear(scene)
        self._take_back_refused()
        going, problem = [], ""
        if self.driven is not None and self.driven.is_paused:
            if self.is_told_of(self.driven, self._told["drive"]):
                self.send(self.driven.rest())
                going.append("drive")
            else:
                problem = "it was commanded otherwise since it was paused: allowed is to send a goal"
        if self._arm_is_paused:
            self._arm_is_paused = False
            self._mouth.send("/arm/task", status_message(self._mouth.now, "resume", {}))
            going.append("arm")
        return _words(going, "goes on", problem) or "nothing is paused"

    def is_told_of(self, sent: Sent, status: Mapping[str, str]) -> bool:
        """Whether a status of its role tells of a goal that was sent from here."""
        stamp = self._mouth.machine_stamp(sent.draft.topic, sent.stamp)
        return stamp != STAMP_OF_NONE and status.get("goal_stamp") == stamp

    def forget(self) -> None:
        """Another run has begun: what was sent belongs to the one before."""
        self._let_go()
        self._told.clear()

    def look(self, scene: RunScene) -> None:
        """See what is told, and which points of the way have been passed."""
        self._hear(scene)
        if scene.pose is not None:
            self._change(partial(_further, pose=scene.pose))

    def _change(self, change: Callable[[Sent], Sent]) -> None:
        """Each way that was sent."""
        self.driven = None if self.driven is None else change(self.driven)
        self._earlier = tuple(change(one) for one in self._earlier)

    def _take_back_refused(self) -> None:
        """Where the way that was sent last is refused, that one of the earlier is driven of which the drive tells."""
        if self.driven is not None and self.driven.told == REFUSED:
            on = [one for one in self._earlier if self.is_told_of(one, self._told["drive"])]
            self.driven = on[-1] if on else self.driven

    def _let_go(self) -> None:
        """Nothing of what was sent is to be paused, or to go on."""
        self.driven, self._earlier = None, ()
        self._arm_is_paused = False

    def _hear(self, scene: RunScene) -> None:
        """What drive and arm tell, and what of that is about the way that was sent last."""
        for role in ROLES:
            status, before = scene.status(f"/{role}/status"), self._told.get(role)
            goal = status.get("goal_stamp", STAMP_OF_NONE)
            # refused after all, a goal is over that was accepted before
            is_same = before is not None and goal == before.get("goal_stamp") != STAMP_OF_NONE
            if before is None or is_same or status.get("state") != REFUSED:
                self._told[role] = status
        drive = scene.status("/drive/status")
        self._change(lambda sent: replace(sent, told=drive.get("state", "")) if self.is_told_of(sent, drive) else sent)

    def _moves(self, role: str) -> bool:
        return self._told[role].get("state") == MOVING

    def _unpaused(self) -> str:
        """Why a pause does not keep the drive from moving, in words; empty where it does."""
        sent = self.driven
        if sent is not None and not sent.told:
            return "it has not told yet of the goal that was sent last: allowed is STOP or Cancel"
        is_from_here = sent is not None and self.is_told_of(sent, self._told["drive"])
        if self._moves("drive") and not is_from_here:
            return "the goal under way is not the last that was sent from here: allowed is STOP or Cancel"
        return ""


def _further(sent: Sent, pose: BasePose) -> Sent:
    """A way with the point that is passed at a pose."""
    if sent.passed >= len(sent.draft.points):
        return sent
    x, y = sent.draft.points[sent.passed][:2]
    is_near = math.hypot(pose.position[0] - x, pose.position[1] - y) < PASSED
    return replace(sent, passed=sent.passed + 1) if is_near else sent


def _words(roles: Sequence[str], what: str, problem: str) -> str:
    """What roles do now, in words, empty without any. Raises GoalError with it and the problem of the drive."""
    done = f"{' and '.join(roles)} {what}" if roles else ""
    if problem:
        raise GoalError(f"{done}; drive" if done else "drive", problem)
    return done
