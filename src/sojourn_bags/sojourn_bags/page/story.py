"""What a page tells of a bag: everything that its sections share, worked out once, and what is missing."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from sojourn_analysis.vehicle.stability import tip_over_margin
from sojourn_bags.curves import FloatArray
from sojourn_bags.description import Run
from sojourn_bags.errors import BagsError
from sojourn_bags.goals import ARM_TOPICS
from sojourn_bags.judging import judge_bag
from sojourn_bags.machine import TrueMachine
from sojourn_bags.messages import JointHistory, Messages
from sojourn_bags.page.chart import Span, TimeAxis
from sojourn_bags.reading import Bag
from sojourn_bags.summary import summarise
from sojourn_contract.conformance.findings import Report

DRIVE_SHADE, ARM_SHADE = "#0072b2", "#8a00a8"
MOST_MARGINS = 20_000
"""Instants at which the tip-over margin is worked out; of a longer run every second, third ... one."""
MOVED_RAD = 2e-3
"""A joint that has not turned by this has not been moved, only held against the ground and the noise."""
TEN_YEARS_S = 3.2e8
"""A stamp beyond is one of the wall clock, not of a simulation."""
POSE, JOINTS, CLOUD = "nav_msgs/msg/Odometry", "sensor_msgs/msg/JointState", "sensor_msgs/msg/PointCloud2"
BATTERY, STATUS, IMU = "sensor_msgs/msg/BatteryState", "diagnostic_msgs/msg/DiagnosticArray", "sensor_msgs/msg/Imu"


@dataclass(frozen=True)
class Margin:
    """Tip-over margin over time: times (n,) [s], margin (n,) [rad]."""

    times: FloatArray
    values: FloatArray


class Story:
    """A bag with what follows from it.

    Args:
        bag: any ROS 2 bag.

    Attributes:
        run: description of the scenario, None where the bag has none; `why_no_run` then says why.
        summary: as `summarise` gives it, None without a scenario.
        judgement: violations of the contract, None until `judge` is called, or where the bag cannot be judged;
            `why_not_judged` then says why. judgement_notes: what a reader of it should know.
    """

    def __init__(self, bag: Bag) -> None:
        self.bag = bag
        self.run: Run | None = None
        self.summary: dict[str, Any] | None = None
        self.why_no_run = ""
        self.judgement: Report | None = None
        self.judgement_notes: tuple[str, ...] = ()
        self.why_not_judged = "it was not asked for"
        try:
            self.run = Run.of_bag(bag)
            self.summary = summarise(bag, self.run)
        except BagsError as error:
            self.run = None
            self.why_no_run = str(error)

    def find(self, topic: str, kind: str) -> Messages | None:
        """Messages of a topic if it is there and of this type."""
        if topic not in self.bag or self.bag[topic].type != kind:
            return None
        return self.bag[topic]

    def judge(self) -> None:
        """Judge the messages by the contract."""
        try:
            self.judgement, recorded = judge_bag(self.bag)
            self.judgement_notes = tuple(recorded.notes)
            self.why_not_judged = ""
        except BagsError as error:
            self.why_not_judged = str(error)

    @property
    def judgement_in_words(self) -> str:
        """What the contract says of the messages."""
        if self.judgement is None:
            return f"Not judged by the contract: {self.why_not_judged}."
        if not self.judgement.violations:
            return f"No violation of the contract in {sum(self.judgement.messages.values())} messages."
        return f"{self.judgement.violations} violations of the contract, of {len(self.judgement.groups)} kinds."

    @cached_property
    def origin(self) -> float:
        """Zero of the page's time [s]: that of the simulation, or the first message of a bag of the wall clock."""
        first = min((min(messages.log_times) for messages in self.bag.topics.values()), default=0) / 1e9
        return first if first > TEN_YEARS_S else 0.0

    @cached_property
    def axis(self) -> TimeAxis:
        """Scale of time, with the goals as shades."""
        logs = [
            log for messages in self.bag.topics.values() for log in (min(messages.log_times), max(messages.log_times))
        ]
        begin = min(logs, default=0) / 1e9 - self.origin
        end = max(logs, default=0) / 1e9 - self.origin
        if self.summary is not None:
            begin, end = 0.0, max(end, self.summary["sim_time_s"])
        goals = [] if self.summary is None else self.summary["goals"]
        spans = [
            Span(
                goal["start_s"], goal["end_s"], ARM_SHADE if goal["topic"] in ARM_TOPICS else DRIVE_SHADE, goal["goal"]
            )
            for goal in goals
        ]
        return TimeAxis(begin, max(end, begin + 1e-3), tuple(spans))

    def times(self, messages: Messages) -> FloatArray:
        """Stamps of messages on the page's time [s]; the time of recording where they have none."""
        stamps = messages.times
        if not np.any(stamps):
            stamps = np.array(messages.log_times) / 1e9
        return stamps - self.origin

    @cached_property
    def machine(self) -> TrueMachine | None:
        """The true machine, None where the bag has no truth or no machine."""
        if self.run is None or not self.find("/truth/odom", POSE) or not self.find("/truth/joint_states", JOINTS):
            return None
        return TrueMachine(self.bag, self.run.urdf)

    @cached_property
    def true_joints(self) -> JointHistory | None:
        """True state of the joints."""
        states = self.find("/truth/joint_states", JOINTS)
        return states.joints() if states else None

    @cached_property
    def points(self) -> dict[str, FloatArray]:
        """True contacts by field, each (n, wheels and pads); empty without them."""
        contacts = self.find("/truth/contacts", CLOUD)
        return contacts.points() if contacts else {}

    @property
    def wheels(self) -> list[str]:
        """Names of what the machine stands on, wheels or tracks: the first contacts."""
        return [support.name for support in self.run.machine.stands_on] if self.run else []

    @property
    def pads(self) -> list[str]:
        """Names of the pads, which are the contacts after the wheels."""
        return [pad.name for pad in self.run.machine.pads] if self.run else []

    def moved(self, joints: list[str]) -> bool:
        """Whether any of these joints has turned."""
        found = self.true_joints
        if found is None:
            return False
        columns = [found.index(name) for name in joints if name in found.names]
        return any(_reach(found.position[:, column]) > MOVED_RAD for column in columns)

    @cached_property
    def margin(self) -> Margin | None:
        """Tip-over margin, None where it cannot be known."""
        contacts = self.find("/truth/contacts", CLOUD)
        needed = ("x", "y", "z", "force_x", "force_y", "force_z")
        if self.machine is None or contacts is None or any(name not in self.points for name in needed):
            return None
        count = len(self.wheels)
        rows = slice(None, None, -(-len(contacts) // MOST_MARGINS))
        places, forces = (
            np.stack([self.points[name][rows, :count] for name in names], axis=2) for names in (needed[:3], needed[3:])
        )
        times = contacts.times[rows]
        carries = np.linalg.norm(np.nan_to_num(forces), axis=2) > 0.0
        return Margin(times, tip_over_margin(places, carries, self.machine.centres_of_mass(times)))


def _reach(values: FloatArray) -> float:
    """Greatest less least value."""
    finite = values[np.isfinite(values)]
    return float(np.ptp(finite)) if finite.size else 0.0
