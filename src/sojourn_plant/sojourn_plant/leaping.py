"""When the plant's clock leaps, and how far.

It may while the machine rests, what moves it is told the same, and the operator's tick says that no goal is on its way
and until when none will be sent. A leap begins at a whole second and lands where every topic of the run is due, before
the operator goes on or lets something fail. The first is as short as it can be, and so is one after a load has been
switched, so that the power manager is heard soon; each one after it may be twice as long.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sojourn_contract.arrival import TICK
from sojourn_contract.events import rests_until
from sojourn_contract.leaps import BEGIN, landing_grid
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topic_table import TopicTable
from sojourn_machine.params import FloatArray
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.rest import RESTLESS, Rest, is_told_the_same, rest_after
from sojourn_physics.plant.state import PlantCommand, PlantOutput, PlantState


@dataclass(frozen=True, eq=False, slots=True)
class LeapState:
    """What is remembered of rest and leaps."""

    rest: Rest = RESTLESS
    span: int = 0
    """Control periods of the last leap at most; 0 where none comes before this period."""
    switches: FloatArray | None = None
    """Of the last period, (loads,) [1]."""


class Leaping:
    """The leaps of a run.

    Args:
        table: its topics.
    """

    def __init__(self, table: TopicTable) -> None:
        self.grid, self._longest = landing_grid(table), table.longest_leap

    def steps(
        self, model: PlantModel, state: LeapState, command: PlantCommand, stamp: int, inputs: Mapping[str, Any]
    ) -> tuple[int, ...]:
        """Control periods of the long steps that begin at a stamp [ns] with a command, after what has been heard; none
        where the next period is to be stepped.
        """
        now, tick, rest = stamp // CONTROL_PERIOD_NS, inputs.get(TICK), state.rest
        if now % BEGIN or tick is None or not rest.is_deep or rest.told is None:
            return ()
        if not is_told_the_same(model, rest.told, command):
            return ()
        rests = rests_until(tick.frame) * NANOSECONDS // CONTROL_PERIOD_NS
        span = self._span(state, command)
        longest = now // span * span + span  # at even times, which those who look ahead have seen before
        last = min(rests, longest)
        landings = range((now // self.grid + 1) * self.grid, last + 1, self.grid)
        return tuple(landing - max(now, landing - self.grid) for landing in landings)

    def after_leap(self, state: LeapState, command: PlantCommand, output: PlantOutput) -> LeapState:
        """After one."""
        rest = Rest(state.rest.periods, command, output)
        return LeapState(rest, self._span(state, command), command.load_fractions)

    def after_step(
        self, model: PlantModel, state: LeapState, machine: PlantState, command: PlantCommand, output: PlantOutput
    ) -> LeapState:
        """After a control period that was stepped."""
        return LeapState(rest_after(model, state.rest, machine, command, output), 0, command.load_fractions)

    def _span(self, state: LeapState, command: PlantCommand) -> int:
        """Control periods of a leap at most."""
        before = state.switches
        switched = before is None or ((before > 0.0) != (command.load_fractions > 0.0)).any()
        return self.grid if switched or not state.span else min(2 * state.span, self._longest)
