"""Runs each node as a process: starts, watches, restarts what may be restarted, and leaves nothing behind."""

import json
import os
import signal
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from sojourn_bringup.access import SUPERVISOR
from sojourn_bringup.child import STOP_S, Child, command_of, environment_of
from sojourn_bringup.forked import ForkRequest, ForkServer
from sojourn_bringup.health import DEAD, RESTARTING, STOPPED, Health
from sojourn_bringup.monitor import Monitor
from sojourn_bringup.outcome import FAILED, INTERRUPTED, SUCCEEDED, Outcome, RunStopwatch
from sojourn_bringup.plan import RunPlan
from sojourn_bringup.plant_time import PlantTime
from sojourn_bringup.process_table import process
from sojourn_bringup.run_folder import FolderWatch
from sojourn_bringup.screen import Screen
from sojourn_bringup.shadows import Shadows
from sojourn_bringup.standby import ROLE as RECORDER
from sojourn_bringup.standby import Standby
from sojourn_config.ros_environment import ros_variables
from sojourn_contract.heartbeat import ENDED
from sojourn_contract.stamps import NANOSECONDS, seconds
from sojourn_contract.stop_flag import StopFlag
from sojourn_operator.script import StepResult, results_from_data

if TYPE_CHECKING:  # it needs all roles, which start elsewhere
    from sojourn_bringup.process_checkpoints import ProcessCheckpoints

LOOK_S = 0.05
"""Wall time between two looks at the processes: a dead one is noticed within this."""
MAX_RESTARTS = 3
RESTARTS_WITHIN_S = 30.0


