"""When checkpoints of a run are due: at even times, and when somebody asks."""

from collections.abc import Collection
from math import lcm

from sojourn_contract.barrier import Barrier, awaited_inputs
from sojourn_contract.topic_table import TopicTable


class EvenTimes:
    """Each time that so much simulation time has passed.

    Args:
        every_s: from one to the next [s]. begun_s: simulation time at which it looks for the first time [s].
    """

    def __init__(self, every_s: float, begun_s: float = 0.0) -> None:
        self._every_s = every_s
        self._passed = self._count(begun_s)

    def is_due(self, now: float) -> bool:
        """Whether one is wanted of a simulation time [s]."""
        return self._count(now) != self._passed

    def passed(self, now: float) -> None:
        """One is kept of a simulation time [s]."""
        self._passed = self._count(now)

    def _count(self, now: float) -> int:
        return int(now / self._every_s + 1e-9)


def common_grid(participants: Collection[str], table: TopicTable) -> int:
    """Control periods from one in which every role acts to the next; the recorder's state is no part of a run's."""
    present = [role for role in participants if role != "recorder"]
    return lcm(*(Barrier(awaited_inputs(role, present, table), role == "plant").stride for role in present))
