"""A table of topics as a value: who publishes and who acts on what. `topics.STANDARD` is that of every machine; a run
has one of its own, with rows for each thing that its machine has (see `run_table`).
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from sojourn_contract.errors import TopicNameError, UnknownRoleError, UnknownTopicError
from sojourn_contract.topic_types import ROLES, Topic

CLOCK = "/clock"
_NAME = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")


class TopicTable:
    """Rows in the order in which data flows through a control period. It does not change.

    Args:
        rows: each with a name of its own.
        longest_leap: control periods by which the clock may leap at most, see `leaps`; 0: it tells each of them.

    Raises:
        TopicNameError: two rows of one name, or a name that ROS does not allow.
    """

    def __init__(self, rows: Iterable[Topic], longest_leap: int = 0) -> None:
        self.rows = tuple(rows)
        self.longest_leap = longest_leap
        self._by_name = {row.name: row for row in self.rows}
        if len(self._by_name) < len(self.rows):
            names = [row.name for row in self.rows]
            raise TopicNameError(next(name for name in names if names.count(name) > 1), "each topic once")
        for name in self._by_name:
            if not _NAME.fullmatch(name):
                raise TopicNameError(name, "letters, digits and underscores between slashes, no digit first")

    def __iter__(self) -> Iterator[Topic]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def __contains__(self, name: object) -> bool:
        return name in self._by_name

    def get(self, name: str) -> Topic | None:
        """Row by topic name, None where there is none."""
        return self._by_name.get(name)

    def topic(self, name: str) -> Topic:
        """Row by topic name. Raises UnknownTopicError."""
        try:
            return self._by_name[name]
        except KeyError:
            raise UnknownTopicError(name, tuple(self._by_name)) from None

    def each(self, name: str) -> tuple[Topic, ...]:
        """The row of this name and those that stand for further things of its kind, in the order of the things."""
        first = self.topic(name)
        return (first, *(row for row in self.rows if row.thing and row.name == f"{name}/{row.thing}"))

    def outputs_of(self, role: str, participants: Collection[str] = ROLES) -> tuple[Topic, ...]:
        """Topics that a role publishes in a run of these roles, heartbeats included. Raises UnknownRoleError."""
        _check_role(role)
        return tuple(row for row in self.rows if row.publisher in (role, "all") and row.is_in(participants))

    def inputs_of(self, role: str, participants: Collection[str] = ROLES) -> tuple[Topic, ...]:
        """Topics that a role acts on in a run of these roles; for the recorder every logged one.

        Raises UnknownRoleError.
        """
        _check_role(role)
        rows = (row for row in self.rows if row.is_in(participants))
        if role == "recorder":
            return tuple(row for row in rows if row.logged)
        return tuple(row for row in rows if role in row.subscribers)

    def for_things(self, things: Mapping[str, Sequence[str]]) -> "TopicTable":
        """The table of a machine with these things, names by kind: a row that stands once for each thing of a kind has
        further ones behind it, from the second thing on; one with `all_named` gives way to those of all.

        Raises TopicNameError.
        """
        found = self.joined_with(
            of_thing(row, name) for row in self.rows for name in things.get(row.each, ())[0 if row.all_named else 1 :]
        )
        return TopicTable(row for row in found if row.thing or not row.all_named)

    def heard_by(self, name: str, roles: Collection[str]) -> "TopicTable":
        """The table in which these roles hear a topic besides those that do anyway. Raises UnknownTopicError."""
        row = self.topic(name)
        if set(roles) <= set(row.subscribers):
            return self
        listeners = tuple(role for role in ROLES if role in row.subscribers or role in roles)
        return TopicTable(replace(row, subscribers=listeners) if other is row else other for other in self.rows)

    def delivered(self, rows: Iterable[Topic]) -> "TopicTable":
        """The table with these, which have a delivery, in the places of those that have their names.

        Who listens to one of them goes by the clock: no message tells him that a period has begun.
        """
        others = {row.name: row for row in rows if row.delivery is not None}
        if not others:
            return self
        listeners = {role for row in others.values() for role in row.subscribers}
        clock = self.topic(CLOCK)
        others[CLOCK] = replace(clock, subscribers=tuple(role for role in ROLES if role in listeners))
        return TopicTable(others.get(row.name, row) for row in self.rows)

    def on_demand(self, names: Collection[str]) -> "TopicTable":
        """The table in which the rows of these names are said only while somebody outside of the run listens."""
        if not names:
            return self
        return TopicTable(replace(row, logged=False, on_demand=True) if row.name in names else row for row in self.rows)

    def joined_with(self, rows: Iterable[Topic]) -> "TopicTable":
        """The table with further rows: of a further thing behind that of the thing before it, others behind the last
        one of their publisher. Raises TopicNameError.
        """
        found = list(self.rows)
        for row in rows:
            first = row.name.removesuffix(f"/{row.thing}")
            alike = [place for place, other in enumerate(found) if other.name.removesuffix(f"/{other.thing}") == first]
            places = alike or [place for place, other in enumerate(found) if other.publisher == row.publisher]
            found.insert(places[-1] + 1 if places else len(found), row)
        return TopicTable(found)


def of_thing(row: Topic, name: str) -> Topic:
    """The row of a further thing: `/bus/state` of the store `spare` is `/bus/state/spare`."""
    return replace(row, name=f"{row.name}/{name}", thing=name)


def _check_role(role: str) -> None:
    if role not in ROLES:
        raise UnknownRoleError(role, ROLES)
