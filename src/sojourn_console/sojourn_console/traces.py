"""What a run has left behind before it is looked at: its way and its ruts, from its bag, which is still written.

It is a program of its own, for the bag of an hour keeps a core busy for a quarter of a minute:
`python -m sojourn_console.traces RUN NS` prints the `Traces` of a run, its way up to a time [ns], as a file of numpy.
"""

import sys
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import IO, NamedTuple

import numpy as np
from mcap.records import Channel, Message

from sojourn_bags.errors import BagsError
from sojourn_bags.parts import BagSalvage, is_finished, parts_of
from sojourn_config import command_line
from sojourn_console.errors import ConsoleError
from sojourn_console.feed import FeedMessage
from sojourn_console.model import NOTHING, RunScene, after_all
from sojourn_console.ruts import deepest_of_each
from sojourn_contract.ground import GROUND
from sojourn_contract.run_table import row_named
from sojourn_machine.params import FloatArray

WAY, TOUCHED = "/odom", "/truth/contacts"
LEFT_BY = (WAY, TOUCHED, GROUND.name)
"""Topics that leave traces in a scene."""
BATCH = 4096
"""Messages after which what is left is condensed."""


class Traces(NamedTuple):
    """Of a run.

    Args:
        track: places that the estimate has passed, (n, 3) [m]. passed: x, y and sinkage of what has touched the ground,
            (n, 3) [m], while the ground itself has told nothing. lowered: nodes of the ground that lie lower, x, y and
            by how much, (n, 3) [m].
        newest: time of the last of its messages [ns]; 0 without one, or where the bag is finished: of a run that
            goes on it is not then.
    """

    track: FloatArray
    passed: FloatArray
    lowered: FloatArray
    newest: int

    def save(self, stream: IO[bytes]) -> None:
        """Write it."""
        np.savez(stream, **self._asdict())

    @classmethod
    def load(cls, stream: IO[bytes]) -> "Traces":
        """As it was saved."""
        with np.load(stream, allow_pickle=False) as found:
            return cls(found["track"], found["passed"], found["lowered"], int(found["newest"]))


def traces_of(run: Path, until: int) -> Traces:
    """What a run has left: its way up to a time [ns], its ruts as far as they are written. Raises BagsError.

    Of its way the rest is heard. Of ruts it may be that some messages after that time are not: who listens is found
    topic by topic, and each tells what is new alone.
    """
    scene, passed, lowered, newest = RunScene(), NOTHING, NOTHING, 0
    heard = _messages(run)
    while batch := list(islice(heard, BATCH)):
        newest = max(newest, *(one.time for one in batch))
        skipped = (TOUCHED,) if len(lowered) else ()
        counts = (one for one in batch if one.row.name not in skipped and (one.row.name != WAY or one.time <= until))
        scene = after_all(scene, counts)
        passed = deepest_of_each(np.concatenate([passed, *scene.passed]))
        lowered = deepest_of_each(np.concatenate([lowered, *scene.lowered]))
    return Traces(scene.track, passed, lowered, 0 if is_finished(run) else newest)


def _messages(run: Path) -> Iterator[FeedMessage]:
    """What leaves traces, as far as the bag has been written. Raises BagsError."""
    rows = {}
    for record in BagSalvage(parts_of(run), LEFT_BY).records:
        if isinstance(record, Channel) and record.topic in LEFT_BY and (row := row_named(record.topic)):
            rows[record.id] = row
        elif isinstance(record, Message):
            yield FeedMessage(rows[record.channel_id], record.data, record.log_time)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the traces of a run. Raises ConsoleError."""
    run, until = sys.argv[1:] if arguments is None else arguments
    try:
        traces_of(Path(run), int(until)).save(sys.stdout.buffer)
    except BagsError as error:
        raise ConsoleError(str(error)) from error
    return 0


if __name__ == "__main__":
    command_line.run_script(main)
