"""The scripted operator without ROS: sends the goals of a scenario over the topics that any operator uses.

In lock-step it looks at the machine every fifth period, stamps its goals five periods ahead and then says with a tick
how many it has sent; drive, arm and plant wait for that tick, and so a scripted run is the same every time.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from sojourn_config.scenario import LoadedScenario
from sojourn_contract import stamps
from sojourn_contract.app import NOTHING, Answer, App, Period
from sojourn_contract.events import format_tick
from sojourn_contract.fault_messages import TOPIC as FAULTS_TOPIC
from sojourn_contract.heartbeat import status_values
from sojourn_contract.topics import topic
from sojourn_contract.values import Header, Message, Odometry
from sojourn_machine.evolution import replace
from sojourn_operator.fault_schedule import FaultSchedule, ScheduleState, SeenRun
from sojourn_operator.goal_messages import report_of
from sojourn_operator.scenario_steps import script_steps
from sojourn_operator.script import OperatorScript, ScriptState
from sojourn_operator.steps.step import GoalReport, RunFacts

TRUTH, TICK = "/truth/odom", "/operator/tick"
_STATUSES = {"/drive/status": "drive", "/arm/status": "arm"}
_LOOK_NS = topic(TICK).every * stamps.CONTROL_PERIOD_NS


@dataclass(frozen=True, slots=True)
class OperatorState:
    """What the role remembers."""

    script: ScriptState
    reports: Mapping[str, GoalReport] = field(default_factory=dict)
    """Last word of drive and arm."""
    sent: Mapping[str, int] = field(default_factory=dict)
    """Goals sent on each topic."""
    truth: Odometry | None = None
    """Last good /truth/odom."""
    looked: int = 0
    """Stamp of the last look [ns]."""
    has_said_end: bool = False
    drive_status: Mapping[str, str] = field(default_factory=dict)
    """Latest status of the drive, for whoever shows the progress."""
    faults: ScheduleState = field(default_factory=ScheduleState)


class OperatorApp(App[OperatorState]):
    """Role operator."""

    role = "operator"

    def __init__(self, scenario: LoadedScenario) -> None:
        steps = script_steps(scenario)
        terrain = scenario.height_field() if any(step.looks_at_ground for step, _ in steps) else None
        around = RunFacts(scenario.arm_joints, terrain)
        self._leaps = scenario.leaps is not None
        self._faults = FaultSchedule(scenario.config.faults, scenario.config.seed)
        self.script = OperatorScript(steps, scenario.config.duration_limit_s, around)

    def initial_state(self) -> OperatorState:
        """Before the first step."""
        return OperatorState(self.script.begin())

    def step(self, state: OperatorState, period: Period) -> tuple[OperatorState, Answer]:
        """Keep the latest reports; at every fifth period let the script look at them."""
        stamp, inputs = period.stamp, period.inputs
        for name, who in _STATUSES.items():
            status = inputs.get(name)
            if status is not None:
                state = replace(state, reports={**state.reports, who: report_of(status)})
                if who == "drive":
                    state = replace(state, drive_status=status_values(status))
        truth = inputs.get(TRUTH) or state.truth
        state = replace(state, truth=truth)
        if truth is None or stamp // _LOOK_NS == state.looked // _LOOK_NS:
            return state, NOTHING
        state = replace(state, looked=stamp)
        if state.has_said_end:
            return state, NOTHING
        script, goal = self.script.look(state.script, stamp, state.reports, truth)
        sent, messages = dict(state.sent), list[tuple[str, Message]]()
        if goal is not None:
            messages.append((goal.topic, goal.message))
            sent[goal.topic] = sent.get(goal.topic, 0) + 1
        seen = SeenRun(stamp, len(script.results), state.reports, truth)
        faults, said = self._faults.look(state.faults, seen)
        if said:
            messages += [(FAULTS_TOPIC, message) for message in said]
            sent[FAULTS_TOPIC] = sent.get(FAULTS_TOPIC, 0) + len(said)
        rests = 0
        if self._leaps and not said:
            until = self.script.rests_until(script, stamp, state.reports)
            rests = int(max(0, min(until, self._faults.quiet_until(faults))))
        tick = format_tick(sent, script.finished, rests)
        messages.append((TICK, Header(stamp, tick)))
        after = replace(state, script=script, sent=sent, has_said_end=script.finished, faults=faults)
        return after, Answer(messages)

    def heartbeat_values(self, state: OperatorState, stamp: int) -> dict[str, str]:
        """Where in the script it is."""
        done = f"{len(state.script.results)} of {len(self.script.steps)}"
        return {"step": self.script.position(state.script), "steps done": done}
