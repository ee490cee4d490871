"""The shadows of a run, as the supervisor sees them: their processes, their readiness, and what they report."""

import json
import os
import signal
import sys
import time
from collections.abc import Mapping

from sojourn_bringup.child import Child
from sojourn_bringup.plan import RunPlan
from sojourn_bringup.screen import Screen
from sojourn_bringup.shadow_report import DONE, FAILED, READY, RUNNING, ShadowReport, read_report
from sojourn_config.ros_environment import own_environment

FINISH_S = 60.0
"""Wall time that a shadow has to compare and write, after the run."""


class Shadows:
    """The shadows of one run.

    Args:
        plan: the run. screen: where to tell of them. ros: variables by which nodes find each other.
    """

    def __init__(self, plan: RunPlan, screen: Screen, ros: Mapping[str, str]) -> None:
        self._plan, self._screen, self._ros = plan, screen, ros
        self._children: dict[str, Child] = {}
        self.reports = {role: ShadowReport() for role in plan.shadows}
        self._said: dict[str, str] = {}

    def start(self) -> None:
        """Start a process for each; it starts the candidate."""
        plan = self._plan
        for role, command in plan.shadows.items():
            words = [sys.executable, "-m", "sojourn_bringup.shadow", "--role", role, "--command", command]
            words += [
                "--parameters",
                json.dumps(plan.candidate_parameters(role)),
                "--result",
                str(plan.shadow_file(role)),
            ]
            words += ["--bag", str(plan.run_dir / f"shadow_{role}"), "--domain", str(plan.domain)]
            words += ["--log", str(plan.run_dir / "logs" / f"shadow_{role}.log")]
            words += ["--namespace", plan.namespace] if plan.namespace else []
            words += ["--network"] if plan.on_network else []
            log = plan.run_dir / "logs" / f"shadow_{role}_comparison.log"
            self._children[role] = Child.of_command(
                f"shadow of {role}", words, own_environment(os.environ, self._ros), log
            )

    def look(self) -> None:
        """Read the reports, and say what is new: readiness, the first difference, failure."""
        for role in self._plan.shadows:
            headline = self._read(role).headline
            if headline and self._said.get(role) != headline:
                self._said[role] = headline
                self._screen.say(f"shadow of {role}: {headline}")

    def not_ready(self) -> list[str]:
        """Roles whose shadow is not ready yet. A failed one is not waited for."""
        return [role for role, report in self.reports.items() if report.state not in (READY, RUNNING, DONE, FAILED)]

    def failure(self) -> str:
        """Why a shadow has failed, in words; empty while none has."""
        for role, report in self.reports.items():
            if report.state == FAILED:
                return f"shadow of {role}: {report.detail}"
        return ""

    def finish(self) -> None:
        """End them once the run is over, and tell how each compares."""
        for child in self._children.values():
            if child.status is None:
                child.send(signal.SIGINT)
        end = time.monotonic() + FINISH_S
        for role, child in self._children.items():
            if not child.wait(max(0.1, end - time.monotonic())):
                self._screen.say(f"shadow of {role} does not end: killed")
                child.send(signal.SIGKILL)
                child.wait(FINISH_S)
            child.sweep()
            report = self._read(role)
            if report.state == DONE:
                self._screen.say(f"shadow of {role}, {self._plan.shadows[role]}:")
                for line in report.lines:
                    self._screen.say(f"  {line}")
            elif report.state != FAILED:
                self._screen.say(f"shadow of {role}: {child.how_it_ended()}")

    def _read(self, role: str) -> ShadowReport:
        report = read_report(self._plan.shadow_file(role))
        child = self._children[role]
        if child.status not in (None, 0) and report.state not in (DONE, FAILED):
            report = ShadowReport(FAILED, child.how_it_ended())
        self.reports[role] = report
        return report
