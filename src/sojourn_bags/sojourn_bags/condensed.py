"""Topics of which a bag in memory holds not the messages but what is asked for of each: a run may last for days."""

from array import array
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import NamedTuple, TypeAlias

import numpy as np

from sojourn_bags.errors import UnknownTopicInBagError
from sojourn_bags.messages import FloatArray, JointHistory, Messages

BATCH = 1024
"""Messages of a topic that are read before what is kept of them is taken."""
EVERY_JOINT = ("*",)


class Excerpt(NamedTuple):
    """What is kept of the messages of a topic besides how many there are, and when the last was written."""

    columns: tuple[str, ...] = ()
    """Single numbers of each message, by their paths."""
    joints: tuple[str, ...] | None = None
    """Those of which the positions are kept; None where it is no topic of joints."""
    points: Mapping[str, int] = {}
    """Fields of a point cloud: of how many points, the first ones."""
    texts: tuple[str, ...] = ()
    """Of the first status: `name`, `message`, values by their keys."""
    first: int = 0
    """So many messages are kept whole, the first ones."""
    is_stamped: bool = False
    """Whether the stamps are kept."""
    is_dated: bool = False
    """Whether it is kept when each was written."""


Keep: TypeAlias = Callable[[str], Excerpt | None]
"""What is kept of a topic, by its name; None for all of all messages."""


class CondensedMessages(Messages):
    """A topic of which so much is kept; asked for anything else it raises UnknownTopicInBagError.

    Args:
        messages: the topic's; they are taken with `take`. kept: what is kept of them.
    """

    def __init__(self, messages: Messages, kept: Excerpt) -> None:
        super().__init__(messages.topic, messages.type, array("Q"), offered_qos=messages.offered_qos)
        self.kept = kept
        self._count = 0
        self._times: list[FloatArray] = []
        self._columns: dict[str, list[FloatArray]] = {path: [] for path in kept.columns}
        self._points: dict[str, list[FloatArray]] = {name: [] for name in kept.points}
        self._joints: list[JointHistory] = []
        self._statuses: list[dict[str, str]] = []
        self._said: dict[tuple[str | None, ...], dict[str, str]] = {}

    def take(self, messages: Messages) -> None:
        """Keep of messages what is kept, and remove them. Raises UnknownTopicInBagError where they do not have it."""
        kept = self.kept
        self._count += len(messages)
        self.data += messages.data[: max(0, kept.first - len(self.data))]
        if not kept.is_dated:
            del self.log_times[:]
        self.log_times.extend(messages.log_times if kept.is_dated else messages.log_times[-1:])
        if kept.is_stamped:
            self._times.append(messages.times)
        for path, columns in self._columns.items():
            columns.append(messages.column(path))
        found = messages.points() if kept.points else {}
        for name, most in kept.points.items():
            values = found.get(name, np.empty((len(messages), 0)))
            self._points[name].append(_padded(values[:, :most], most))
        if kept.joints is not None:
            self._joints.append(_positions(messages, kept.joints))
        if kept.texts:
            self._statuses += [self._shared(status) for status in messages.statuses()]
        messages.clear()

    def _shared(self, status: Mapping[str, str]) -> dict[str, str]:
        """What is kept of a status; the same of all that say the same."""
        said = tuple(status.get(key) for key in self.kept.texts)
        there = ((key, text) for key, text in zip(self.kept.texts, said, strict=True) if text is not None)
        return self._said.setdefault(said, dict(there))

    def __len__(self) -> int:
        return self._count

    @cached_property
    def times(self) -> FloatArray:
        """As of `Messages`."""
        self._must_have("stamps", self.kept.is_stamped)
        return np.concatenate(self._times)

    def fields(self) -> list[str]:
        """Paths of the numbers that are kept."""
        return list(self._columns)

    def column(self, path: str) -> FloatArray:
        """As of `Messages`."""
        self._must_have(path, path in self._columns)
        return np.concatenate(self._columns[path])

    def points(self) -> dict[str, FloatArray]:
        """As of `Messages`, of as many points as are kept."""
        self._must_have("points", bool(self._points))
        return {name: np.concatenate(values) for name, values in self._points.items()}

    def joints(self) -> JointHistory:
        """As of `Messages`; velocities and efforts are NaN."""
        self._must_have("joints", self.kept.joints is not None)
        names = tuple(dict.fromkeys(name for part in self._joints for name in part.names))
        position = np.full((self._count, len(names)), np.nan)
        begin = 0
        for part in self._joints:
            end = begin + len(part.position)
            position[begin:end, [names.index(name) for name in part.names]] = part.position
            begin = end
        unknown = np.broadcast_to(np.nan, position.shape)
        return JointHistory(names, position, unknown, unknown)

    def statuses(self) -> list[dict[str, str]]:
        """As of `Messages`, with the texts that are kept."""
        self._must_have("statuses", bool(self.kept.texts))
        return self._statuses

    def _must_have(self, what: str, is_kept: bool) -> None:
        if not is_kept:
            raise UnknownTopicInBagError(f"{self.topic}.{what}", self.fields())


def _padded(values: FloatArray, most: int) -> FloatArray:
    """Of shape (n, most), NaN where there is nothing."""
    lacking = most - values.shape[1]
    return np.pad(values, ((0, 0), (0, lacking)), constant_values=np.nan) if lacking else np.array(values)


def _positions(messages: Messages, joints: tuple[str, ...]) -> JointHistory:
    """Of these joints, as far as they are there."""
    history = messages.joints()
    columns = [number for number, name in enumerate(history.names) if joints == EVERY_JOINT or name in joints]
    names = tuple(history.names[number] for number in columns)
    none = np.empty((len(messages), 0))
    return JointHistory(names, history.position[:, columns], none, none)
