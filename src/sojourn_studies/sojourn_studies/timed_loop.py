"""The whole loop of a scenario, all roles in one process, second by second: for benches that set one beside another."""

from collections.abc import Callable, Sequence
from pathlib import Path

from sojourn_config.scenario import load_scenario
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_contract.topics import ROLES
from sojourn_contract.unfinished import finish_all
from sojourn_operator.scenario_steps import absent_roles
from sojourn_stack.run import RunSpec, begun

TURN = round(1.0 / CONTROL_PERIOD_S)
"""Periods of a turn, a second of simulated time."""


class TimedLoop:
    """A run and where it has come to.

    Args:
        name, overrides: of the scenario. clock: what counts, as `time.process_time` [s].
        bag: folder that a recorder writes; None: the run has no recorder.
        ahead: periods before the first turn.
    """

    def __init__(
        self,
        name: str,
        overrides: Sequence[str],
        clock: Callable[[], float],
        bag: Path | None = None,
        ahead: int = 0,
    ) -> None:
        scenario = load_scenario(name, overrides)
        absent = (*absent_roles(scenario), "recorder") if bag is None else absent_roles(scenario)
        roles = tuple(role for role in ROLES if role not in absent)
        spec = RunSpec(name, roles, tuple(overrides), bag, scenario)
        self._clock = clock
        self._stack, self._state, said, self._recorder = begun(spec)
        if self._recorder is not None:
            self._recorder.take(said)
        self._go_on(ahead, "")

    def turn(self, awaited: str = "") -> tuple[float, bool]:
        """Another second: what it took [s], until all is made that was begun in it, and whether something was said in
        it on an awaited topic.
        """
        begin = self._clock()
        heard = self._go_on(TURN, awaited)
        finish_all()
        return self._clock() - begin, heard

    def _go_on(self, periods: int, awaited: str) -> bool:
        heard = False
        for _ in range(periods):
            self._state, said = self._stack.step(self._state)
            if self._recorder is not None:
                self._recorder.take(said)
            heard = heard or any(row.name == awaited for row, _ in said)
        return heard

    def end(self) -> None:
        """Close the bag."""
        if self._recorder is not None:
            self._recorder.take(self._stack.farewells(self._state))
            self._recorder.finish()
