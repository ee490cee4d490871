"""Order of the topics in the flow of data through one control period, from the plant outwards.

It follows from the table: whoever waits for a message of a period comes after its publisher. The plant begins
a period, and what comes back to it counts for the next one. A goal is stamped with the period in which it
takes effect, so it stands just before the node that it is for. Heartbeats tell of what has been done, and
stand last. Of two runs that differ at one stamp in several topics, the first in this order is the cause, as
far as messages can tell.
"""

from collections.abc import Sequence

from sojourn_contract.run_table import row_named
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import ROLES, STANDARD, TOPICS

FIRST = "plant"


def role_order(topics: Sequence[Topic] = TOPICS) -> tuple[str, ...]:
    """Roles in the order in which a period passes through them; among equals as in the topic table."""
    publishers = dict.fromkeys((FIRST, *(row.publisher for row in topics if row.publisher in ROLES)))
    waits_for: dict[str, set[str]] = {role: set() for role in publishers}
    for row in topics:
        if row.is_event or row.lag or row.publisher not in publishers:
            continue
        listeners = (*row.subscribers, "recorder") if row.logged else row.subscribers
        for role in listeners:
            if role in waits_for and role not in (row.publisher, FIRST):
                waits_for[role].add(row.publisher)
    order: list[str] = []
    while waits_for:
        # in a table with a circle nobody is free: then the table's own order decides
        free = next((role for role, needed in waits_for.items() if needed <= set(order)), next(iter(waits_for)))
        order.append(free)
        del waits_for[free]
    return tuple(order)


def topic_order(topics: Sequence[Topic] = TOPICS) -> tuple[str, ...]:
    """Names of the topics in the order of the flow."""
    roles = role_order(topics)

    def place(row: Topic) -> tuple[float, int]:
        number = topics.index(row)
        if row.publisher not in roles:
            return float(len(roles)), number
        if row.is_event and row.subscribers:
            return min(roles.index(role) for role in row.subscribers if role in roles) - 0.5, number
        return float(roles.index(row.publisher)), number

    return tuple(row.name for row in sorted(topics, key=place))


_PLACES = {name: place for place, name in enumerate(topic_order())}


def place_of(topic: str) -> int:
    """Place of a topic in the flow. One of a further thing has that of the first, one that the machine of a run brings
    that of the last of the same publisher; one that no run has (/tf) comes after all others.
    """
    place = _PLACES.get(topic)
    if place is not None:
        return place
    row = row_named(topic)
    if row is None:
        return len(_PLACES)
    first = topic.removesuffix(f"/{row.thing}")
    return _PLACES.get(first, max(_PLACES[other.name] for other in STANDARD if other.publisher == row.publisher))
