"""A candidate that is a program: started as scripts/start.py starts a node, and ended with all that it has started."""

import os
import shlex
import signal
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rclpy.context import Context
from rclpy.experimental import EventsExecutor

from sojourn_bringup.child import STOP_S, Child
from sojourn_bringup.plan import ros_arguments
from sojourn_bringup.process_table import process
from sojourn_config.paths import ENVIRONMENT_VARIABLE
from sojourn_config.ros_environment import foreign_environment, is_ours, own_environment


class ProcessCandidate:
    """A process on the harness's domain.

    Args:
        role: whom it stands in for. command: program and arguments as one text; "" for our own node.
        ros: variables by which nodes find each other. namespace: ROS namespace. log: file for what it prints.
        renamed: names of topics in it, for those that are to have another.
    """

    def __init__(
        self,
        role: str,
        command: str,
        ros: Mapping[str, str],
        namespace: str,
        log: Path,
        renamed: Mapping[str, str] | None = None,
    ) -> None:
        self.role = role
        self._words = shlex.split(command) or [sys.executable, "-m", process(role).module]
        self._ours = not command or is_ours(self._words[0])
        self._ros, self._namespace, self._log = dict(ros), namespace, log
        self._renamed = dict(renamed or {})
        self._child: Child | None = None

    def start(self, context: Context, executor: EventsExecutor, parameters: Mapping[str, Any]) -> None:
        """Start the process."""
        environment = (own_environment if self._ours else foreign_environment)(os.environ, self._ros)
        if ENVIRONMENT_VARIABLE in os.environ:  # the configuration of the run that is replayed
            environment[ENVIRONMENT_VARIABLE] = os.environ[ENVIRONMENT_VARIABLE]
        command = self._words + ros_arguments(parameters, self._namespace, self._renamed)
        self._child = Child.of_command(self.role, command, environment, self._log)

    def poll(self) -> None:
        """A process does its own chores."""

    def how_it_ended(self) -> str:
        """In words, with the last thing that it said; "" while it runs."""
        if self._child is None or self._child.status is None:
            return ""
        return f"(process {self._child.pid}) {self._child.how_it_ended()}"

    def stop(self) -> None:
        """SIGINT, five seconds, SIGKILL; and whatever it has started with it."""
        if self._child is None:
            return
        try:
            self._child.send(signal.SIGINT)
            if not self._child.wait(STOP_S):
                self._child.send(signal.SIGKILL)
                self._child.wait(STOP_S)
        finally:
            self._child.sweep()
