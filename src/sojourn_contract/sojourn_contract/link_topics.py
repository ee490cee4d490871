"""Rows that a run has besides where a link stands between Earth and machine, and who hears what because of it.

The machine's side stays as it is: what the operator's role says on /goal_pose is what has come down from the receiver,
and nothing else is asked of any node. On the Earth's side a goal topic has /earth before its name, for people and
programs to send on, and so has a topic of telemetry, on which the operator's role says what has been received, with the
stamp that it had.
"""

from collections.abc import Iterator
from dataclasses import replace

from sojourn_contract.errors import LinkError
from sojourn_contract.fault_messages import TOPIC as FAULTS
from sojourn_contract.field_rules import TEXTS
from sojourn_contract.goal_topics import GOAL_TOPICS
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import INFINITY, Topic
from sojourn_machine.names import names_text
from sojourn_machine.transport_fault import ON_BOARD
from sojourn_physics.link.params import STATUSES, LinkParams, TelemetryParams

EARTH = "/earth"
OPERATOR, BY_HAND = "operator", "console"
LINK_STATUS = Topic(
    "/link/status",
    "diagnostic_msgs/DiagnosticArray",
    OPERATOR,
    (),
    50,
    3.0,
    "what the Earth knows of the link and of its last commands: a status for each, its message queued, sent, received, "
    "executed, expired, cancelled, dropped or superseded",
    (TEXTS,),
)
CANCEL = Topic(
    f"{EARTH}/cancel",
    "std_msgs/Header",
    BY_HAND,
    (OPERATOR,),
    0,
    10.0,
    "commands that have not been sent yet are not: the number in frame_id, or all where it is empty",
    needs_listener=False,
)
PLACE = "/odom"
"""By which the Earth knows where the machine stands, where it is among the telemetry."""
COMMANDS = {row.name: row for row in GOAL_TOPICS if row.name != FAULTS}
"""Rows of what goes to the machine, by topic."""


def on_earth(row: Topic) -> Topic:
    """The row on Earth of a goal topic, or of one of telemetry."""
    name = EARTH + row.name
    if row.name in COMMANDS:
        return replace(row, name=name, publisher=BY_HAND, subscribers=(OPERATOR,), part="", needs_listener=False)
    return replace(
        row, name=name, publisher=OPERATOR, subscribers=(), every=0, max_age_s=INFINITY, needs_listener=False,
        lag=0, part="", each="", thing="", all_named=False, delivery=None, meaning=f"{row.name} as received on Earth",
    )  # fmt: skip


def linked(table: TopicTable, link: LinkParams) -> TopicTable:
    """The table of a run with a link. Raises LinkError for telemetry that it cannot carry."""
    carried = [row for row, _ in telemetry(table, link)]
    rows = [LINK_STATUS, CANCEL, *map(on_earth, COMMANDS.values()), *map(on_earth, carried)]
    for row in carried:
        table = table.heard_by(row.name, (OPERATOR,))
    return table.joined_with(rows)


def telemetry(table: TopicTable, link: LinkParams) -> Iterator[tuple[Topic, TelemetryParams]]:
    """What goes to the Earth: the row, and how. Raises LinkError."""
    if link.telemetry is None:
        for priority, name in enumerate(STATUSES, 1):
            for row in table.each(name):
                yield row, TelemetryParams(topic=row.name, priority=priority)
        return
    # what the plant says is the truth, which no machine knows, and heartbeats are of the run
    able = [row.name for row in table if not row.is_event and row.publisher in ON_BOARD]
    for place, one in enumerate(link.telemetry):
        if one.topic not in able:
            raise LinkError(("telemetry", place, "topic"), one.topic, names_text(one.topic, able))
        yield table.topic(one.topic), one