class Supervisor:
    """One run as processes.

    Args:
        plan: the run. screen: where to show it. server: makes the nodes that are ours, as copies of itself; without
        one each starts by itself. security: variables of a run that is secured, see `secure`.
    """

    def __init__(
        self,
        plan: RunPlan,
        screen: Screen,
        server: ForkServer | None = None,
        security: Mapping[str, str] | None = None,
    ) -> None:
        self.plan = plan
        self.screen = screen
        self.nodes = {role: Health(role) for role in reversed(plan.in_order_of_stop())}
        for role in plan.participants:
            self.nodes.setdefault(role, Health(role, detail="not started here"))
        self.children: dict[str, Child] = {}
        self._ros = {**ros_variables(plan.domain, plan.on_network), **(security or {})}
        self._deaths: dict[str, deque[float]] = {role: deque() for role in plan.started}
        self.shadows = Shadows(plan, screen, self._ros)
        self._standby = Standby(plan, self._ros)
        self.stopwatch = RunStopwatch()
        self._logs = plan.run_dir / "logs"
        self._server = server
        self._folder = FolderWatch(plan.run_dir)
        self._checkpoints = checkpoints_of(plan, self.nodes, screen.say)

    def run(self) -> Outcome:
        """Start, watch and stop. Returns how the run ended; no process is left whatever happens."""
        os.environ.update(self._ros)
        self._logs.mkdir(exist_ok=True)
        stop = StopFlag().install()
        signal.signal(signal.SIGHUP, signal.getsignal(signal.SIGINT))
        enclave = self.plan.enclave_arguments(SUPERVISOR)
        monitor = Monitor(self.plan.namespace, self.nodes, time_of(self.plan), enclave)
        with monitor as self._monitor:
            try:
                if self._checkpoints is not None:
                    self._checkpoints.join(self._monitor)
                outcome = self._wait_for_shadows(stop) or self._start_and_watch(stop)
                if outcome.status == FAILED:
                    self.screen.say(f"stopping: {outcome.message}")
            finally:
                stop.is_set = False
                self._stop_all(stop)
                self.shadows.finish()
        return self._after_the_end(outcome)

    def _wait_for_shadows(self, stop: StopFlag) -> Outcome | None:
        """Shadows come first: they must not miss the beginning of the run. None once all are ready."""
        self.shadows.start()
        end = time.monotonic() + self.plan.start_timeout_s
        while (waiting := self.shadows.not_ready()) and not stop.is_set:
            self._monitor.spin(LOOK_S)
            self.shadows.look()
            if time.monotonic() > end:
                return self._outcome(
                    FAILED,
                    f"not ready within {self.plan.start_timeout_s:g} s (--start-timeout): shadow of {waiting[0]}",
                )
        failure = self.shadows.failure()
        return self._outcome(FAILED, failure) if failure else None

    def _start_and_watch(self, stop: StopFlag) -> Outcome:
        end = time.monotonic() + self.plan.start_timeout_s
        while self._server is not None and not self._server.is_loaded() and not stop.is_set:
            self._monitor.spin(LOOK_S)
            if time.monotonic() > end:
                return self._outcome(FAILED, f"not loaded within {self.plan.start_timeout_s:g} s (--start-timeout)")
        for role in () if stop.is_set else self.nodes:
            if role in self.plan.started:
                self._start(role)
        return self._watch(stop)

    def _start(self, role: str) -> None:
        attempt, log = self.nodes[role].restarts, self._logs / f"{role}.log"
        environment = environment_of(self.plan, role, self._ros)
        copy = None
        if self._server is not None and role not in self.plan.replacements:
            arguments = self.plan.ros_arguments(role, attempt)
            request = ForkRequest(process(role).module, arguments, str(log), environment, title=f"sojourn_{role}")
            copy = self._server.fork(request)
        if copy is not None:
            child = Child(role, copy, log)
        else:
            child = Child.of_command(role, command_of(self.plan, role, attempt), environment, log)
        self.children[role], self.nodes[role].pid = child, child.pid

    def _start_again(self, role: str) -> None:
        """In real time; of the recorder the one that waits."""
        child = self._standby.take() if role == RECORDER else None
        if child is None:
            self._start(role)
        else:
            self.children[role], self.nodes[role].pid = child, child.pid

    def _watch(self, stop: StopFlag) -> Outcome:
        """Until the run has ended, failed or been interrupted."""
        started_at = time.monotonic()
        while not stop.is_set:
            self._look(LOOK_S)
            if self._monitor.progress.stamp and RECORDER in self.nodes:
                self._standby.prepare(self.nodes[RECORDER].restarts + 1)
            statuses = self._statuses()
            outcome = (
                self._ended(statuses) or self._folder_gone() or self._checkpoints_failed() or self._failed(statuses)
            )
            if outcome is not None:
                return outcome
            if time.monotonic() - started_at > self.plan.start_timeout_s and self._monitor.progress.stamp == 0:
                return self._outcome(FAILED, self._why_not_started())
        finished = "operator" not in self.plan.participants
        return self._outcome(SUCCEEDED if finished else INTERRUPTED, "interrupted")

    def _look(self, wait_s: float) -> None:
        """Take heartbeats for a moment and show them."""
        self._monitor.spin(wait_s)
        now = time.monotonic()
        progress = self._monitor.progress
        self.stopwatch.look(progress.time_s, now)
        progress.speed = self.stopwatch.speed
        for role, node in self.nodes.items():
            node.look(now, self.plan.realtime)
            if role in self.children:
                self._notice_stop(node, self.children[role])
                node.memory_mb = self.children[role].memory_mb()
                node.peak_memory_mb = max(node.peak_memory_mb, node.memory_mb)
        if self._checkpoints is not None:
            self._checkpoints.look()
        self.screen.show(list(self.nodes.values()), progress)
        self.shadows.look()

    def _notice_stop(self, node: Health, child: Child) -> None:
        """A process that is held is the root of what the others wait for."""
        if not child.is_stopped:
            if node.state == STOPPED:
                node.state, node.detail = RESTARTING, "it goes on"
        elif node.state != STOPPED:
            node.stop()
            self.screen.say(f"{node.role} (process {child.pid}) is stopped: {node.detail}")

    def _statuses(self) -> dict[str, int | None]:
        """Of the processes, taken once in a look, so that a plant that ends in the midst of it has not died in it; of
        the plant last, for others may end with it."""
        return {role: self.children[role].status for role in sorted(self.children, key="plant".__eq__)}

    def _ended(self, statuses: Mapping[str, int | None]) -> Outcome | None:
        """The plant ends a run."""
        if statuses["plant"] == 0 if "plant" in statuses else self.nodes["plant"].state == ENDED:
            return self._outcome(SUCCEEDED, "the run ended")
        return None

    def _folder_gone(self) -> Outcome | None:
        gone = self._folder.why_gone()
        return self._outcome(FAILED, gone) if gone else None

    def _checkpoints_failed(self) -> Outcome | None:
        failure = "" if self._checkpoints is None else self._checkpoints.failure
        return self._outcome(FAILED, failure) if failure else None

    def _failed(self, statuses: Mapping[str, int | None]) -> Outcome | None:
        """Look for dead processes; restart one where that is allowed, else say which ended the run."""
        for role in [role for role, status in statuses.items() if status is not None]:
            child, node = self.children[role], self.nodes[role]
            how = child.how_it_ended()
            child.sweep()
            node.state, node.detail = DEAD, how
            words = f"{role} (process {child.pid}) {how}"
            if role == "plant":
                if not self._monitor.progress.stamp and (unready := self._unready()):
                    words += f"; not ready: {unready}"
                held = [
                    f"{other.role} (process {other.pid})" for other in self.nodes.values() if other.state == STOPPED
                ]
                words += f"; stopped by a signal: {', '.join(held)}" if held else ""
                return self._outcome(FAILED, words)
            if not node.heard_at:
                return self._outcome(FAILED, f"{words}; it had never sent a heartbeat (log: {child.log})")
            if not self.plan.realtime:
                at = seconds(self._monitor.progress.stamp)
                return self._outcome(
                    FAILED, f"{words} after {at:.0f} s of simulation: lock-step cannot go on without it"
                )
            if not process(role).restartable or self._restarts_too_often(role):
                return self._outcome(FAILED, f"{words}, and is not started again")
            node.begin_again()
            self._start_again(role)
            self.screen.say(f"{words}: started again as process {node.pid}")
        return None

    def _restarts_too_often(self, role: str) -> bool:
        now, deaths = time.monotonic(), self._deaths[role]
        deaths.append(now)
        while deaths and now - deaths[0] > RESTARTS_WITHIN_S:
            deaths.popleft()
        return len(deaths) > MAX_RESTARTS

    def _why_not_started(self) -> str:
        return f"not ready within {self.plan.start_timeout_s:g} s (--start-timeout): {self._unready() or 'plant'}"

    def _unready(self) -> str:
        """Nodes that are not ready and why, in words."""
        waiting = [node for node in self.nodes.values() if not node.is_ready and node.state != DEAD]
        return ", ".join(f"{node.role} ({node.detail or node.state})" for node in waiting)

    def _outcome(self, status: int, message: str) -> Outcome:
        return Outcome(status, message, sim_time_s=self._monitor.progress.time_s, wall_time_s=self.stopwatch.wall_s)

    def _stop_all(self, stop: StopFlag) -> None:
        """The plant first, the recorder last; a second Ctrl-C kills at once."""
        self._standby.end()
        for roles in (("plant",), set(self.children) - {"plant", "recorder"}, ("recorder",)):
            self._stop([child for role, child in self.children.items() if role in roles], stop)
        self._look(LOOK_S)  # at what they said last

    def _stop(self, children: list[Child], stop: StopFlag) -> None:
        try:
            for child in children:
                if child.status is None:
                    child.send(signal.SIGINT)
            end = time.monotonic() + STOP_S
            while any(child.status is None for child in children) and time.monotonic() < end and not stop.is_set:
                self._look(0.02)
        finally:
            for child in children:
                if child.status is None:
                    self.screen.say(f"{child.role} (process {child.pid}) does not stop: killed")
                    child.send(signal.SIGKILL)
                    child.wait(STOP_S)
                child.sweep()

    def _after_the_end(self, outcome: Outcome) -> Outcome:
        """Judge by the operator's results and by the recorder's proof that nothing is missing."""
        # the last heartbeats, which come while the nodes stop, know the time of the end
        outcome = replace(outcome, sim_time_s=self._monitor.progress.time_s)
        outcome = outcome.judged(self._operator_results(), self._monitor.progress.steps)
        recorder = self.children.get("recorder")
        if outcome.status == SUCCEEDED and recorder is not None and recorder.status:
            return self._outcome(FAILED, f"recorder {recorder.how_it_ended()}")
        return outcome

    def _operator_results(self) -> list[StepResult]:
        file = self.plan.result_file
        if "operator" not in self.plan.participants or not file.is_file():
            return []
        return results_from_data(json.loads(file.read_text(encoding="utf-8")))


def time_of(plan: RunPlan) -> PlantTime:
    """Of a run, before it begins."""
    leaps = None if plan.loaded is None else plan.loaded.leaps
    longest = 0 if leaps is None else int(leaps.longest_s * NANOSECONDS)
    return PlantTime(0 if plan.begin is None else plan.begin.now, longest, plan.realtime)


def checkpoints_of(
    plan: RunPlan, nodes: Mapping[str, Health], say: Callable[[str], None]
) -> "ProcessCheckpoints | None":
    """Of a run that keeps them or goes on from one; None for any other."""
    if plan.begin is None and plan.checkpoint_every_s is None:
        return None
    from sojourn_bringup.process_checkpoints import ProcessCheckpoints  # not above: it needs all roles

    return ProcessCheckpoints(plan, nodes, say)
