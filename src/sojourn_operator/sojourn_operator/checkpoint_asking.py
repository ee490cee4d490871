"""A checkpoint of a running stack: asked of its plant, and what the plant says of it in its heartbeat."""

import time

from sojourn_contract.checkpoint_topic import CHECKPOINT, KEPT
from sojourn_contract.codecs import encode
from sojourn_contract.heartbeat import Heartbeat
from sojourn_contract.values import Header
from sojourn_operator.goal_sending import GoalClient

PLANT = "plant"


def ask(domain: int, namespace: str, timeout_s: float) -> tuple[bool, str]:
    """Ask for one and wait, so long at most [s]. Returns whether it is kept, and in words what became of it.

    Raises NoStackError if no run that keeps checkpoints is there.
    """
    with GoalClient(domain, namespace, "checkpoint") as client:
        sender = client.sender_to("checkpoints", CHECKPOINT)
        client.hear_from(PLANT)
        before = client.beats.get(PLANT)
        sender.publish(encode(CHECKPOINT, Header(client.now)))
        end = time.monotonic() + timeout_s
        while time.monotonic() < end and not client.stop.is_set:
            client.spin(0.05)
            answer = _answer(before, client.beats.get(PLANT))
            if answer is not None:
                return answer
    return False, f"not known: the {PLANT} has not said so within {timeout_s:g} s of wall time"


def _answer(before: Heartbeat | None, now: Heartbeat | None) -> tuple[bool, str] | None:
    """What the plant's heartbeats before it was asked and now say; None: nothing yet."""
    if now is None:
        return None
    refused, kept = (0, "") if before is None else (before.refused.get(CHECKPOINT.name, 0), before.values.get(KEPT, ""))
    if now.refused.get(CHECKPOINT.name, 0) > refused:
        return False, f"refused: {now.values.get('last refusal', '')}"
    found = now.values.get(KEPT, "")
    return None if found in ("", kept) else (True, f"the state of {found} is kept in checkpoints/ of the run's folder")
