"""The scripted operator: carries out the steps of a scenario one after another. No ROS in here, and no clock.

At each look it is given the simulation time and what drive and arm report; it answers with the goal to send, if any. A
step is over when the report whose goal_stamp is that of its goal is final; the first step that fails ends the script.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field

from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topics import OPERATOR_LAG

REACHED = "reached"
WAITED = "waited"
TIMED_OUT = "timed out"
FINAL_STATES = (REACHED, "refused", "stopped", "failed")
GOOD_OUTCOMES = (REACHED, WAITED)
LEAD_NS = OPERATOR_LAG * CONTROL_PERIOD_NS
"""A goal takes effect so much after the look that led to it [ns]."""


@dataclass(frozen=True)
class DriveTo:
    """Drive to a point of the map [m]; `yaw` [rad] is the wanted heading there, None for any."""

    x: float
    y: float
    yaw: float | None = None
    frame: str = "map"
    z: float = 0.0
    """Height of the ground there over that of the start [m], 0 if it is not known."""


@dataclass(frozen=True)
class DriveAlong:
    """Drive along points (x, y) of the map [m]; `yaw` [rad] is the wanted heading at the last, None for any."""

    points: tuple[tuple[float, float], ...]
    yaw: float | None = None
    frame: str = "map"


@dataclass(frozen=True)
class ArmTo:
    """Place the arm's tip at a point [m]; an orientation of 0 0 0 1 (x y z w) leaves the direction of the tool free."""

    x: float
    y: float
    z: float
    frame: str = "base_link"
    orientation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class ArmGround:
    """Place the arm's tip `height` over the ground at (x, y) of base_link [m]; whoever sends it looks the ground up."""

    x: float
    y: float
    height: float = 0.0


@dataclass(frozen=True)
class ArmJoints:
    """Move the arm to joint positions [rad], by joint name, or to a named pose (stow, unfold)."""

    positions: tuple[tuple[str, float], ...] = ()
    name: str = ""


@dataclass(frozen=True)
class ArmTask:
    """Carry out a task of the arm with its numbers, as texts by key."""

    name: str
    values: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Wait:
    """Do nothing for a while [s]."""

    seconds: float


Action = DriveTo | DriveAlong | ArmTo | ArmGround | ArmJoints | ArmTask | Wait

_TOPICS: dict[type, tuple[str, str]] = {
    DriveTo: ("/goal_pose", "drive"),
    DriveAlong: ("/waypoints", "drive"),
    ArmTo: ("/arm/goal_pose", "arm"),
    ArmGround: ("/arm/goal_pose", "arm"),
    ArmJoints: ("/arm/joint_goal", "arm"),
    ArmTask: ("/arm/task", "arm"),
}


@dataclass(frozen=True)
class Report:
    """What drive or arm says of its goal.

    Args:
        state: word of the status. goal_stamp: stamp of the goal that it is about [ns], 0 for none. reason: in words.
    """

    state: str
    goal_stamp: int
    reason: str = ""


@dataclass(frozen=True)
class Goal:
    """A goal to send: its topic, its stamp [ns] and what it asks for."""

    topic: str
    stamp: int
    action: Action


@dataclass(frozen=True)
class StepResult:
    """What became of a step. Times are simulation time [s]."""

    step: str
    outcome: str
    reason: str
    start_s: float
    end_s: float

    @property
    def good(self) -> bool:
        """Whether the step did what it was to do."""
        return self.outcome in GOOD_OUTCOMES


def describe(action: Action) -> str:
    """The action in a few words."""
    match action:
        case DriveTo(x, y, yaw):
            return f"drive to ({x:.2f}, {y:.2f})" + ("" if yaw is None else f" heading {yaw:.2f} rad")
        case DriveAlong(points):
            return f"drive along {len(points)} points"
        case ArmTo(x, y, z):
            return f"arm to ({x:.3f}, {y:.3f}, {z:.3f})"
        case ArmGround(x, y, height):
            return f"arm to the ground at ({x:.2f}, {y:.2f})" + (f", {height:.3f} m above it" if height else "")
        case ArmJoints(positions, name):
            return f"arm: {name}" if name else f"arm to {len(positions)} joint positions"
        case ArmTask(name, values):
            return " ".join((f"arm: {name}", *(f"{key}={value}" for key, value in values)))
        case Wait(seconds):
            return f"wait {seconds:g} s"


