"""Measures what becomes of a running stack that somebody floods with hostile messages.

    scripts/lib/python -m sojourn_studies.measure_flood --messages 1000000
    scripts/lib/python -m sojourn_studies.measure_flood --processes --realtime --messages 100000

The messages go to every topic that a node of the run subscribes, its bundles too, at a rate that its nodes can take.
Most are what the run itself says there, with a few bytes changed; half are stamped about now, so that some are taken.
Told are: whether a node has ended, what each process holds in memory early and late, how soon after the last message
the loop runs again, whether all truth that the run tells is finite, and what the nodes say that they have refused.
"""

import argparse
import math
import tempfile
import time
from collections import deque
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sojourn_config import command_line
from sojourn_config.command_errors import CommandError
from sojourn_config.scenario import load_scenario
from sojourn_contract import qos
from sojourn_contract.bundling import REPEATS, bundle_of, padded
from sojourn_contract.decoding import hearing
from sojourn_contract.heartbeat import read_heartbeats
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_types import ROLES, Topic
from sojourn_contract.topics import topic
from sojourn_contract.types import message_class
from sojourn_contract.values import DiagnosticArray, Odometry
from sojourn_operator.desk import Desk
from sojourn_studies.hostile_messages import spoiled, whole
from sojourn_studies.memory_growth import Sample, told
from sojourn_studies.probed_program import START_S
from sojourn_studies.probed_stack import WAITING, ProbedStack, add_options, bag_of, probed

LISTEN_S, AFTER_S = 3.0, 60.0
"""Wall time for hearing what a run says, and after which what has not come after the flood is held for lost [s]."""
MOST_SAMPLES = 50
"""Good messages of a topic that are kept, of which hostile ones are made."""
BURST = 5
"""Messages on one topic in a row: half of a subscription's history."""
LOOK_S = 2.0
MOST_SAID = 2000
PERIODS_BACK = 25
"""Consecutive true periods that tell that the loop runs."""
BACK_S = 1.0
TRUTH = "/truth/odom"


class Aftermath(NamedTuple):
    """What a stack says after the flood: wall time from its end to the loop's first period [s], whether all of its
    truth was finite, messages refused by each role that has told.
    """

    back_s: float
    is_finite: bool
    refused: dict[str, int]


class Flood(Desk):
    """Somebody who means harm, on the domain of a stack. A context manager.

    Args:
        domain: of the stack. rows: that its nodes subscribe. seed: of all that is said.
    """

    def __init__(self, domain: int, rows: Sequence[Topic], seed: int) -> None:
        super().__init__("flood", domain, "")
        self._rows, self._random = rows, np.random.default_rng(seed)
        self._samples: dict[str, deque[bytes]] = {row.name: deque(maxlen=MOST_SAMPLES) for row in rows}
        self._senders: dict[str, Any] = {}
        self.now = 0
        """Simulation time [ns]."""
        self._truths: deque[tuple[float, Odometry]] = deque(maxlen=PERIODS_BACK)
        """The run's own, with the wall time at which each came."""
        self._is_finite = True
        """Whether all of them were."""
        self._said: deque[bytes] = deque(maxlen=MOST_SAID)
        """What has been said of the truth, which is heard here as well."""
        self._refused: dict[str, int] = {}

    def __enter__(self) -> "Flood":
        super().__enter__()
        row = topic(TRUTH)
        self._read = hearing(row, self._hear_truth, lambda _: None)
        quality = qos.profile(row, True, "recorder")
        self.node.create_subscription(message_class(row.type), row.name.lstrip("/"), self._hear, quality, raw=True)
        self.listen(topic("/diagnostics"), self._hear_heartbeats)
        return self

    def wait_for_run(self, stack: ProbedStack) -> None:
        """Until the loop runs. Raises CommandError where it does not in START_S."""
        end = time.monotonic() + START_S
        while not self._runs():
            self.spin(0.1)
            stack.require_running()
            if time.monotonic() > end:
                raise CommandError(f"the stack does not run within {START_S:g} s")

    def learn(self) -> None:
        """Hear for a while what the run says, of which hostile messages are made then."""
        readers = [self._learner(row) for row in self._rows]
        self.spin(LISTEN_S)
        for reader in readers:
            self.node.destroy_subscription(reader)
        for row in self._rows:
            if not self._samples[row.name]:
                self._samples[row.name].append(whole(row))
            self._senders[row.name] = self.sender(row)
        self.spin(1.0)  # until all have met

    def _learner(self, row: Topic) -> Any:
        kept = self._samples[row.name]
        name, kind = row.name.lstrip("/"), message_class(row.type)
        return self.node.create_subscription(kind, name, lambda data: kept.append(data), BURST, raw=True)

    def round(self) -> int:
        """A burst on every topic; how many messages that were."""
        for row in self._rows:
            sender, samples = self._senders[row.name], self._samples[row.name]
            for _ in range(BURST):
                data = spoiled(self._random, samples, self.now)
                if row.name == TRUTH:
                    self._said.append(padded(data))
                sender.publish(data)
        return BURST * len(self._rows)

    def cease(self) -> Aftermath:
        """Say no more, and hear what the run still says."""
        ended = time.monotonic()
        for sender in self._senders.values():
            self.node.destroy_publisher(sender)
        self._truths.clear()
        self._spin_until(self._runs)
        back = self._truths[0][0] - ended if self._runs() else math.inf
        self._refused.clear()
        self.spin(LISTEN_S)
        self._spin_until(lambda: len(self._refused) == len(ROLES))
        return Aftermath(back, self._is_finite, dict(self._refused))

    def _spin_until(self, done: Callable[[], bool]) -> None:
        """Hear until it is so, AFTER_S at most."""
        end = time.monotonic() + AFTER_S
        while not done() and time.monotonic() < end:
            self.spin(0.02)

    def _runs(self) -> bool:
        """Whether the last truths are of consecutive periods."""
        stamps = [one.stamp for _, one in self._truths]
        steps = {after - before for before, after in pairwise(stamps)}
        return len(stamps) == PERIODS_BACK and steps == {CONTROL_PERIOD_NS}

    def _hear(self, data: bytes) -> None:
        if padded(data) not in self._said:
            self._read(data)

    def _hear_truth(self, message: Odometry) -> None:
        self._truths.append((time.monotonic(), message))
        self.now = message.stamp
        values = (*message.position, *message.orientation, *message.linear, *message.angular)
        self._is_finite = self._is_finite and bool(np.isfinite(values).all())

    def _hear_heartbeats(self, message: DiagnosticArray) -> None:
        for beat in read_heartbeats(message):
            if beat.role in ROLES:
                self._refused[beat.role] = sum(beat.refused.values())


