"""A checkpoint of a running stack: asked of its plant, and what the plant answers."""

import time
from typing import Any

from sojourn_contract.checkpoint_topic import CHECKPOINT, KEPT
from sojourn_contract.codecs import encode
from sojourn_contract.handing_over import quality
from sojourn_contract.stamps import seconds
from sojourn_contract.values import Header
from sojourn_operator.goal_sending import GoalClient


def ask(domain: int, namespace: str, timeout_s: float) -> tuple[bool, str]:
    """Ask for one and wait, so long at most [s]. Returns whether it is kept, and in words what became of it.

    Raises NoStackError if no run that keeps checkpoints is there.
    """
    answers: list[Any] = []
    with GoalClient(domain, namespace, "checkpoint") as client:
        client.listen(KEPT, answers.append, quality=quality(KEPT))
        sender, asked = client.sender_to("checkpoints", CHECKPOINT), client.now
        sender.publish(encode(CHECKPOINT, Header(asked)))
        end = time.monotonic() + timeout_s
        while time.monotonic() < end and not client.stop.is_set:
            client.spin(0.05)
            for told in (_told(answer, asked) for answer in answers):
                if told is not None:
                    return told
    return False, f"not known: the plant has not said so within {timeout_s:g} s of wall time"


def _told(answer: Header, asked: int) -> tuple[bool, str] | None:
    """What an answer says of a request stamped so [ns]; None for one to somebody else, which may be of before it."""
    if answer.frame:
        return (False, f"refused: {answer.frame}") if answer.stamp == asked else None
    if answer.stamp < asked:
        return None
    return True, f"the state of {seconds(answer.stamp):.2f} s is kept in checkpoints/ of the run's folder"
