"""Sends a goal and follows it: for scripts/goal."""

import time
from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any, Self

from sojourn_config import command_line
from sojourn_config.command_errors import CommandError
from sojourn_config.role_holder import held_roles
from sojourn_contract.codecs import encode
from sojourn_contract.goal_topics import FAULTS_TOPIC
from sojourn_contract.heartbeat import Heartbeat, read_heartbeats, status_values
from sojourn_contract.link_topics import CANCEL, COMMANDS, on_earth
from sojourn_contract.stamps import NANOSECONDS, seconds
from sojourn_contract.topic_table import CLOCK
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import ROLES, topic
from sojourn_contract.values import Clock, DiagnosticArray, Header, Message
from sojourn_operator.actions.watch import SILENT, GoalWatch
from sojourn_operator.clock_watch import ClockWatch
from sojourn_operator.desk import Desk
from sojourn_operator.goal_messages import (
    QUESTION,
    place_report_of,
    report_of,
    request_report_of,
    stamped,
    stop_messages,
)
from sojourn_operator.goal_progress import number, to_go
from sojourn_operator.link.commands import ANSWERS, CANCELLED, OVER, RECEIVED
from sojourn_operator.link.view import CommandLines, LinkView
from sojourn_operator.listeners import Listeners
from sojourn_operator.report_queue import ReportQueue, ToldReport
from sojourn_operator.start_watch import StartWatch

ANSWER_S = 5.0
"""Wall time within which a running stack must be found."""
SHOW_S = 1.0
STATUS_TOPICS = {"drive": "/drive/status", "arm": "/arm/status", "power": "/power/status"}
GOALS = {
    "drive": ("drive", "/goal_pose"),
    "route": ("drive", "/waypoints"),
    "arm": ("arm", "/arm/goal_pose"),
    "task": ("arm", "/arm/task"),
    "power": ("power", "/power/request"),
    "here": ("drive", "/initialpose"),
    "fault": ("plant or sensors", FAULTS_TOPIC),
}
"""Of each command who carries it out, and on which topic it goes."""
PAUSE = "pause"
STOP_TOPICS = {"drive": "/cmd_vel", "arm": "/arm/stop"}
DONE = "done"
ENDS = {"power": (DONE, "waiting", "refused"), "here": (DONE, "refused")}
"""States in which there is nothing to wait for; of goals FINAL_STATES. A load that waits comes back by itself."""
REPORTS = {"power": request_report_of, "here": place_report_of}
"""How the answer to a command is read in a status; `report_of` for all others."""
NOT_KNOWN = "not known"
BY_VELOCITY = "cmd_vel"
"""Mode of a drive that follows velocities."""
STANDING_M_S = 0.01
"""Slower than that the rover stands."""
STOP_SETTLE_S = 0.2
STOPPED_S = 10.0
"""Wall time within which drive and arm must say that they stand; their statuses come once a simulated second."""
TOLD_NS = 3_000_000_000
"""Simulation time within which two statuses tell of a stop, the first of which may be of before it came."""
INTERRUPTED = 130


class NoStackError(CommandError):
    """Nobody answers."""


class TwoClocksError(CommandError):
    """More than one node tells the simulation time."""