def rows_of_run(scenario: str, changes: Sequence[str], bundled: bool) -> list[Topic]:
    """Rows that the nodes of a run subscribe, those of its bundles among them where it has some."""
    table = table_of(load_scenario(scenario, changes))
    heard = {row.name: row for role in ROLES for row in table.inputs_of(role, ROLES)}
    hidden = [*map(bundle_of, ROLES), REPEATS] if bundled else []
    return [*heard.values(), *hidden]


def flood(stack: ProbedStack, desk: Flood, messages: int, rate: float) -> list[Sample]:
    """So many messages at a rate [1/s]; memory of each process, sample by sample [MB]. Raises CommandError."""
    sent, begun, looked_at, samples = 0, time.monotonic(), 0.0, list[Sample]()
    while sent < messages:
        sent += desk.round()
        desk.spin(max(0.0, begun + sent / rate - time.monotonic()))
        if time.monotonic() - looked_at > LOOK_S:
            looked_at = time.monotonic()
            stack.require_running()
            samples.append(stack.memory_mb())
    return samples


def record(run_dir: Path) -> tuple[float, int]:
    """Size of the bag of a run [MB] and messages in it. Raises CommandError where it cannot be read."""
    bag = bag_of("flooded", run_dir)
    return sum(file.stat().st_size for file in bag.parts) / 1e6, sum(len(one) for one in bag.topics.values())


def measure(given: argparse.Namespace, run_dir: Path) -> bool:
    """Measure and print; whether nothing was broken."""
    layout = "processes" if given.processes else "composed"
    rows = rows_of_run(given.scenario, command_line.changes_of(given), given.processes and not given.realtime)
    with (
        probed(given, [f"--{layout}"], WAITING, run_dir) as stack,
        Flood(given.domain, rows, given.seed) as desk,
    ):
        desk.wait_for_run(stack)
        desk.learn()
        nodes = stack.nodes
        print(f"{given.messages} messages on {len(rows)} topics, {layout}", flush=True)
        begun = time.monotonic()
        samples = flood(stack, desk, given.messages, given.rate)
        print(f"sent in {time.monotonic() - begun:.0f} s", flush=True)
        after = desk.cease()
        stack.require_running()
        same = stack.nodes == nodes
    size, recorded = record(run_dir)
    for line in told(samples):
        print(line)
    print("no node has ended" if same else "nodes have ended, and others have begun")
    print(f"the loop runs again after {after.back_s:.2f} s; its truth is {'' if after.is_finite else 'not '}finite")
    print(f"refused: {', '.join(f'{role} {count}' for role, count in after.refused.items())}")
    print(f"the bag has {recorded} messages, {size:.0f} MB")
    return same and after.is_finite and after.back_s <= BACK_S


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; status 1 where a node ended, the truth is not finite or the loop is late."""
    parser = command_line.Parser(prog="measure_flood", description="What hostile messages do to a running stack.")
    add_options(parser)
    parser.add_argument("--processes", action="store_true", help="each node a process (default: all in one)")
    parser.add_argument(
        "--messages", type=command_line.count, default=100_000, metavar="N", help="default: %(default)s"
    )
    parser.add_argument(
        "--rate", type=command_line.positive, default=5000.0, metavar="R", help="at most so many a second"
    )
    parser.add_argument("--seed", type=command_line.whole_number, default=1, metavar="N", help="of what is said")
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="sojourn-flood-") as folder:
        return 0 if measure(given, Path(folder) / "run") else 1


if __name__ == "__main__":
    command_line.run_script(main)
