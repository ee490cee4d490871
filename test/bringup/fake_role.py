"""A node of any role that keeps the contract with empty messages: python fake_role.py ROLE [MANNER] --ros-args ...

Manners: `good`; `never` ends with an error before it is a node; `stubborn` does not heed SIGINT; `parent` has a
child of its own; `brief` (the plant) ends the run after a second of simulation.
"""

import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

from ros_messages import value_of
from sojourn_contract import process, stamps
from sojourn_contract.heartbeat import READY, read_heartbeats
from sojourn_contract.node import ContractNode
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import outputs_of
from sojourn_contract.types import message_class

PERIOD = stamps.CONTROL_PERIOD_NS
BRIEF_S = 1.0


class FakeRole(ContractNode):
    """Publishes at each period what its role owes."""

    def __init__(self, role: str, manner: str) -> None:
        super().__init__(role, every_period=role == "plant")
        # what the supervisor gives to some roles besides
        self.declare_parameter("bag", "")
        self.declare_parameter("result_file", "")
        self.ends_the_run = role == "plant"
        self._manner = manner
        self._owed = [row for row in outputs_of(role, self.participants) if row.publisher == role and row.every]
        self._ready: set[str] = set()
        self._sent = 0
        self._next_at = 0.0

    def check(self, row: Topic, message: Any) -> None:
        """Empty messages will do."""

    def on_heartbeat(self, message: Any) -> None:
        """The plant notes who is ready."""
        self._ready |= {beat.role for beat in read_heartbeats(message) if beat.state == READY}

    def poll(self) -> None:
        """The plant begins when all are ready; in real time, or unanswered, it goes by the wall clock."""
        super().poll()
        if self.role != "plant" or not self._ready >= set(self.participants):
            return
        if self._sent == 0:
            self._say(1)
        elif (not self.lockstep or not self.awaited) and time.monotonic() > self._next_at:
            self.act(self._sent * PERIOD, {})

    def on_period(self, stamp: int, inputs: Mapping[str, Any], goals: list[tuple[str, Any]]) -> None:
        """The plant sends the truth of the next period, others answer in this."""
        if self.role == "plant":
            self.finished = self._manner == "brief" and stamps.seconds(stamp) >= BRIEF_S
            if not self.finished:
                self._say(stamp // PERIOD + 1)
        else:
            self._say(stamp // PERIOD)

    def _say(self, period: int) -> None:
        self._sent = period
        self._next_at = time.monotonic() + stamps.CONTROL_PERIOD_S
        for row in self._owed:
            if period % row.every == 0:
                self.publish(row.name, value_of(message_class(row.type)())._replace(stamp=period * PERIOD))


def main() -> int:
    """Run the node."""
    role, manner = sys.argv[1], sys.argv[2] if sys.argv[2] != "--ros-args" else "good"
    if manner == "never":
        raise RuntimeError("the hardware is not there")
    if manner == "parent":
        print(subprocess.Popen(["sleep", "1000"]).pid, flush=True)
    if manner == "stubborn":
        process.StopFlag._set = lambda self, number, frame: None  # type: ignore[method-assign]
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
    return process.run(lambda: FakeRole(role, manner))


if __name__ == "__main__":
    sys.exit(main())
