"""Health of the nodes, as their heartbeats tell it. No ROS in here."""

from dataclasses import dataclass, field

from sojourn_contract.heartbeat import ENDED, READY, RUNNING, STALLED, Heartbeat
from sojourn_contract.stamps import seconds

STARTING = "starting"
SILENT = "silent"
RESTARTING = "restarting"
DEAD = "dead"
STOPPED = "stopped"
"""Its process is held by a signal."""
SILENT_AFTER_S = 3.0
"""Wall time without a heartbeat after which a node in real time counts as silent [s]: three are missing."""


@dataclass
class Health:
    """One node.

    Args:
        role: its role. pid: process number, 0 if it is not a process of ours. state: word of its last heartbeat, or
            one of ours. detail: in words. stamp: simulation time of its last heartbeat [ns]. refused: messages that it
            has refused. restarts: how often it has been started again. memory_mb, peak_memory_mb: [MB].
        heard_at: wall time of its last heartbeat [s].
    """

    role: str
    pid: int = 0
    state: str = STARTING
    detail: str = ""
    stamp: int = 0
    refused: int = 0
    last_refusal: str = ""
    restarts: int = 0
    memory_mb: float = 0.0
    peak_memory_mb: float = 0.0
    heard_at: float = 0.0
    values: dict[str, str] = field(default_factory=dict)

    def hear(self, beat: Heartbeat, now: float) -> None:
        """Take a heartbeat that arrived at wall time `now` [s]."""
        self.state, self.detail, self.stamp = beat.state, beat.detail, beat.stamp
        self.refused = sum(beat.refused.values())
        self.last_refusal = beat.values.get("last refusal", "")
        self.values = beat.values
        self.heard_at = now

    def begin_again(self) -> None:
        """Its process has been started again."""
        self.restarts += 1
        self.state, self.detail = RESTARTING, ""

    def look(self, now: float, realtime: bool) -> None:
        """Notice silence; in lock-step it is the plant that does."""
        if realtime and self.state in (RUNNING, STALLED) and now - self.heard_at > SILENT_AFTER_S:
            self.state, self.detail = SILENT, f"no heartbeat for {SILENT_AFTER_S:g} s"

    def stop(self) -> None:
        """Its process has been found stopped."""
        self.state = STOPPED
        self.detail = f"its process is stopped: kill -CONT {self.pid} lets it go on"

    @property
    def is_ready(self) -> bool:
        """Whether the run can start, or has started, as far as it is concerned."""
        return self.state in (READY, RUNNING, STALLED, ENDED)

    @property
    def note(self) -> str:
        """What a person should read beside the state."""
        if self.detail and self.detail != self.state:
            return self.detail
        return self.last_refusal if self.refused else self.values.get("step", "")


@dataclass
class Progress:
    """Where a run is.

    Args:
        stamp: simulation time [ns]. speed: simulated seconds a second of wall time since the last look.
        step: what the operator does. steps_done: steps done. steps: steps in all. to_go_m: distance to go [m], None
            where the drive has no goal.
    """

    stamp: int = 0
    speed: float = 0.0
    step: str = ""
    steps_done: int = 0
    steps: int = 0
    to_go_m: float | None = None

    @property
    def time_s(self) -> float:
        """Simulation time [s]."""
        return seconds(self.stamp)

    def hear_operator(self, values: dict[str, str]) -> None:
        """Take what the operator adds to its heartbeat."""
        self.step = values.get("step", self.step)
        done, _, total = values.get("steps done", "").partition(" of ")
        if done.isdigit() and total.isdigit():
            self.steps_done, self.steps = int(done), int(total)

    def hear_drive(self, values: dict[str, str]) -> None:
        """Take the drive's status."""
        text = values.get("distance_to_go", "")
        try:
            self.to_go_m = float(text) if values.get("state") == "moving" else None
        except ValueError:
            self.to_go_m = None
