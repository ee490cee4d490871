"""Topics that every run has and that no sensor of this run's machine speaks on: others wait for them."""

from collections.abc import Iterable, Sequence

from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_machine.sensor_choice import SENSORS, SensorParams


def absent_kinds(table: TopicTable, spoken: Iterable[Sequence[Topic]]) -> list[tuple[Topic, type[SensorParams]]]:
    """Rows of the role that are not among those spoken on, each with the kind that knows what to say there."""
    names = {row.name for rows in spoken for row in rows}
    silent = [row for row in table if row.publisher == "sensors" and row.name not in names]
    return [(row, SENSORS.get(row.each)) for row in silent]
