"""The scripted operator without ROS: sends the goals of a scenario over the topics that any operator uses.

In lock-step it looks at the machine every fifth period, stamps its goals five periods ahead and then says with a tick
how many it has sent; drive, arm and plant wait for that tick, and so a scripted run is the same every time.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sojourn_config.scenario import LoadedScenario
from sojourn_contract import stamps
from sojourn_contract.app import NOTHING, Answer, App, Period
from sojourn_contract.events import format_tick
from sojourn_contract.goal_topics import FAULTS_TOPIC, GOAL_TOPICS
from sojourn_contract.heartbeat import beats, status_values
from sojourn_contract.kept_data import Kept
from sojourn_contract.link_topics import LINK_STATUS
from sojourn_contract.topics import topic
from sojourn_contract.values import Header, Odometry
from sojourn_machine.evolution import replace
from sojourn_operator.fault_schedule import (
    FaultSchedule,
    ScheduleState,
    SeenRun,
    schedule_as_data,
    schedule_from_data,
)
from sojourn_operator.goal_messages import report_of
from sojourn_operator.link.commands import reports_on_earth
from sojourn_operator.link.earth_link import EarthLink, LinkState, Said
from sojourn_operator.link.report import link_status, tally_values
from sojourn_operator.scenario_steps import script_steps
from sojourn_operator.script import OperatorScript, ScriptState
from sojourn_operator.steps.step import GoalReport, RunFacts
from sojourn_operator.steps.wait import WaitStep

TRUTH, TICK = "/truth/odom", "/operator/tick"
FAULTS = "faults"
"""Key in what is kept: how far their schedule is."""
COUNTED = frozenset(row.name for row in GOAL_TOPICS)
"""Topics of which a tick tells how many messages have been sent."""
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
    link: LinkState | None = None
    """Between it and the machine, if the scenario has one."""


class OperatorApp(App[OperatorState]):
    """Role operator."""

    role = "operator"

    def __init__(self, scenario: LoadedScenario) -> None:
        limit_s = scenario.config.duration_limit_s
        # with a link people may be the only operators: the role carries it until the run is over
        steps = script_steps(scenario) or [(WaitStep(max(limit_s - 1.0, 0.0)), None)]
        terrain = scenario.height_field() if any(step.looks_at_ground for step, _ in steps) else None
        around = RunFacts(scenario.arm_joints, terrain)
        self._leaps = scenario.leaps is not None
        self._faults = FaultSchedule(scenario.config.faults, scenario.config.seed)
        self._link = None if scenario.link is None else EarthLink(scenario, scenario.link)
        self.script = OperatorScript(steps, limit_s, around)

    def initial_state(self) -> OperatorState:
        """Before the first step."""
        return OperatorState(self.script.begin(), link=None if self._link is None else LinkState())

    def to_keep(self, state: OperatorState) -> Mapping[str, Any] | None:
        """How far the schedule of faults is; what became of the steps is in a file of its node."""
        return {FAULTS: schedule_as_data(state.faults)} if self._faults.faults else None

    def started_again(self, state: OperatorState, stamp: int, kept: Kept | None) -> OperatorState:
        """With the faults where they were; from the start of their schedule where nothing is known of it."""
        try:
            return state if kept is None else replace(state, faults=schedule_from_data(kept.values[FAULTS]))
        except (KeyError, ValueError):
            return state

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
        if self._link is not None and state.link is not None:
            state = replace(state, link=self._link.heard(state.link, period))
        if truth is None or stamp // _LOOK_NS == state.looked // _LOOK_NS:
            return state, NOTHING
        before, state = state.looked, replace(state, looked=stamp)
        if state.has_said_end:
            return state, Answer(self._of_link(state.link, before, stamp, truth))
        script, link, messages = self._look(state, stamp, truth)
        seen = SeenRun(stamp, len(script.results), state.reports, truth)
        faults, said = self._faults.look(state.faults, seen)
        messages += [(FAULTS_TOPIC, message) for message in said]
        sent = _counted(state.sent, messages)
        rests = 0
        if self._leaps and not said and (link is None or link.up.is_idle):
            until = self.script.rests_until(script, stamp, state.reports)
            rests = int(max(0, min(until, self._faults.quiet_until(faults))))
        tick = format_tick(sent, script.finished, rests)
        messages.append((TICK, Header(stamp, tick)))
        messages += self._of_link(link, before, stamp, truth)
        after = replace(state, script=script, sent=sent, has_said_end=script.finished, faults=faults, link=link)
        return after, Answer(messages)

    def _look(self, state: OperatorState, now: int, truth: Odometry) -> tuple[ScriptState, LinkState | None, Said]:
        """What the script says at a look, or what of it and of others comes out of a link."""
        if self._link is None or state.link is None:
            script, goal = self.script.look(state.script, now, state.reports, truth)
            return script, None, [] if goal is None else [(goal.topic, goal.message)]
        link, said = self._link.turned(state.link, now, truth)
        script, goal = self.script.look(state.script, now, reports_on_earth(link.reports, link.log), link.place)
        link = self._link.sent(link, now, [] if goal is None else [(goal.topic, goal.message)])
        link, more = self._link.turned(link, now, truth)
        return script, link, said + more

    def _of_link(self, state: LinkState | None, before: int, now: int, truth: Odometry) -> Said:
        """What is told of a link, once a second. before: the look before this one [ns]."""
        if self._link is None or state is None or not beats(before, now):
            return []
        return [(LINK_STATUS.name, link_status(self._link, state, now, truth))]

    def heartbeat_values(self, state: OperatorState, stamp: int) -> dict[str, str]:
        """Where in the script it is."""
        done = f"{len(state.script.results)} of {len(self.script.steps)}"
        of_link = {} if state.link is None else tally_values(state.link)
        return {"step": self.script.position(state.script), "steps done": done, **of_link}


def _counted(sent: Mapping[str, int], messages: Said) -> dict[str, int]:
    """Goals and faults sent on each topic, with those among these messages."""
    counts = dict(sent)
    for name, _ in messages:
        if name in COUNTED:
            counts[name] = counts.get(name, 0) + 1
    return counts
