"""The table of a run with a link to Earth, and what of the machine's telemetry goes over it."""

from collections.abc import Iterator

from sojourn_contract.errors import LinkError
from sojourn_contract.link_topics import CANCEL, COMMANDS, LINK_STATUS, OPERATOR, on_earth
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_machine.names import names_text
from sojourn_machine.transport_fault import ON_BOARD
from sojourn_physics.link.params import STATUSES, LinkParams, TelemetryParams


def linked(table: TopicTable, link: LinkParams) -> TopicTable:
    """The table of a run with a link. Raises LinkError for telemetry that it cannot carry."""
    carried = [row for row, _ in telemetry(table, link)]
    rows = [LINK_STATUS, CANCEL, *map(on_earth, COMMANDS.values()), *map(on_earth, carried)]
    for row in carried:
        table = table.heard_by(row.name, (OPERATOR,))
    return table.joined_with(rows)


def telemetry(table: TopicTable, link: LinkParams) -> Iterator[tuple[Topic, TelemetryParams]]:
    """What goes to the Earth: the row, and how. Raises LinkError."""
    if link.telemetry is None:
        for priority, name in enumerate(STATUSES, 1):
            for row in table.each(name):
                yield row, TelemetryParams(topic=row.name, priority=priority)
        return
    # what the plant says is the truth, which no machine knows, and heartbeats are of the run
    able = [row.name for row in table if not row.is_event and row.publisher in ON_BOARD]
    for place, one in enumerate(link.telemetry):
        if one.topic not in able:
            raise LinkError(("telemetry", place, "topic"), one.topic, names_text(one.topic, able))
        yield table.topic(one.topic), one
