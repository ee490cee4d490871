"""The operator's console beside a run: a process that listens, and for which nothing of the run waits."""

import os
import signal
import subprocess
import sys
import threading
from types import TracebackType
from typing import Self

from sojourn_bringup.plan import RunPlan
from sojourn_bringup.screen import Screen
from sojourn_config.ros_environment import own_environment, ros_variables

MODULE = "sojourn_console.console"
"""Run as a program: the console stands on this package, not this one on it."""
_STOP_S = 5.0


class ConsoleChild:
    """Of one run. A context manager; the console ends with it.

    Args:
        plan: the run. screen: where its address is shown.
    """

    def __init__(self, plan: RunPlan, screen: Screen) -> None:
        self._plan, self._screen = plan, screen
        self._child: subprocess.Popen[str] | None = None
        self._teller: threading.Thread | None = None

    def __enter__(self) -> Self:
        self._child = subprocess.Popen(
            console_command(self._plan),
            env=own_environment(os.environ, ros_variables(self._plan.domain)),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            process_group=0,  # Ctrl-C is for the run, which then ends it
        )
        self._teller = threading.Thread(target=self._tell, daemon=True)
        self._teller.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        child = self._child
        if child is None:
            return
        if child.poll() is None:
            child.send_signal(signal.SIGINT)
        try:
            child.wait(_STOP_S)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()
        if self._teller is not None:
            self._teller.join(_STOP_S)

    def _tell(self) -> None:
        """What it says: its address, or why it cannot be."""
        stream = None if self._child is None else self._child.stdout
        for line in stream or ():
            self._screen.say(line.rstrip())


def console_command(plan: RunPlan) -> list[str]:
    """The command that starts it."""
    command = [sys.executable, "-m", MODULE, plan.scenario, "--domain", str(plan.domain)]
    command += ["--namespace", plan.namespace] if plan.namespace else []
    return [*command, *(f"--set={text}" for text in plan.overrides)]
