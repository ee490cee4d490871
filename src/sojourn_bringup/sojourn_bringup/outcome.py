"""How a run ended."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from sojourn_operator.script import StepResult

SUCCEEDED, FAILED, INTERRUPTED = 0, 1, 130


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

    Args:
        status: what the script exits with: 0 done, 1 failed, 130 interrupted before the operator was through.
        message: one sentence. results: what became of the operator's steps. sim_time_s: simulation time at the end [s].
        wall_time_s: wall time of the run, without the start-up [s].
    """

    status: int
    message: str
    results: tuple[StepResult, ...] = field(default=())
    sim_time_s: float = 0.0
    wall_time_s: float = 0.0

    def judged(self, results: Sequence[StepResult], steps: int) -> "Outcome":
        """The same outcome with the operator's results, and failed where a step was not carried out."""
        bad = next((result for result in results if not result.good), None)
        outcome = replace(self, results=tuple(results))
        if self.status != SUCCEEDED:
            return outcome
        if bad is not None:
            reason = f" ({bad.reason})" if bad.reason else ""
            return replace(outcome, status=FAILED, message=f"the goal was not met: {bad.step}: {bad.outcome}{reason}")
        if len(results) < steps:
            return replace(outcome, status=FAILED, message=f"the run ended after {len(results)} of {steps} steps")
        return outcome


class RunStopwatch:
    """Wall time since simulation time has moved, and the real-time factor since then."""

    def __init__(self) -> None:
        self._start: tuple[float, float] | None = None
        self.wall_s = 0.0
        self.speed = 0.0

    @property
    def began_at(self) -> float:
        """Wall time (monotonic) at which simulation time was first seen to move [s]; 0 before."""
        return self._start[1] if self._start is not None else 0.0

    def look(self, sim_s: float, now: float) -> None:
        """Simulation time and wall time now [s]."""
        if self._start is None:
            if sim_s > 0.0:
                self._start = (sim_s, now)
            return
        self.wall_s = now - self._start[1]
        if self.wall_s > 0.0:
            self.speed = (sim_s - self._start[0]) / self.wall_s
