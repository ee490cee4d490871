"""The judge: takes messages one by one, from a bag, a live domain or a candidate on the bench, and reports.

    judge = Judge(machine, lockstep=True, participants=ROLES)
    for topic, message, logged in source:
        judge.take(topic, message, logged)
    report = judge.finish()

Messages may be objects of rclpy or of a type store: only their attributes count.
"""

from array import array
from collections.abc import Collection
from typing import Any

from sojourn_contract import stamps
from sojourn_contract.barrier import awaited_inputs
from sojourn_contract.conformance import heartbeats
from sojourn_contract.conformance.answers import missing_answers
from sojourn_contract.conformance.clouds import CloudRule
from sojourn_contract.conformance.consistency import RateRule
from sojourn_contract.conformance.endpoints import Endpoint, endpoint_findings
from sojourn_contract.conformance.findings import Report
from sojourn_contract.conformance.frames import FrameRule
from sojourn_contract.conformance.geometry import CovarianceRule, OrientationRule
from sojourn_contract.conformance.grids import GridRule
from sojourn_contract.conformance.joints import JointLimitRule, JointRule
from sojourn_contract.conformance.machine import JudgedMachine
from sojourn_contract.conformance.numbers import NumberRule
from sojourn_contract.conformance.observation import Observation, Rule
from sojourn_contract.conformance.rates import rate_findings
from sojourn_contract.conformance.ros_reading import diagnostics_of, stamp_of
from sojourn_contract.conformance.stamp_rules import StampRule
from sojourn_contract.conformance.texts import GoalStatusRule, LoadRule, RequestRule, SwitchRule, TickRule
from sojourn_contract.heartbeat import RUNNING, Heartbeat, read_heartbeats
from sojourn_contract.leaps import NO_LEAPS, Leaps, leaps_of
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import ROLES

CLOCK = "/clock"
PLACE, ODOMETRY = "/initialpose", "/odom"
"""After an operator's word where the rover is, the drive's estimate is there at once."""
LONGEST_JUMP_NS = 60 * stamps.NANOSECONDS
"""Of /clock from one message to the next that is believed at once, where it does not leap farther."""
_STAMP, _JOINT_STATE = "stamp", "sensor_msgs/JointState"


