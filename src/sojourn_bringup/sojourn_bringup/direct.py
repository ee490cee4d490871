"""Runs all roles in this process without middleware: scripts/start.py --direct."""

import os
import time
from dataclasses import replace

from sojourn_bags.errors import BagsError
from sojourn_bringup.checkpoints import keeper_of
from sojourn_bringup.health import Health, Progress
from sojourn_bringup.outcome import FAILED, INTERRUPTED, SUCCEEDED, Outcome, RunStopwatch
from sojourn_bringup.plan import RunPlan
from sojourn_bringup.run_folder import FolderWatch
from sojourn_bringup.screen import Screen
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.errors import ContractError
from sojourn_contract.heartbeat import RUNNING
from sojourn_contract.stamps import seconds
from sojourn_contract.stop_flag import StopFlag
from sojourn_machine.errors import MachineError
from sojourn_stack.errors import StackError
from sojourn_stack.run import RunSpec, run
from sojourn_stack.stack import StackState

_SHOW_S = 0.25


class DirectRun:
    """One run.

    Args:
        plan: the run; all of its participants are in this process. screen: where to show it.
    """

    def __init__(self, plan: RunPlan, screen: Screen) -> None:
        self.plan = plan
        self.screen = screen
        self.stopwatch = RunStopwatch()
        self._progress = Progress()
        self._folder = FolderWatch(plan.run_dir)
        self._shown_at = 0.0
        self._folder_gone = ""
        self._scenario = plan.loaded or load_scenario(plan.scenario, plan.overrides)
        self._steps = len(self._scenario.config.steps)
        self._keeper = keeper_of(plan, self._scenario)
        self._has_operator = "operator" in plan.participants

    def run(self) -> Outcome:
        """Run to the end. Returns how it ended."""
        self._stop = StopFlag().install()
        bag = self.plan.bag() if "recorder" in self.plan.participants else None
        plan = self.plan
        spec = RunSpec(plan.scenario, plan.participants, plan.overrides, bag, self._scenario, plan.begin)
        try:
            result = run(spec, self._goes_on)
        except (StackError, BagsError, ContractError, ConfigError, MachineError, OSError) as error:
            return Outcome(FAILED, str(error), sim_time_s=self._progress.time_s, wall_time_s=self.stopwatch.wall_s)
        now = seconds(result.state.now)
        self.stopwatch.look(now, time.monotonic())
        ended = Outcome(SUCCEEDED, "the run ended", sim_time_s=now, wall_time_s=self.stopwatch.wall_s)
        if self._folder_gone:
            return replace(ended, status=FAILED, message=self._folder_gone)
        if self._stop.is_set:
            return replace(ended, status=INTERRUPTED if self._has_operator else SUCCEEDED, message="interrupted")
        if result.completeness is not None and result.completeness.gaps:
            reason = f"recorder failed: the bag {bag} is not complete: {result.completeness.explain()}"
            return replace(ended, status=FAILED, message=reason)
        return ended.judged(result.steps, self._steps) if self._has_operator else ended

    def _goes_on(self, state: StackState) -> bool:
        """Show the run some times a second, keep checkpoints of it; False ends it."""
        if self._keeper is not None:
            self._keeper.look(state)
        now = time.monotonic()
        self.stopwatch.look(seconds(state.now), now)
        if now - self._shown_at >= _SHOW_S:
            self._shown_at = now
            self._show(state)
            self._folder_gone = self._folder.why_gone()
        # without an operator nobody else looks at the limit, and nobody can end the run over a topic
        is_over = not self._has_operator and seconds(state.now) >= self._scenario.config.duration_limit_s
        return not (self._stop.is_set or self._folder_gone or is_over)

    def _show(self, state: StackState) -> None:
        self._progress.stamp, self._progress.speed = state.now, self.stopwatch.speed
        nodes = []
        for role, one in state.roles.items():
            refused = sum(one.refused.values())
            nodes.append(
                Health(role, os.getpid(), RUNNING, stamp=one.now, refused=refused, last_refusal=one.last_refusal)
            )
            if role == "operator":
                self._progress.hear_operator({"steps done": f"{len(one.app.script.results)} of {self._steps}"})
                self._progress.hear_drive(one.app.drive_status)
        self.screen.show(nodes, self._progress)
