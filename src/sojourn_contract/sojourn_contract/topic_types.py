"""What a row of the topic table consists of: a topic, the rules of its fields, its quality of service."""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field
from enum import Enum

from sojourn_contract.delivery import Delivery
from sojourn_contract.stamps import CONTROL_PERIOD_NS

INFINITY = float("inf")

ROLES = ("plant", "sensors", "drive", "arm", "power", "operator", "recorder")
"""Every role, in the order in which a period passes through them."""

JOINT_SETS = {
    "moving": "names every joint of the URDF that moves, and that of the arm's tool",
    "measured": "names every drive, steer, arm and tool joint, and no joint that the machine does not have",
    "drive": "names joints that move the machine only",
    "arm": "names arm joints only",
    "pointed": "names joints held by position only that neither drive nor arm moves: a mast's pan and tilt",
    "arm and tool": "names arm joints, and that of the tool, only",
}
"""Sets of joints that a row may ask for, in words."""


class Reliability(Enum):
    """Quality of service of a topic; depths are in `qos.py`."""

    RELIABLE = "reliable"
    BEST_EFFORT = "best effort"


@dataclass(frozen=True)
class FieldRule:
    """What one field of a message means.

    Args:
        path: field, dotted; arrays are meant element by element.
        unit: SI unit, or "" for text and flags.
        frame: frame the value is expressed in, "" where it has none.
        low, high: plausible range in that unit, both included.
        tolerance: largest difference in a replay that still counts as the same answer. The default is far above
            the rounding of float64 and below that of float32, which is a fault where the field is a float64. A
            field without a rule has no tolerance at all; see `tolerance.py`.
        optional: a number may be NaN where it is not measured; an array may be empty.
        infinite: a number, a distance, may be infinite, as REP 117 has it: +infinity where nothing is met within the
            range, -infinity where something is too near to be measured.
        rate_of: field whose change over time this one is, "" for none.
        rate_tolerance: by how much it may differ from the change of that field.
        rate_window: over how many periods that change may be taken at most.
        rate_part: part of the rate itself by which a jolt within a period may move its mean besides, and of a wheel's
            radius by which edges under it are high, see `conformance.consistency`.
        rate_spread: field whose diagonal is the mean square of what the rate was within the period less what is told,
            "" for none; `rate_spread_place`: where the rate's three components begin on it.
    """

    path: str
    unit: str
    frame: str = ""
    low: float = -INFINITY
    high: float = INFINITY
    tolerance: float = 1e-9
    optional: bool = False
    infinite: bool = False
    rate_of: str = ""
    rate_tolerance: float = INFINITY
    rate_window: int = 1
    rate_part: float = 0.0
    rate_spread: str = ""
    rate_spread_place: int = 0


@dataclass(frozen=True)
class Topic:
    """One row of the table.

    Args:
        name: absolute name in the default namespace.
        type: ROS type, "package/Name".
        publisher: role that publishes it; "operator" for goals, "all" for heartbeats.
        subscribers: roles that act on it. The recorder listens to every logged topic besides.
        every: published each so many control periods; 0 means event.
        max_age_s: older than this it counts as lost [s]; for events: older stamps are refused.
        lag: the consumer at period k waits for the message of period k - lag (pipelined participants).
        logged: whether the recorder writes it.
        frames: what header.frame_id may be; empty where it carries no frame. child_frame: child_frame_id.
        joints: set of joints that a message names, see JOINT_SETS; "" where it names none.
        part: role without which a run has no such topic; "" where every run has it.
        each: kind of thing of which a machine may have several, as "store": the row stands for the first, and a further
            thing has a row of its own, with its name behind; "" where there is one row whatever the machine has.
        thing: name of the further thing that the row stands for; "" for all others.
        all_named: the first thing has a row with its name too, and none is called as the row itself.
        needs_listener: whether a run waits at its start until its subscribers hear it. Said by hand alone, so that a
            node that does nothing with it may leave it out, where not.
        delivery: when its messages are there, None where they come with their stamp.
        on_demand: said only while somebody outside of the run listens, so neither logged nor counted; no role hears it.
    """

    name: str
    type: str
    publisher: str
    subscribers: tuple[str, ...]
    every: int
    max_age_s: float
    meaning: str
    fields: tuple[FieldRule, ...] = field(default=())
    reliability: Reliability = Reliability.RELIABLE
    lag: int = 0
    logged: bool = True
    frames: tuple[str, ...] = ()
    child_frame: str = ""
    joints: str = ""
    part: str = ""
    each: str = ""
    thing: str = ""
    all_named: bool = False
    needs_listener: bool = True
    delivery: Delivery | None = None
    on_demand: bool = False

    def is_in(self, participants: Collection[str]) -> bool:
        """Whether a run of these roles has the topic."""
        return not self.part or self.part in participants

    @property
    def pace(self) -> int:
        """Its listeners look each so many control periods."""
        return self.every if self.delivery is None else self.delivery.pace

    def heard_at(self, stamp: int) -> int:
        """When a message with a stamp is there, in lock-step [ns]; with its stamp where the row says nothing else."""
        leaves = 0 if self.delivery is None else self.delivery.leaves(stamp // CONTROL_PERIOD_NS)
        return leaves * CONTROL_PERIOD_NS or stamp

    def all_heard_at(self, stamps: Iterable[int]) -> Iterator[int]:
        """When messages are there with these stamps, in their order [ns]; of a clock that has stopped
        by their number.
        """
        stands_at, measured = 0 if self.delivery is None else self.delivery.stands_at, 0
        for stamp in stamps:
            if self.delivery is None or not stands_at or stamp != stands_at * CONTROL_PERIOD_NS:
                yield self.heard_at(stamp)
                continue
            measured = self.delivery.following(measured) if measured else stands_at
            yield self.comes_at(measured * CONTROL_PERIOD_NS)

    def comes_at(self, measured: int) -> int:
        """When the message is there of what was measured at a time [ns], whatever stamp it bears [ns]."""
        comes = 0 if self.delivery is None else self.delivery.comes(measured // CONTROL_PERIOD_NS)
        return comes * CONTROL_PERIOD_NS or measured

    @property
    def is_event(self) -> bool:
        """True where messages come when somebody sends one, not at a rate."""
        return self.every == 0
