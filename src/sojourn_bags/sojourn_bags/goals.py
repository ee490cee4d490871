"""What became of each goal in a bag: how drive or arm said it ended, and how near the machine truly came.

A goal and a status belong together by the goal's stamp. For a goal without a stamp ("now") it is the first
final status about such a goal after it arrived. Velocities by hand have no end of their own; those that were refused
count as goals that were not met, once for as long as the same reason is given.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sojourn_bags.definitions import RUN_RECORD
from sojourn_bags.machine import TrueMachine
from sojourn_bags.onset import RESUMED
from sojourn_bags.reading import Bag
from sojourn_contract.stamps import NANOSECONDS

DRIVE_TOPICS = ("/goal_pose", "/waypoints")
ARM_TOPICS = ("/arm/goal_pose", "/arm/joint_goal", "/arm/joint_trajectory", "/arm/path", "/arm/task")
VELOCITIES = {"/cmd_vel": "/drive/status", "/arm/cmd_vel": "/arm/status"}
STATUS_OF = {**dict.fromkeys(DRIVE_TOPICS, "/drive/status"), **dict.fromkeys(ARM_TOPICS, "/arm/status")}
STATUS_TEXTS = ("state", "goal_stamp", "reason")
"""What is read of a status."""
REACHED, UNDER_WAY = "reached", "moving"
FINAL_STATES = (REACHED, "refused", "stopped", "failed")
REPLACED, UNFINISHED = "replaced by the next goal", "not finished"


@dataclass(frozen=True)
class Limits:
    """How near counts as met, by the truth: drive [m], arm [m]."""

    drive_m: float
    arm_m: float


@dataclass(frozen=True)
class SentGoal:
    """A goal as sent.

    Args:
        topic: where. stamp: of its header [ns], 0 for "now". effect_s: when it took effect [s].
        what: in words. frame, target: the place it names [m], None for joint goals.
    """

    topic: str
    stamp: int
    effect_s: float
    what: str
    frame: str = ""
    target: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class GoalResult:
    """What became of a goal.

    Args:
        goal: as sent. outcome: reached, refused, stopped, failed, or why there is none. reason: as the status
            gives it.
        end_s: when it ended [s]. error_m: true distance from the target at the end, None for joint goals.
            met: verdict.
    """

    goal: SentGoal
    outcome: str
    reason: str
    end_s: float
    error_m: float | None
    met: bool

    def as_data(self) -> dict[str, object]:
        """For the summary."""
        return {
            "goal": self.goal.what,
            "topic": self.goal.topic,
            "outcome": self.outcome,
            "reason": self.reason,
            "met": self.met,
            "error_m": self.error_m,
            "start_s": self.goal.effect_s,
            "end_s": self.end_s,
        }


@dataclass(frozen=True)
class _Status:
    time_s: float
    state: str
    goal_stamp: int
    reason: str


def judge_goals(bag: Bag, machine: TrueMachine | None, tip_link: str, limits: Limits, end_s: float) -> list[GoalResult]:
    """Results of all goals of a bag, in the order in which they took effect.

    Args:
        machine: the true machine, None where the bag holds no truth: then no place counts as met.
        tip_link: link that the arm's goals are about. end_s: last simulation time of the bag [s].
    """
    goals = sorted([*goals_of_before(bag), *sent_goals(bag)], key=lambda goal: goal.effect_s)
    statuses = {topic: _statuses(bag, topic) for topic in set(STATUS_OF.values())}
    results = []
    for number, goal in enumerate(goals):
        following = [later for later in goals[number + 1 :] if STATUS_OF[later.topic] == STATUS_OF[goal.topic]]
        until = following[0].effect_s if following else None
        outcome, reason, ended_s = _outcome(goal, statuses[STATUS_OF[goal.topic]], until, end_s)
        error = _error(goal, machine, tip_link, ended_s)
        limit = limits.drive_m if goal.topic in DRIVE_TOPICS else limits.arm_m
        near = goal.target is None or (error is not None and error <= limit)
        results.append(GoalResult(goal, outcome, reason, ended_s, error, outcome == REACHED and near))
    return sorted([*results, *refused_velocities(bag)], key=lambda result: result.goal.effect_s)


def refused_velocities(bag: Bag) -> list[GoalResult]:
    """Drives and jogs by hand that were refused."""
    found = []
    for topic, name in VELOCITIES.items():
        if topic not in bag:
            continue
        when = dict(zip(_stamps(bag, topic), bag[topic].log_times, strict=True))
        told = ""
        for status in _statuses(bag, name):
            sent = when.get(status.goal_stamp) if status.state == "refused" else None
            if sent is not None and status.reason != told:
                goal = SentGoal(topic, status.goal_stamp, sent / NANOSECONDS, f"{name.split('/')[1]} by hand")
                found.append(GoalResult(goal, status.state, status.reason, status.time_s, None, met=False))
            told = status.reason if sent is not None else ""
    return found


def sent_goals(bag: Bag) -> list[SentGoal]:
    """Goals of a bag, in the order in which they took effect."""
    goals = []
    for topic in STATUS_OF:
        if topic not in bag:
            continue
        for index, log_time in enumerate(bag[topic].log_times):
            message = bag[topic].decode(index)
            stamp = message.header.stamp.sec * NANOSECONDS + message.header.stamp.nanosec
            frame = message.header.frame_id
            what, target = _describe(topic, message)
            if topic == "/waypoints" and message.poses and message.poses[-1].header.frame_id:
                frame = message.poses[-1].header.frame_id
            goals.append(SentGoal(topic, stamp, log_time / NANOSECONDS, what, frame, target))
    return sorted(goals, key=lambda goal: goal.effect_s)


def goals_of_before(bag: Bag) -> list[SentGoal]:
    """Goals that were under way where a record begins within its run, by what drive and arm said first of them. Where
    the drive's leads is the last pose of its first plan; of the arm's nothing is known but what it says.
    """
    if RESUMED not in bag.records.get(RUN_RECORD, {}):
        return []
    found = []
    for name, topics in (("/drive/status", DRIVE_TOPICS), ("/arm/status", ARM_TOPICS)):
        first = next(iter(_statuses(bag, name)), None)
        sent = {stamp for topic in topics if topic in bag for stamp in _stamps(bag, topic)}
        if first is None or first.state != UNDER_WAY or first.goal_stamp in sent:
            continue
        target = _end_of_plan(bag) if topics is DRIVE_TOPICS else None
        where = "" if target is None else f" to ({target[0]:.2f}, {target[1]:.2f})"
        what = f"{name.split('/')[1]}{where}, asked for before this record"
        found.append(SentGoal(topics[0], first.goal_stamp, first.time_s, what, "odom", target))
    return found


def _end_of_plan(bag: Bag) -> tuple[float, float, float] | None:
    """Last place of the first plan that has any, in odom [m]."""
    plans = (bag["/plan"].decode(index) for index in range(len(bag["/plan"].data))) if "/plan" in bag else ()
    first = next((plan for plan in plans if plan.poses), None)
    return None if first is None else _describe("/waypoints", first)[1]


def missing_steps(step_topics: Sequence[str], goals: Sequence[SentGoal]) -> int:
    """How many steps of a scenario have not been sent. step_topics: on which each is sent; others than of goals have
    nobody who tells what became of them."""
    sent = Counter(goal.topic for goal in goals)
    wanted = Counter(topic for topic in step_topics if topic in STATUS_OF)
    return (wanted - sent).total()


def _describe(topic, message) -> tuple[str, tuple[float, float, float] | None]:
    """A goal in words, and the place it names."""
    if topic == "/arm/joint_goal":
        return (f"arm: {message.header.frame_id}" if not message.name else "arm to joint positions"), None
    if topic == "/arm/task":
        names = [status.name for status in message.status]
        numbers = [f"{pair.key}={pair.value}" for status in message.status for pair in status.values]
        return " ".join((f"arm: {', '.join(names)}", *numbers)), None
    if topic == "/arm/joint_trajectory":
        return f"arm along {len(message.points)} joint positions", None
    along = topic in ("/waypoints", "/arm/path")
    if along and not message.poses:
        return f"{'drive' if topic == '/waypoints' else 'arm'} along no points", None
    position = (message.poses[-1].pose if along else message.pose).position
    target = (float(position.x), float(position.y), float(position.z))
    if topic == "/arm/goal_pose":
        return f"arm to ({target[0]:.3f}, {target[1]:.3f}, {target[2]:.3f})", target
    if topic == "/arm/path":
        return f"arm along {len(message.poses)} points to ({target[0]:.3f}, {target[1]:.3f}, {target[2]:.3f})", target
    way = f" along {len(message.poses)} points" if along else ""
    return f"drive{way} to ({target[0]:.2f}, {target[1]:.2f})", target


def _stamps(bag: Bag, topic: str) -> list[int]:
    """Of the headers [ns]."""
    messages = bag[topic]
    parts = zip(messages.column("header.stamp.sec"), messages.column("header.stamp.nanosec"), strict=True)
    return [int(sec) * NANOSECONDS + int(nanosec) for sec, nanosec in parts]


def _statuses(bag: Bag, topic: str) -> list[_Status]:
    if topic not in bag:
        return []
    messages = bag[topic]
    found = []
    for time_s, values in zip(messages.times, messages.statuses(), strict=True):
        found.append(_Status(float(time_s), values.get("state", ""), _integer(values), values.get("reason", "")))
    return found


def _integer(values: Mapping[str, str]) -> int:
    text = values.get("goal_stamp", "0")
    return int(text) if text.lstrip("-").isdigit() else 0


def _outcome(goal: SentGoal, statuses: list[_Status], until: float | None, end_s: float) -> tuple[str, str, float]:
    """Outcome, reason and time of the end."""
    for status in statuses:
        if goal.stamp == 0 and until is not None and status.time_s >= until:
            break
        if status.time_s >= goal.effect_s and status.goal_stamp == goal.stamp and status.state in FINAL_STATES:
            return status.state, status.reason, status.time_s
    return (UNFINISHED, "", end_s) if until is None else (REPLACED, "", until)


def _error(goal: SentGoal, machine: TrueMachine | None, tip_link: str, end_s: float) -> float | None:
    """True distance from the target at the end: on the plane for a drive, in space for the arm."""
    if goal.target is None or machine is None:
        return None
    try:
        target = machine.point_in_map(goal.frame, np.array(goal.target), goal.effect_s)
    except ValueError:
        return None  # a goal in an unknown frame has been refused
    if goal.topic in DRIVE_TOPICS:
        return float(np.hypot(*(machine.pose_at(end_s)[:2] - target[:2])))
    return float(np.linalg.norm(machine.link_in_map(tip_link, end_s) - target))
