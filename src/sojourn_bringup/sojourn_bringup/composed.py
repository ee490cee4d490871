"""Runs all nodes in this process, on one executor."""

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import rclpy
from rclpy.signals import SignalHandlerOptions

from sojourn_bags.errors import BagsError
from sojourn_bags.onset import RecordBeginning
from sojourn_bags.recording import RECORDER
from sojourn_bringup.checkpoints import keeper_of
from sojourn_bringup.composed_checkpoints import ComposedKeeper, OverheardNeighbours
from sojourn_bringup.health import Health, Progress
from sojourn_bringup.outcome import FAILED, INTERRUPTED, SUCCEEDED, Outcome, RunStopwatch
from sojourn_bringup.plan import RunPlan
from sojourn_bringup.process_table import process
from sojourn_bringup.resumption import beginning, go_on
from sojourn_bringup.run_folder import FolderWatch
from sojourn_bringup.screen import Screen
from sojourn_config.command_errors import CommandError
from sojourn_config.errors import ConfigError
from sojourn_config.ros_environment import ros_variables
from sojourn_contract import process as node_process
from sojourn_contract.errors import ContractError
from sojourn_contract.heartbeat import ENDED, READY, RUNNING, WAITING_TO_MATCH
from sojourn_contract.neighbours import Neighbours
from sojourn_contract.node import ContractNode
from sojourn_contract.stamps import seconds
from sojourn_contract.stop_flag import StopFlag
from sojourn_machine.errors import MachineError
from sojourn_stack.errors import StackError

_SHOW_S = 0.25


class ComposedRun:
    """One run in this process.

    Args:
        plan: the run; it starts all of its participants. screen: where to show it.
        load: class of a role's node; the process table's unless a test brings its own.
    """

    def __init__(
        self, plan: RunPlan, screen: Screen, load: Callable[[str], Any] = lambda role: process(role).load_class()
    ) -> None:
        self.plan = plan
        self.screen = screen
        self.nodes: dict[str, Any] = {}
        self._load = load
        self._health = {role: Health(role, pid=os.getpid()) for role in reversed(plan.in_order_of_stop())}
        self._progress = Progress()
        self.stopwatch = RunStopwatch()
        self._shown_at = 0.0
        self._started_at = 0.0
        self._not_started = ""
        self._folder = FolderWatch(plan.run_dir)
        self._folder_gone = ""

    def run(self) -> Outcome:
        """Run to the end. Returns how it ended."""
        os.environ.update(ros_variables(self.plan.domain, self.plan.on_network))
        stop = StopFlag().install()
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        try:
            for role in self.plan.in_order_of_stop():
                if stop.is_set:
                    return Outcome(INTERRUPTED, "interrupted before the run began")
                self.nodes[role] = self._load(role)(
                    overrides=self.plan.parameters(role), namespace=self.plan.namespace or None, **self._beginning(role)
                )
            if self.plan.begin is not None:
                go_on(self.nodes, self.plan.begin)
            self._started_at = time.monotonic()
            nodes = list(self.nodes.values())
            neighbours = None if self.plan.realtime else self._neighbours(nodes)
            node_process.spin(nodes, stop, self._each_poll, neighbours=neighbours)
            return self._outcome(stop)
        except (CommandError, BagsError, ContractError, ConfigError, MachineError, StackError, OSError) as error:
            return Outcome(FAILED, str(error), sim_time_s=self._time_s(), wall_time_s=self.stopwatch.wall_s)
        finally:
            for node in self.nodes.values():
                node.destroy_node()
            rclpy.try_shutdown()

    def _beginning(self, role: str) -> dict[str, RecordBeginning]:
        """What the recorder of a run that goes on is given besides."""
        begin = self.plan.begin
        if begin is None or role != RECORDER:
            return {}
        return {"beginning": beginning(begin, self.nodes["plant"].scenario)}

    def _neighbours(self, nodes: Sequence[ContractNode]) -> Neighbours:
        """What they say to each other, overheard where checkpoints are to be kept."""
        keeper = keeper_of(self.plan, self.nodes["plant"].scenario)
        if keeper is None:
            return Neighbours(nodes)
        composed = ComposedKeeper(self.nodes, keeper, self.plan.begin)
        self.nodes["plant"].keep_with(composed)
        return OverheardNeighbours(nodes, composed.words)

    def _outcome(self, stop: StopFlag) -> Outcome:
        operator = self.nodes.get("operator")
        ended = Outcome(SUCCEEDED, "the run ended", sim_time_s=self._time_s(), wall_time_s=self.stopwatch.wall_s)
        if self._not_started:
            return Outcome(FAILED, self._not_started)
        if self._folder_gone:
            return replace(ended, status=FAILED, message=self._folder_gone)
        if stop.is_set:
            return Outcome(
                SUCCEEDED if operator is None else INTERRUPTED,
                "interrupted",
                sim_time_s=ended.sim_time_s,
                wall_time_s=ended.wall_time_s,
            )
        judged = ended if operator is None else ended.judged(operator.results, len(operator.app.script.steps))
        # the operator fails where a step does, which `judged` has said better
        failed = [role for role, node in self.nodes.items() if node.exit_status and role != "operator"]
        if failed:
            reasons = "; ".join(f"{role} failed" + _reason(self.nodes[role]) for role in failed)
            return replace(judged, status=FAILED, message=reasons)
        return judged

    def _time_s(self) -> float:
        return seconds(max((node.now for node in self.nodes.values()), default=0))

    def _each_poll(self) -> bool:
        """Show the run; True ends it, where it has not started in time."""
        now = time.monotonic()
        self.stopwatch.look(self._time_s(), now)
        if now - self._shown_at < _SHOW_S:
            return False
        self._shown_at = now
        for role, node in self.nodes.items():
            self._update(self._health[role], node)
        self._progress.stamp = max(node.now for node in self.nodes.values())
        self._progress.speed = self.stopwatch.speed
        operator = self.nodes.get("operator")
        if operator is not None:
            self._progress.hear_operator(operator.heartbeat_values())
            self._progress.hear_drive(operator.state.drive_status)
        self.screen.show(list(self._health.values()), self._progress)
        if self._progress.stamp == 0 and now - self._started_at > self.plan.start_timeout_s:
            unmatched = [text for node in self.nodes.values() for text in node.unmatched()]
            self._not_started = f"not ready within {self.plan.start_timeout_s:g} s (--start-timeout): " + "; ".join(
                unmatched
            )
        self._folder_gone = self._folder.why_gone()
        return bool(self._not_started or self._folder_gone)

    def _update(self, health: Health, node: ContractNode) -> None:
        health.stamp = node.now
        health.refused = sum(node.counters.refused.values())
        health.last_refusal = node.counters.last_refusal
        health.values = node.heartbeat_values()
        if node.finished:
            health.state = ENDED
        elif node.now:
            health.state = RUNNING
        else:
            health.state = WAITING_TO_MATCH if node.unmatched() else READY


def _reason(node: ContractNode) -> str:
    """What a node says of its failure, if it says it."""
    text = str(getattr(node, "failure", "") or "")
    return f": {text}" if text else ""
