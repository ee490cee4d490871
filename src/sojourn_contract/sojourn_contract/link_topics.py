"""Rows that a run has besides where a link stands between Earth and machine.

The machine's side stays as it is: what the operator's role says on /goal_pose is what has come down from the receiver,
and nothing else is asked of any node. On the Earth's side a goal topic has /earth before its name, for people and
programs to send on, and so has a topic of telemetry, on which the operator's role says what has been received, with the
stamp that it had.
"""

from dataclasses import replace

from sojourn_contract.field_rules import TEXTS
from sojourn_contract.goal_topics import FAULTS_TOPIC as FAULTS
from sojourn_contract.goal_topics import GOAL_TOPICS
from sojourn_contract.topic_types import INFINITY, Topic

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