class GoalClient(Desk):
    """Talks to a running stack. A context manager.

    Args:
        domain, namespace: where the stack is. name: of its node.
    """

    def __init__(self, domain: int, namespace: str, name: str = "goal") -> None:
        super().__init__(name, domain, namespace)
        self.now = 0
        """Simulation time [ns]; zero until a stamped status has come."""
        self.statuses: dict[str, DiagnosticArray] = {}
        self._reports: dict[str, ReportQueue] = {}
        self.over_link = False
        """Whether what has just been sent goes over a link to Earth."""
        self.beats: dict[str, Heartbeat] = {}
        """Last heartbeat of each role."""
        self._start = StartWatch(self._held)
        self._last_stamp = 0
        self._pauses = False
        """Whether what has just been sent is a pause, during which progress is not of what was paused."""

    def __enter__(self) -> Self:
        super().__enter__()
        self._clock = self.listen(topic(CLOCK), self._on_clock, lockstep=False)
        self._readers = [self.listen(topic(name), self._keep(who)) for who, name in STATUS_TOPICS.items()]
        self._readers.append(self.listen(topic("/diagnostics"), self._hear))
        self.link = LinkView(self, STATUS_TOPICS)
        return self

    def send(self, who: str, name: str, message: Message) -> int:
        """Publish a goal on a topic once its role listens, over the link where the run has one. Its stamp [ns].

        Raises NoStackError if nobody listens within ANSWER_S, TwoClocksError if somebody else tells the time, too.
        """
        row, sender = topic(name), self.sender_to(who, topic(name))
        self.over_link = self.has_link() and name in COMMANDS
        if self.over_link:
            row = on_earth(row)
            sender = self.sender_to("the link to Earth", row)
        sender.publish(encode(row, stamped(message, self.now)))
        self._last_stamp = self.now
        self._pauses = isinstance(message, DiagnosticArray) and [one.name for one in message.status] == [PAUSE]
        return self._last_stamp

    def send_stop(self, who: str) -> int:
        """Publish the stop of a role once it listens, as `halt` does: without a stamp. The simulation time then [ns].

        Raises NoStackError if it does not listen within ANSWER_S.
        """
        row = topic(STOP_TOPICS[who])
        self._sender_to_listener(who, row).publish(encode(row, dict(stop_messages(0))[row.name]))
        return self.now

    def cancel(self, number: str) -> list[str]:
        """Take back a command, or all where no number is said; those that are. Raises NoStackError, CommandError."""
        row = CANCEL
        self.sender_to("drive", topic("/goal_pose"))
        if not self.has_link():
            raise CommandError("the run has no link to Earth, and a goal no way on which it could be taken back")
        self.sender_to("the link to Earth", row).publish(encode(row, Header(self.now, number)))
        end = time.monotonic() + STOPPED_S
        before = self.now
        while time.monotonic() < end and not self.stop.is_set and self.now < before + 2 * NANOSECONDS:
            self.spin(0.05)
        gone = [one for one, values in self.link.commands() if values.get("state") == CANCELLED]
        return [one for one in gone if number in ("", one)]

    def has_link(self) -> bool:
        """Whether the run has a link to Earth."""
        self.spin(STOP_SETTLE_S)  # whoever has not been found by now does not take part
        return self.link.is_there

    def sender_to(self, who: str, row: Topic) -> Any:
        """Publisher of a row, once its role listens. Raises NoStackError if it does not in ANSWER_S, TwoClocksError."""
        sender = self._sender_to_listener(who, row)
        self.spin(STOP_SETTLE_S)  # whoever else tells the time is found a little later than the first
        self._refuse_two_clocks()
        return sender

    def _sender_to_listener(self, who: str, row: Topic) -> Any:
        """As `sender_to`, whoever tells the time."""
        sender = self.sender(row)
        is_there = self._await(lambda: bool(self._is_heard(sender) and self.now))
        if not is_there and not (self._listeners(sender).somebody_acts and self.now):
            what = "its simulation time does not run" if self._is_heard(sender) else f"nobody acts on {row.name}"
            raise NoStackError(self._nobody(who, what))
        return sender

    def _refuse_two_clocks(self) -> None:
        clocks = self.node.count_publishers(self._clock.topic_name)
        if clocks > 1:
            raise TwoClocksError(
                f"{clocks} nodes publish {CLOCK} on {self.place}: what the simulation time is nobody can tell, and no "
                "command is sent (scripts/goal stop needs none)"
            )

    def halt(self) -> tuple[bool, str]:
        """Stop whoever listens, drive and arm, and wait until their statuses say that they stand.

        A stop carries no stamp: it is never too old, and needs no clock. Raises NoStackError if nobody listens within
        ANSWER_S. Returns whether they stand, and in words what they say.
        """
        messages = stop_messages(0)
        rows = {name: topic(name) for name, _ in messages}
        senders = {name: self.sender(row) for name, row in rows.items()}
        if not self._await(lambda: any(self._listeners(sender).somebody_acts for sender in senders.values())):
            raise NoStackError(self._nobody("drive or arm", f"nobody acts on {' or '.join(senders)}"))
        if self.has_link():
            rows = {name: on_earth(row) for name, row in rows.items()}
            senders = {name: self._sender_to_listener("the link to Earth", row) for name, row in rows.items()}
            for name, message in messages:
                senders[name].publish(encode(rows[name], message))
            return self._stopped_over_link()
        return self._halted(senders)

    def _halted(self, senders: Mapping[str, Any]) -> tuple[bool, str]:
        """Stop each as soon as it listens: who has not been found yet is not left out.

        Args:
            senders: of the stop messages, by topic.
        """
        messages, told, begin = dict(stop_messages(0)), set[str](), time.monotonic()
        modes = dict[str, str]()
        for _ in self._while_stopping():
            for who, name in STOP_TOPICS.items():
                heard = self._listeners(senders[name])
                is_found = heard.are_all_there or (heard.somebody_acts and time.monotonic() > begin + ANSWER_S)
                # Again where it has told since that it does not stand: its own zero moves a drive by velocity, too.
                if (who in self.statuses and not self._stands(who)) if who in told else is_found:
                    self.statuses.pop(who, None)
                    senders[name].publish(encode(topic(name), messages[name]))
                    told.add(who)
            self.spin(0.05)
            asked = self._asked_to_stop(told)
            if asked and all(who in told and self._stands(who) for who in asked):
                return True, ", ".join(f"{who}: {report_of(self.statuses[who]).state}" for who in asked)
            for who in told & self.statuses.keys():
                modes[who] = status_values(self.statuses[who]).get("mode", "")
        asked = self._asked_to_stop(told)
        silent = [who for who in asked if who not in told]
        if silent:
            return False, f"stop not heard by {' and '.join(silent)} within {STOPPED_S:g} s"
        if modes.get("drive") == BY_VELOCITY:
            return False, "stop sent, but the drive goes on by velocities: somebody else sends them on /cmd_vel"
        moving = " and ".join(who for who in asked if not self._stands(who))
        return False, f"stop sent, but {moving} did not say within {STOPPED_S:g} s that it stands"

    def _while_stopping(self) -> Iterator[None]:
        """For STOPPED_S of wall time, and of a slow stack for as long as its statuses take to tell of a stop."""
        begin, now, clock = time.monotonic(), self.now, ClockWatch(self.now)
        while not self.stop.is_set:
            is_slow = 0 < self.now < now + TOLD_NS and not clock.look(self.now)
            if time.monotonic() > begin + STOPPED_S and not is_slow:
                return
            yield

    def _asked_to_stop(self, told: Collection[str]) -> list[str]:
        """Those who have been told, and those who take part: their hearts beat, or a process here holds their role."""
        part = {*told, *self.beats, *self._held()}
        return [who for who in STOP_TOPICS if who in part]

    def _stopped_over_link(self) -> tuple[bool, str]:
        """That a stop is on its way is all that can be said now: what comes of it is known two light times later."""
        state = self.link.state
        words = (
            f"the stop is on its way: window {state.get('window', '?')}, light takes {state.get('light_time_s', '?')} s"
        )
        return True, words

    def _stands(self, who: str) -> bool:
        status = self.statuses.get(who)
        if status is None or report_of(status).state == "moving":
            return False
        values = status_values(status)
        return abs(number(values.get("speed_m_s", ""))) < STANDING_M_S and values.get("mode") != BY_VELOCITY

    def told(self, who: str) -> ToldReport | None:
        """What a role tells of its goals now; of several that are over one a look. None before the first word."""
        reports = self._reports.get(who)
        return None if reports is None else reports.look()

    def follow(self, command: str, timeout_s: float) -> tuple[str, str]:
        """Show the progress of the goal just sent until it ends. Returns outcome and reason."""
        who, name = GOALS[command]
        if self.over_link:
            return self._follow_over_link(name, timeout_s)
        if command in ENDS:
            return self._follow_request(command, timeout_s)
        watch, begin = GoalWatch(who, self._last_stamp), time.monotonic()
        said_at = begin
        for gone in self._looks(timeout_s):
            if gone:
                return NOT_KNOWN, gone
            told = self.told(who)
            report, stamp = (None, 0) if told is None else told
            watch, ending = watch.step(report, self.now, stamp)
            if ending is not None and (ending.cause != SILENT or time.monotonic() > begin + ANSWER_S):
                return NOT_KNOWN if ending.cause == SILENT else ending.cause, ending.reason
            last = self.statuses.get(who)
            if last is not None and watch.is_known and time.monotonic() > said_at + SHOW_S:
                said_at = time.monotonic()
                left = "coming to rest" if self._pauses else to_go(who, status_values(last))
                command_line.say(f"{seconds(self.now):9.2f} s  {report_of(last).state}, {left}")
        return self._not_finished("goal", timeout_s)

    def _follow_request(self, command: str, timeout_s: float) -> tuple[str, str]:
        """As `follow`, of what is answered at once, in fields of its own."""
        who, _ = GOALS[command]
        for gone in self._looks(timeout_s):
            if gone:
                return NOT_KNOWN, gone
            status = self.statuses.get(who)
            if status is None:
                continue
            report = REPORTS[command](status)
            if report.goal_stamp == self._last_stamp and report.state in ENDS[command]:
                return report.state, report.reason
        return self._not_finished("request", timeout_s)

    def _not_finished(self, what: str, timeout_s: float) -> tuple[str, str]:
        if self.stop.is_set:
            return "interrupted", f"the {what} goes on: stop it with scripts/goal stop"
        return "not finished", f"within {timeout_s:g} s of wall time; the {what} goes on"

    def _follow_over_link(self, name: str, timeout_s: float) -> tuple[str, str]:
        """As `follow`, by what the Earth knows."""
        lines = CommandLines()
        for gone in self._looks(timeout_s):
            if gone:
                return NOT_KNOWN, gone
            values = self.link.command(name, self._last_stamp)
            for line in lines.new(values, self.link.state):
                command_line.say(line)
            if values.get("state") in OVER or (values.get("state") == RECEIVED and name not in ANSWERS):
                return values["outcome"] or values["state"], values["reason"]
        if self.stop.is_set:
            return "interrupted", "the command goes on: take it back with scripts/goal cancel, or stop it"
        return "not finished", f"within {timeout_s:g} s of wall time; the command goes on"

    def answer(self, timeout_s: float) -> dict[str, str] | None:
        """The drive's answer to the question just sent, fields of its status; None if none comes in that time."""
        for gone in self._looks(timeout_s):
            if gone:
                raise NoStackError(gone)
            heard, stamp = self.statuses, str(self._last_stamp)
            if self.over_link:
                heard = self.link.telemetry
                stamp = self.link.command(QUESTION, self._last_stamp).get("machine_stamp", "")
            values = status_values(heard["drive"]) if "drive" in heard else {}
            if values.get("asked_stamp") == stamp:
                return values
        return None

    def hear_from(self, role: str) -> None:
        """Wait for a heartbeat of a role, STOPPED_S at most: they come once a simulated second."""
        end = time.monotonic() + STOPPED_S
        while role not in self.beats and time.monotonic() < end and not self.stop.is_set:
            self.spin(0.05)

    def watch(self, role: str, answer: Callable[[], tuple[str, str] | None], timeout_s: float) -> tuple[str, str]:
        """What a role makes of what was just sent, and why. answer: None as long as that is not known."""
        for gone in self._looks(timeout_s):
            if gone:
                return NOT_KNOWN, gone
            told = answer()
            if told is not None:
                return told
        return NOT_KNOWN, f"{role} has not said so within {timeout_s:g} s of wall time"

    def _hear(self, message: DiagnosticArray) -> None:
        self._start.hear(message)
        self.beats |= {beat.role: beat for beat in read_heartbeats(message)}

    def _held(self) -> list[str]:
        return held_roles(self.domain, self.namespace, ROLES)

    def _looks(self, timeout_s: float) -> Iterator[str]:
        """Looks at what has come, for so long [s] at most; each with why nothing more will come, empty while it may."""
        clock, end = ClockWatch(self.now), time.monotonic() + timeout_s
        while not self.stop.is_set and time.monotonic() < end:
            self.spin(0.05)
            yield clock.look(self.now)

    def _listeners(self, sender: Any) -> Listeners:
        return Listeners(self._node, sender)

    def _is_heard(self, sender: Any) -> bool:
        """Whether somebody who acts on it gets what is sent, and all others who can have it."""
        return self._listeners(sender).are_all_there

    def _await(self, is_there: Callable[[], bool]) -> bool:
        """Wait for a stack until it is there, ANSWER_S at most, or for so long as it is starting."""
        end = time.monotonic() + ANSWER_S
        while not is_there():
            if self._start.is_starting():
                end = time.monotonic() + ANSWER_S
            if time.monotonic() > end:
                return False
            if self.stop.is_set:
                raise KeyboardInterrupt
            self.spin(0.05)
        return True

    def _nobody(self, who: str, what: str) -> str:
        return f"no running stack for {who} on {self.place}: {what} (start one with scripts/start.py)"

    def _keep(self, who: str) -> Callable[[DiagnosticArray], None]:
        def keep(message: DiagnosticArray) -> None:
            self._reports.setdefault(who, ReportQueue()).hear(message)  # which refuses what is no report
            self.statuses[who] = message

        return keep

    def _on_clock(self, message: Clock) -> None:
        self.now = message.stamp
