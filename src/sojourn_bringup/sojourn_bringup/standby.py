"""The successor of the recorder, which waits beside it in real time: what is said until one hears is lost."""

import json
import signal
import sys
from collections.abc import Mapping

from sojourn_bringup.child import STOP_S, Child, environment_of
from sojourn_bringup.plan import RunPlan

ROLE = "recorder"


class Standby:
    """Keeps one process ready, see `sojourn_bags.standby`.

    Args:
        plan: the run. ros: variables of its ROS.
    """

    def __init__(self, plan: RunPlan, ros: Mapping[str, str]) -> None:
        self._plan, self._ros = plan, ros
        # in lock-step nothing is started again; another's recorder cannot wait
        self._is_wanted = plan.realtime and ROLE in plan.started and ROLE not in plan.replacements
        self._child: Child | None = None
        self._made_for = 0
        """Attempt of the last one that was made: of one that dies while it waits there is no other."""

    def prepare(self, attempt: int) -> None:
        """Have one that would be this attempt, counted from 1; called again and again."""
        if not self._is_wanted or attempt <= self._made_for:
            return
        self._made_for = attempt
        given = json.dumps({"scenario": self._plan.scenario, "overrides": list(self._plan.overrides)})
        command = [sys.executable, "-m", "sojourn_bags.standby", given, *self._plan.ros_arguments(ROLE, attempt)]
        log = self._plan.run_dir / "logs" / f"{ROLE}.log"
        self._child = Child.of_command(ROLE, command, environment_of(self._plan, ROLE, self._ros), log, hears=True)

    def take(self) -> Child | None:
        """The one that waits, told to begin; None where there is none."""
        child, self._child = self._child, None
        if child is None or child.status is not None:
            return None
        return child if child.tell() else None

    def end(self) -> None:
        """Leave none behind."""
        child, self._child = self._child, None
        if child is not None:
            child.send(signal.SIGKILL)
            child.wait(STOP_S)