def receiver_of(action: Action) -> str:
    """Role that carries out an action, "" for a wait."""
    return "" if isinstance(action, Wait) else _TOPICS[type(action)][1]


@dataclass
class OperatorScript:
    """Carries out steps in order.

    Args:
        steps: what to do, each with its own limit [s] (None: only that of the run).
        limit_s: duration of the run after which the script ends, done or not [s].
        done: results of steps that an earlier operator of this run has finished.
    """

    steps: Sequence[tuple[Action, float | None]]
    limit_s: float
    done: Sequence[StepResult] = ()
    results: list[StepResult] = field(default_factory=list, init=False)
    finished: bool = field(default=False, init=False)
    _since: int | None = field(default=None, init=False)
    """When the present step began [ns]; None between two steps."""

    def __post_init__(self) -> None:
        self.results = list(self.done)
        self.finished = any(not result.good for result in self.results)

    @property
    def succeeded(self) -> bool:
        """Whether every step has been carried out."""
        return len(self.results) == len(self.steps) and all(result.good for result in self.results)

    @property
    def position(self) -> str:
        """Where in the script it is, in words."""
        if self.finished or len(self.results) >= len(self.steps):
            return "ended"
        index = len(self.results)
        return f"step {index + 1} of {len(self.steps)}: {describe(self.steps[index][0])}"

    def look(self, now: int, reports: Mapping[str, Report]) -> Goal | None:
        """Look at the machine at simulation time `now` [ns]; the goal to send now, if any.

        Args:
            reports: latest report of "drive" and "arm", where there is one.
        """
        if self.finished:
            return None
        if self._since is not None:
            outcome = self._judge(now, reports)
            if outcome is None:
                return None
            self._record(now, *outcome)
        if self.finished or len(self.results) == len(self.steps):
            self.finished = True
            return None
        return self._begin(now)

    def _begin(self, now: int) -> Goal | None:
        self._since = now
        if now >= self.limit_s * NANOSECONDS:
            self._record(now, TIMED_OUT, self._limit_text())
            return None
        action = self.steps[len(self.results)][0]
        return None if isinstance(action, Wait) else Goal(_TOPICS[type(action)][0], now + LEAD_NS, action)

    def _judge(self, now: int, reports: Mapping[str, Report]) -> tuple[str, str] | None:
        """Outcome and reason of the present step, or None while it goes on."""
        action, limit = self.steps[len(self.results)]
        since = self._since or 0
        if isinstance(action, Wait):
            if now >= since + round(action.seconds * NANOSECONDS):
                return WAITED, ""
        else:
            report = reports.get(_TOPICS[type(action)][1])
            if report is not None and report.goal_stamp == since + LEAD_NS and report.state in FINAL_STATES:
                return report.state, report.reason
        if now >= self.limit_s * NANOSECONDS:
            return TIMED_OUT, self._limit_text()
        if limit is not None and now >= since + round(limit * NANOSECONDS):
            return TIMED_OUT, f"not done within {limit:g} s"
        return None

    def _limit_text(self) -> str:
        return f"the run's limit of {self.limit_s:g} s is over"

    def _record(self, now: int, outcome: str, reason: str) -> None:
        index = len(self.results)
        start = now if self._since is None else self._since
        self.results.append(
            StepResult(describe(self.steps[index][0]), outcome, reason, start / NANOSECONDS, now / NANOSECONDS)
        )
        self._since = None
        self.finished = not self.results[-1].good


def results_as_data(results: Sequence[StepResult]) -> list[dict[str, object]]:
    """Results as plain data, for JSON."""
    return [asdict(result) for result in results]


def results_from_data(data: Sequence[Mapping[str, object]]) -> list[StepResult]:
    """The reverse of `results_as_data`."""
    return [
        StepResult(
            step=str(entry["step"]),
            outcome=str(entry["outcome"]),
            reason=str(entry["reason"]),
            start_s=float(str(entry["start_s"])),
            end_s=float(str(entry["end_s"])),
        )
        for entry in data
    ]
