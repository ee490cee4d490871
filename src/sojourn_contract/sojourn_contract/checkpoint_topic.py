"""Row of the topic by which an operator asks a running stack to keep its state.

A run that keeps checkpoints has it and no other one: it is no part of the table of every run, obliges no node, and is
not in the bag, so that a run is the same whether or not it is asked.
"""

from sojourn_contract.topic_types import Topic

CHECKPOINT = Topic(
    "/checkpoint",
    "std_msgs/Header",
    "operator",
    ("plant",),
    0,
    10.0,
    "keep the state of the run in the next period at which all roles act; the plant says in its heartbeat, under "
    "checkpoint, of when the last one is that was asked for",
    logged=False,
    needs_listener=False,
)
KEPT = "checkpoint"
"""Key of the plant's heartbeat."""
