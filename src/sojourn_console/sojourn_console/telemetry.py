"""Fields of topics over time, by the names that `scripts/plot` takes: what is plotted, shown as numbers, written out.

Messages are taken apart by the code that reads bags, so that names and units are the same here and there.
"""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sojourn_bags.definitions import full_type
from sojourn_bags.errors import BagsError, UnknownFieldError
from sojourn_bags.fields import names, series
from sojourn_bags.messages import Messages
from sojourn_bags.reading import Bag
from sojourn_console.errors import GoalError
from sojourn_console.feed import FeedMessage
from sojourn_contract.topic_table import TopicTable
from sojourn_machine.params import FloatArray

MOST = 60_000
"""Numbers of a series that are kept, the newest: 20 minutes at 50 Hz."""
DRAWN = 600
"""Of these that are drawn."""


@dataclass(frozen=True, eq=False)
class FieldCurve:
    """A number over time: name, unit, times (n,) [s], values (n,)."""

    name: str
    unit: str
    times: FloatArray
    values: FloatArray


class Telemetry:
    """The fields that are followed.

    Args:
        table: topics of the run. attachments: files that describe the run, by which wheels have their names.
    """

    def __init__(self, table: TopicTable, attachments: Mapping[str, bytes]) -> None:
        self._table = table
        self._attachments = dict(attachments)
        self._followed: dict[str, dict[str, FieldCurve]] = {}
        """Of each field, as it was typed, its curves by name."""
        self._listed: dict[str, tuple[str, ...]] = {}
        self._new: dict[str, Messages] = {}
        self.asked: str = ""
        """Topic whose fields are asked for."""

    @property
    def fields(self) -> tuple[str, ...]:
        """That are followed, as they were typed."""
        return tuple(self._followed)

    @property
    def topics(self) -> frozenset[str]:
        """Of which every message is needed."""
        return frozenset(field.partition(".")[0] for field in self._followed)

    def follow(self, field: str) -> None:
        """Follow a field from now on. Raises GoalError for a topic that the run does not have."""
        topic, dot, path = field.strip().partition(".")
        if topic not in self._table:
            raise GoalError(topic or "field", "the run has no such topic: allowed is TOPIC.FIELD, as /odom.twist")
        if not dot or not path:
            raise GoalError(field, "a field is missing behind the topic: allowed is TOPIC.FIELD")
        self._followed.setdefault(field.strip(), {})

    def forget(self, field: str) -> None:
        """Follow a field no more."""
        self._followed.pop(field, None)

    def clear(self) -> None:
        """Begin anew with what is followed: time has jumped."""
        self._followed = {field: {} for field in self._followed}
        self._new.clear()

    def hear(self, heard: Iterable[FeedMessage]) -> None:
        """Keep messages until they are taken apart."""
        wanted = {*self.topics, self.asked}
        for row, data, time in heard:
            if row.name in wanted:
                messages = self._new.setdefault(row.name, Messages(row.name, full_type(row.type)))
                messages.log_times.append(time)
                messages.data.append(data)

    def update(self) -> dict[str, str]:
        """Take apart what has come. Returns why fields cannot be had, by field."""
        fresh, self._new = self._new, {}
        for messages in fresh.values():
            messages.take_out(messages.unreadable().keys())
        bag = Bag(Path("telemetry"), topics={name: one for name, one in fresh.items() if len(one)})
        bag.attachments = self._attachments
        if self.asked in bag:
            self._listed[self.asked] = tuple(names(bag, bag[self.asked]))
        problems = {}
        for field, curves in self._followed.items():
            if field.partition(".")[0] not in bag:
                continue
            try:
                for one in series(bag, field):
                    curves[one.name] = _longer(
                        curves.get(one.name), FieldCurve(one.name, one.unit, one.times, one.values)
                    )
            except UnknownFieldError as error:
                if not curves:
                    problems[field] = str(error)
            except BagsError as error:
                problems[field] = str(error)
        return problems

    def names_of(self, topic: str) -> tuple[str, ...]:
        """Fields that a topic's messages have, as far as one has come since it was asked for."""
        return self._listed.get(topic, ())

    def curves(self, field: str) -> tuple[FieldCurve, ...]:
        """Of a field."""
        return tuple(self._followed.get(field, {}).values())


def aligned(curves: Sequence[FieldCurve], since: float) -> tuple[FloatArray, ...]:
    """Times, and the values of each curve at them, NaN where it has none: as plots of several curves want them.

    since: earlier ones are left out [s]. Of many, about DRAWN are taken, among them the least and largest of each span.
    """
    thinned = [_thinned(curve, since) for curve in curves]
    times = np.unique(np.concatenate([one for one, _ in thinned] or [np.zeros(0)]))
    columns = [times]
    for own, values in thinned:
        column = np.full(len(times), np.nan)
        column[np.searchsorted(times, own)] = values
        columns.append(column)
    return tuple(columns)


def as_csv(curves: Sequence[FieldCurve]) -> str:
    """One line for each time, one column for each curve; empty where it has no value then."""
    times = np.unique(np.concatenate([curve.times for curve in curves] or [np.zeros(0)]))
    columns = []
    for curve in curves:
        column = np.full(len(times), np.nan)
        column[np.searchsorted(times, curve.times)] = curve.values
        columns.append(column)
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["time [s]", *(f"{curve.name} [{curve.unit}]" if curve.unit else curve.name for curve in curves)])
    for number, time in enumerate(times):
        values = (float(column[number]) for column in columns)
        writer.writerow([f"{time:.9g}", *("" if np.isnan(value) else repr(value) for value in values)])
    return out.getvalue()


def _longer(curve: FieldCurve | None, more: FieldCurve) -> FieldCurve:
    if curve is None:
        return FieldCurve(more.name, more.unit, more.times[-MOST:], more.values[-MOST:])
    later = more.times > (curve.times[-1] if len(curve.times) else -np.inf)
    times = np.concatenate([curve.times, more.times[later]])[-MOST:]
    return FieldCurve(curve.name, curve.unit, times, np.concatenate([curve.values, more.values[later]])[-MOST:])


def _thinned(curve: FieldCurve, since: float) -> tuple[FloatArray, FloatArray]:
    first = int(np.searchsorted(curve.times, since))
    times, values = curve.times[first:], curve.values[first:]
    if len(times) <= DRAWN:
        return times, values
    span = -(-len(times) // (DRAWN // 2))
    whole = len(times) // span * span
    rows = values[:whole].reshape(-1, span)
    begin = np.arange(len(rows)) * span
    filled_low, filled_high = np.where(np.isnan(rows), np.inf, rows), np.where(np.isnan(rows), -np.inf, rows)
    kept = np.unique(
        np.concatenate([begin + filled_low.argmin(axis=1), begin + filled_high.argmax(axis=1), [len(times) - 1]])
    )
    return times[kept], values[kept]