class Judge:
    """Judges the messages of one run.

    Args:
        machine: the rover. lockstep: mode of time. participants: roles of the run.
        roles: those whose messages are judged; the others' are only listened to. None for all.
        unseen: topics that the source does not hold, so that nobody can be blamed for their absence.
        from_start: whether the source holds the run from its first period.
    """

    def __init__(
        self,
        machine: JudgedMachine,
        *,
        lockstep: bool,
        participants: Collection[str],
        roles: Collection[str] | None = None,
        unseen: Collection[str] = (),
        from_start: bool = True,
    ) -> None:
        self.report = Report()
        self.strangers: dict[str, int] = {}
        """Messages on topics that the contract does not know."""
        self._lockstep = lockstep
        self._participants = tuple(participants)
        self._from_start = from_start
        self._judged = tuple(role for role in participants if roles is None or role in roles)
        self._table = machine.table
        names = {row.name for role in self._judged for row in self._table.outputs_of(role, participants)}
        self._rows = {row.name: row for row in self._table if row.name not in unseen and row.is_in(self._participants)}
        self._rules = {name: rules_of(row, machine, lockstep) for name, row in self._rows.items() if name in names}
        self._stamps = {name: array("q") for name in self._rows}
        self._beats: dict[str, list[Heartbeat]] = {role: [] for role in self._participants}
        self._mistyped: set[str] = set()
        self._clock = self._first_clock = self._doubted = 0
        self._longest_jump = max(LONGEST_JUMP_NS, self._table.longest_leap * stamps.CONTROL_PERIOD_NS)

    def endpoint(self, topic: str, endpoint: Endpoint) -> None:
        """Judge the type and quality of service of a publisher or a subscription of a judged role."""
        row = self._rows.get(topic)
        if row is None:
            return
        if endpoint.publishes and endpoint.type != row.type:
            self._mistyped.add(topic)
            self._stamps.pop(topic, None)  # nobody can read their stamps
        if topic in self._rules or not endpoint.publishes:
            self.report.add("endpoint", topic, None, endpoint_findings(row, endpoint, self._lockstep))

    def take(self, topic: str, message: Any, logged: int | None = None) -> None:
        """Judge one message.

        Args:
            topic: name in the default namespace. message: decoded. logged: simulation time at which it was
                filed [ns]; None where nobody filed it, and its age is that by /clock.
        """
        row = self._rows.get(topic)
        if row is None:
            self.strangers[topic] = self.strangers.get(topic, 0) + 1
            return
        rules = self._rules.get(topic)
        if topic in self._mistyped:
            self._count(topic)
            return
        stamp = stamp_of(message)
        skipped = ""
        if row.publisher == "all":
            if not self._is_judged(message):
                return
            if not self._hear(message):
                skipped = _STAMP  # only heartbeats of the run keep its time
        else:
            self._stamps[topic].append(stamp)
        if topic == CLOCK:
            self._hear_clock(stamp)
        if topic == PLACE:
            for rule in self._rules.get(ODOMETRY, ()):
                if isinstance(rule, RateRule):
                    rule.excuse(max(stamp, self._clock))
        if rules is None:
            return
        self._count(topic)
        seen = Observation(row, message, stamp, logged, self._clock)
        for rule in rules:
            if rule.name != skipped:
                found = rule.judge(seen)
                if found:
                    self.report.add(rule.name, topic, stamp, found)

    def finish(self, until: int | None = None) -> Report:
        """Judge what should have come and has not.

        Args:
            until: last stamp [ns] at which answers are asked for; None for the period before the last, or, of
                a run that goes on, a second before it.
        """
        begin = 0 if self._from_start else self._first_clock
        if until is None:
            until = self._newest() - (stamps.CONTROL_PERIOD_NS if self._from_start else stamps.NANOSECONDS)
        rows = [
            row
            for name, row in self._rows.items()
            if name in self._rules and name in self._stamps and not row.is_event and row.publisher in self._judged
            if (self._lockstep or row.logged) and not row.on_demand  # the recorder paces nobody in real time
        ]
        if self._lockstep:
            inputs = {role: awaited_inputs(role, self._participants, self._table) for role in self._participants}
            missing = missing_answers(rows, self._stamps, inputs, begin, until, self._leaps())
            for row, stamp, found in missing:
                self.report.add("answer", row.name, stamp, [found])
        else:
            for row, stamp, found in rate_findings(rows, self._stamps, begin, until):
                self.report.add("rate", row.name, stamp, [found])
        self._finish_heartbeats(begin, until)
        return self.report

    def _leaps(self) -> Leaps:
        """Of a clock that may leap, as it has told them."""
        return leaps_of(sorted(self._stamps.get(CLOCK, ()))) if self._table.longest_leap else NO_LEAPS

    @property
    def simulated_s(self) -> float:
        """Simulation time from the first message of /clock to the last [s]."""
        return stamps.seconds(self._clock - self._first_clock)

    def _hear_clock(self, stamp: int) -> None:
        """Follow /clock; a jump far ahead counts when the next message is there, too."""
        longest = self._longest_jump
        if not self._clock or stamp <= self._clock + longest or abs(stamp - self._doubted) <= longest:
            self._clock = max(self._clock, stamp)
            self._first_clock = self._first_clock or stamp
        self._doubted = stamp

    def _newest(self) -> int:
        """Where the run has got to [ns]: by /clock, and where that is missing by whatever was sent at a rate."""
        periodic = (found for name, found in self._stamps.items() if found and not self._rows[name].is_event)
        return self._clock or max((max(found) for found in periodic), default=0)

    def _count(self, topic: str) -> None:
        if topic in self._rules:
            self.report.messages[topic] = self.report.messages.get(topic, 0) + 1

    def _is_judged(self, message: Any) -> bool:
        """Whether a message of /diagnostics is of a judged role, or of nobody that is known."""
        return any(status.name in self._judged or status.name not in ROLES for status in message.status)

    def _hear(self, message: Any) -> bool:
        """Keep the heartbeats of the run. Returns whether the message is one."""
        running = [beat for beat in read_heartbeats(diagnostics_of(message)) if beat.state == RUNNING]
        for beat in running:
            if beat.role in self._beats:
                self._beats[beat.role].append(beat)
        return bool(running)

    def _finish_heartbeats(self, begin: int, until: int) -> None:
        name = heartbeats.HEARTBEATS
        ordered = {topic: sorted(self._rows[topic].all_heard_at(found)) for topic, found in self._stamps.items()}
        uncounted = tuple(row.name for row in self._table if row.on_demand)
        uncounted, leaps = uncounted if self._lockstep else (CLOCK, *uncounted), self._leaps()
        for role in self._judged:
            outputs = self._table.outputs_of(role)
            beats = sorted(self._beats[role], key=lambda beat: beat.stamp)
            for stamp, found in heartbeats.schedule_findings(role, beats, self._lockstep, begin, until, leaps):
                self.report.add("heartbeat", name, stamp, [found])
            beats = [beat for beat in beats if beat.stamp <= until]
            for stamp, found in heartbeats.counter_findings(
                outputs, beats, ordered, self._from_start, uncounted, leaps
            ):
                self.report.add("counter", name, stamp, [found])


def rules_of(row: Topic, machine: JudgedMachine, lockstep: bool) -> list[Rule]:
    """The rules for messages of a row."""
    rules: list[Rule] = [StampRule(row, lockstep, machine.table.longest_leap), NumberRule(row)]
    if row.frames or row.child_frame:
        rules.append(FrameRule(row))
    if OrientationRule.applies(row):
        rules.append(OrientationRule(row))
    if CovarianceRule.applies(row):
        rules.append(CovarianceRule(row))
    if row.joints:
        rules.append(JointRule(row, machine))
    if row.type == _JOINT_STATE:
        rules.append(JointLimitRule(row, machine))
    if RateRule.applies(row):
        rules.append(RateRule(row, machine.drive))
    if row.type == "sensor_msgs/PointCloud2":
        rules.append(CloudRule(row, machine.contacts if row.name == "/truth/contacts" else None))
    if row.type == "nav_msgs/OccupancyGrid":
        rules.append(GridRule())
    if row.publisher == "all":
        rules.append(heartbeats.HeartbeatRule())
    special: dict[str, Rule] = {
        "/drive/status": GoalStatusRule(),
        "/arm/status": GoalStatusRule(),
        "/power/switches": SwitchRule(machine),
        "/power/request": RequestRule(machine),
        "/operator/tick": TickRule(),
        "/truth/loads": LoadRule(),
    }
    if row.name in special:
        rules.append(special[row.name])
    return rules
