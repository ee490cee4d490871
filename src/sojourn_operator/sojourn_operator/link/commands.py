"""Commands on their way to the machine, and what the Earth knows of each."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

from sojourn_contract.goal_topics import GOAL_TOPICS
from sojourn_contract.stamps import seconds
from sojourn_contract.values import DiagnosticArray, Message
from sojourn_operator.goal_messages import place_report_of, report_of, request_report_of
from sojourn_operator.steps.step import FINAL_STATES, REFUSED, GoalReport

QUEUED, SENT, RECEIVED, EXECUTED = "queued", "sent", "received", "executed"
EXPIRED, CANCELLED, DROPPED, SUPERSEDED = "expired", "cancelled", "dropped", "superseded"
UNDONE = (EXPIRED, CANCELLED, DROPPED)
"""States of a command that the machine never carries out."""
OVER = (EXECUTED, SUPERSEDED, *UNDONE)
"""States after which nothing more is heard of a command."""
KEPT = 64
"""Last commands that are remembered, and as many velocities; commands that may wait of one topic."""
VELOCITIES = tuple(row.name for row in GOAL_TOPICS if row.max_age_s < 1.0)
"""What is said many times a second, of which only the newest waits and none is acknowledged."""
FIRST = ("/arm/stop", *VELOCITIES)
"""What goes before all others: with it a machine is stopped."""
ROLE_OF = {row.name: row.subscribers[0] for row in GOAL_TOPICS}

_DRIVE = ("/drive/status", report_of, FINAL_STATES)
_ARM = ("/arm/status", report_of, FINAL_STATES)
ANSWERS: dict[str, tuple[str, Callable[[DiagnosticArray], GoalReport], tuple[str, ...]]] = {
    "/goal_pose": _DRIVE,
    "/waypoints": _DRIVE,
    "/initialpose": ("/drive/status", place_report_of, ("done", "refused")),
    "/arm/goal_pose": _ARM,
    "/arm/joint_goal": _ARM,
    "/arm/joint_trajectory": _ARM,
    "/arm/path": _ARM,
    "/arm/task": _ARM,
    "/power/request": ("/power/status", request_report_of, ("done", "waiting", "refused")),
}
"""Of each topic where its answer is told, how that is read, and with which states it is over."""
MOVES = tuple(name for name, answer in ANSWERS.items() if answer in (_DRIVE, _ARM))
"""Goals that set drive or arm in motion."""


class SentCommand(NamedTuple):
    """A command. Times are simulation time [ns], 0 for what has not happened, or is not known on Earth.

    Args:
        number: of the uplink. topic, stamp: as it was sent on Earth. queued, sent: when it came and had left.
        given: on the machine, the stamp with which its receiver has given it out; told: the same, once the Earth knows.
        settled: whether the machine has told its end.
        received, executed: when, as the machine has told. state: as far as the Earth knows. known: since when it does.
        outcome, reason: of who carried it out.
    """

    number: int
    topic: str
    stamp: int
    queued: int
    state: str = QUEUED
    known: int = 0
    sent: int = 0
    received: int = 0
    executed: int = 0
    outcome: str = ""
    reason: str = ""
    given: int = 0
    told: int = 0
    settled: bool = False

    @property
    def role(self) -> str:
        """That carries it out."""
        return ROLE_OF[self.topic]

    def values(self) -> dict[str, str]:
        """As a status says it."""
        times = {"queued": self.queued, "sent": self.sent, "received": self.received, "executed": self.executed}
        return {
            "topic": self.topic,
            "goal_stamp": str(self.stamp),
            "machine_stamp": str(self.told),
            "state": self.state,
            "known_s": f"{seconds(self.known):.2f}",
            **{f"{name}_s": f"{seconds(time):.2f}" if time else "" for name, time in times.items()},
            "outcome": self.outcome,
            "reason": self.reason,
        }


class MachineWord(NamedTuple):
    """What the machine tells of a command: its state since a time [ns], how it ended, and with which stamp it has been
    given out [ns].
    """

    number: int
    state: str
    at: int
    outcome: str = ""
    reason: str = ""
    given: int = 0


class TelemetrySample(NamedTuple):
    """A message of telemetry."""

    topic: str
    message: Message


def after_word(command: SentCommand, word: MachineWord, now: int) -> SentCommand:
    """A command of which the machine's word has reached the Earth at a time [ns]."""
    if command.state in OVER or (word.state == RECEIVED and command.state == RECEIVED):
        return command
    told = word.given or command.told
    found = command._replace(state=word.state, known=now, outcome=word.outcome, reason=word.reason, told=told)
    if word.state == RECEIVED:
        return found._replace(received=word.at)
    return found._replace(executed=word.at) if word.state == EXECUTED else found


def settled(command: SentCommand, statuses: Mapping[str, DiagnosticArray]) -> MachineWord | None:
    """The machine's last word on a command that it has been given, None as long as it goes on. statuses: by topic."""
    answer = ANSWERS.get(command.topic)
    status = None if answer is None else statuses.get(answer[0])
    if answer is None or status is None:
        return None
    _, read, ends = answer
    report = read(status)
    if report.goal_stamp > command.given and report.state != REFUSED:
        return MachineWord(
            command.number, SUPERSEDED, status.stamp, "", "another goal has taken its place", command.given
        )
    if report.goal_stamp == command.given and report.state in ends:
        return MachineWord(command.number, EXECUTED, status.stamp, report.state, report.reason, command.given)
    return None


def reports_on_earth(reports: Mapping[str, GoalReport], log: Iterable[SentCommand]) -> dict[str, GoalReport]:
    """What operators go by: the last reports of drive and arm that have been received, of each goal with the stamp that
    it had when it was sent; before them what is known of the last command of a role: its end, which is acknowledged
    before all telemetry, or that it never gets there.

    Args:
        reports: by role, with the stamps of the machine.
    """
    given = {(command.role, command.given): command.stamp for command in log if command.given}
    found = {
        role: replace(report, goal_stamp=given.get((role, report.goal_stamp), report.goal_stamp))
        for role, report in reports.items()
    }
    last = {command.role: command for command in log if command.topic not in VELOCITIES}
    for role, command in last.items():
        if command.state == EXECUTED and command.topic in MOVES:
            found[role] = GoalReport(command.outcome, command.stamp, command.reason)
        elif command.state in UNDONE:
            found[role] = GoalReport("failed", command.stamp, f"{command.state} on the way: {command.reason}")
    return found
