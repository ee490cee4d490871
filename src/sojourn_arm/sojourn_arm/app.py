"""The arm without ROS: goals and measurements in, joint references and feed-forward out, by the laws in
`sojourn_flight.arm`.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sojourn_arm.afloat import Afloat, Attitude, SpaceGoal
from sojourn_arm.command import Command, command_of
from sojourn_arm.goals import GoalReader, LastGoal
from sojourn_arm.ground import GroundWatch, KnownGround
from sojourn_arm.measurements import IMU, JOINTS, MEASUREMENTS, Measured, Measurements
from sojourn_arm.restart import RESTARTED, dead_of, goal_of, kept_values
from sojourn_arm.rover import Rover, RoverWatch
from sojourn_arm.stand import LastLoads, Stand
from sojourn_arm.tasks import Request, task_input
from sojourn_config.flight import FlightScenario
from sojourn_contract import stamps
from sojourn_contract.absence import given_up, last_refused, seen_usable
from sojourn_contract.app import Answer, FlightApp, Period, Refusal
from sojourn_contract.barrier import is_due
from sojourn_contract.errors import NotCarriedOutError, RefusedMessageError
from sojourn_contract.hazcam import TOPIC as CLOUD
from sojourn_contract.hazcam import newest_cloud
from sojourn_contract.heartbeat import status_message, status_values
from sojourn_contract.kept_data import Kept
from sojourn_contract.switches import fraction_of
from sojourn_contract.topics import topic
from sojourn_flight.arm.goals import StopGoal
from sojourn_flight.arm.model import build_arm_model, reach_from_base
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.state import EVERYTHING, ArmInput, ArmOutput, Granted
from sojourn_flight.arm.tasks import task_control
from sojourn_flight.arm.tasks.task_control import TaskState
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace

STATUS, SWITCHES = "/arm/status", "/power/switches"


@dataclass(frozen=True, slots=True)
class ArmAppState:
    """What the role remembers."""

    tasks: TaskState
    """Of the laws."""
    ground: KnownGround
    output: ArmOutput | None = None
    """Of the last period whose measurements could be used; None before it."""
    command: Command = field(default_factory=Command)
    """The last one."""
    goal: LastGoal = field(default_factory=LastGoal)
    pending: Request | None = None
    """A goal that waits for the first period whose measurements can be used."""
    granted: float = 1.0
    """Share of its power, and of each motor's current, that the power manager lets the arm draw; none: switched off."""
    loads: LastLoads = field(default_factory=LastLoads)
    usable_at: int | None = None
    """When its measurements could last be used [ns]."""
    space: SpaceGoal | None = None
    """What was asked for last on a base that floats; None before it, and on all others."""
    base: dict[str, str] = field(default_factory=dict)
    """What the status tells of such a base."""
    alarm: str = ""
    """That its process is not the run's first, until it takes a goal."""


class ArmApp(FlightApp[ArmAppState]):
    """Role arm."""

    role = "arm"
    acts_in_silence = True

    def __init__(self, known: FlightScenario) -> None:
        self.params = known.carried_arm()
        self.model = build_arm_model(known.urdf_xml, self.params)
        self._tool = known.tool
        self._loads = known.machine.loads_of(self.params.joint_names)
        self._rated_power = sum(load.power_w for load in known.power.loads if load.name in self._loads)
        self._measurements = Measurements(self.params.joint_names, known.urdf_xml, known.gravity)
        self._rover = RoverWatch(self.params.interlock, [wheel.joint for wheel in known.machine.rolling])
        self._ground = GroundWatch(self.params, known, reach_from_base(self.model))
        self._stand = Stand(self.params, known.urdf_xml, known.machine)
        self._goals = GoalReader(self.params, known.machine.floats)
        self._afloat = Afloat(self.params, self.model, known.urdf_xml) if known.machine.floats else None

    def warm_up(self) -> None:
        """Those of the tasks, the control, and the ground."""
        task_control.warm_up(self.params, self.model)
        self._ground.warm_up()

    def initial_state(self) -> ArmAppState:
        """Before the first measurement, which says where the arm is."""
        return ArmAppState(
            task_control.initial_state(self.params, self.model, self._tool), self._ground.initial_state()
        )

    def to_keep(self, state: ArmAppState) -> dict[str, Any]:
        """The joints that do not do as they are told, and whether the arm is on its way to a goal."""
        return kept_values(state.tasks.arm.dead, state.goal)

    def started_again(self, state: ArmAppState, stamp: int, kept: Kept | None) -> ArmAppState:
        """With the joints that the process before knew of; its goal is lost."""
        try:
            if kept is None:
                return replace(state, goal=LastGoal(reason=RESTARTED), alarm=RESTARTED)
            dead, goal = dead_of(kept.values, self.model), goal_of(kept.values)
        except InvalidValueError as error:
            alarm = f"{RESTARTED}, and what was kept cannot be used: {error}"
            return replace(state, goal=LastGoal(reason=alarm), alarm=alarm)
        tasks = replace(state.tasks, arm=replace(state.tasks.arm, dead=dead))
        return replace(state, tasks=tasks, goal=goal, alarm=RESTARTED)

    def heartbeat_values(self, state: ArmAppState, stamp: int) -> dict[str, str]:
        """Its alarm."""
        return {"alarm": state.alarm} if state.alarm else {}

    def step(self, state: ArmAppState, period: Period) -> tuple[ArmAppState, Answer]:
        """One step of the arm's control, with the measurements of this period."""
        stamp, inputs, refusals = period.stamp, period.inputs, list[Refusal]()
        rover = self._rover.rover(inputs)
        ground = self._see(state.ground, inputs.get(CLOUD), rover, refusals)
        measured = self._measurements.read(inputs, refusals)
        state = replace(
            state,
            granted=_granted(inputs.get(SWITCHES), self._loads, state.granted),
            ground=ground,
            usable_at=seen_usable(stamp, state.usable_at, measured is not None),
        )
        state = self._take_goals(state, period, rover, refusals)
        if measured is not None:
            state = self._control(state, inputs, measured, rover)
        else:
            state = replace(state, command=state.command.at_rest())
            cause = last_refused(refusals[-1][1] if refusals else period.last_refusal)
            if reason := given_up(MEASUREMENTS, stamp, state.usable_at, inputs, cause):
                # a stop for when it knows again where it is
                state = replace(state, goal=state.goal.given_up(reason), pending=StopGoal())
        told = state.goal.told(stamp)
        if told is not state.goal:
            state = replace(state, goal=told)
        return state, Answer(_messages(state, stamp), refusals)

    def _see(self, ground: KnownGround, cloud: Any, rover: Rover, refusals: list[Refusal]) -> KnownGround:
        """Take in what the hazard camera sees of the ground; a cloud that cannot be used is left out."""
        newest = newest_cloud(cloud, ground.cloud)
        if newest == ground.cloud:
            return ground
        try:
            return replace(ground, cloud=newest, seen=self._ground.after_cloud(ground.seen, cloud, rover))
        except RefusedMessageError as refusal:
            refusals.append((refusal.topic, str(refusal)))
            return replace(ground, cloud=newest)

    def _take_goals(self, state: ArmAppState, period: Period, rover: Rover, refusals: list[Refusal]) -> ArmAppState:
        """Keep the goal that takes effect now; of several the last."""
        for name, message in period.goals:
            try:
                request = self._goals.request(name, message, period.stamp, rover)
                state = replace(state, goal=state.goal.begun(message), pending=request, alarm="")
            except (GoalRefusedError, RefusedMessageError) as refusal:
                told, is_told = str(refusal), isinstance(refusal, RefusedMessageError)
                state = replace(state, goal=state.goal.refused_at_once(message, told, state.pending is not None))
                refusals.append((name, told if is_told else str(NotCarriedOutError(name, "goal", told))))
        return state

    def _control(self, state: ArmAppState, inputs: Mapping[str, Any], measured: Measured, rover: Rover) -> ArmAppState:
        """Form the command of a period whose measurements can be used."""
        if self._afloat is not None:
            state = _aimed(self._afloat, state, self._afloat.attitude(measured.positions, inputs[IMU]))
        request, granted = state.pending, state.granted
        ground = state.ground if request is None else self._ground.observe(state.ground, inputs[JOINTS])
        loads = self._stand.loads(state.loads, inputs[JOINTS], measured, state.tasks.moves or request is not None)
        why_not = rover.why_not_allowed if granted else "the power manager has switched the arm off"
        known = ArmInput(
            positions=measured.positions,
            velocities=measured.velocities,
            gravity_in_base=measured.gravity,
            allowed=not why_not,
            not_allowed_reason=why_not,
            ground=ground.ground,
            granted=EVERYTHING if granted == 1.0 else Granted(granted * self._rated_power, granted),
        )
        observed = task_input(known, request, measured, loads.loads)
        tasks, output, report = task_control.step(
            self.params, self.model, state.tasks, observed, stamps.CONTROL_PERIOD_S
        )
        state = replace(state, pending=None)
        if self._afloat is not None and state.space is not None:
            now = self._afloat.attitude(measured.positions, inputs[IMU])
            space, output = self._afloat.followed(state.space, request, now, output)
            state = replace(state, space=space, pending=space.correction, base=self._afloat.told(space, now))
        return replace(
            state,
            tasks=tasks,
            ground=ground,
            output=output,
            command=command_of(self.params.joint_names, output, None if tasks.tool is None else tasks.tool_command),
            goal=state.goal.noted(output, report),
            loads=loads,
        )


def _aimed(afloat: Afloat, state: ArmAppState, now: Attitude) -> ArmAppState:
    """With the goal of a period as it is asked of the arm on a base that floats."""
    if state.pending is None:
        return state
    try:
        space, request = afloat.taken(state.space, state.pending, now)
    except GoalRefusedError as refusal:
        return replace(state, goal=state.goal.refused(str(refusal)), pending=None)
    return replace(state, space=space, pending=request)


def _granted(switches: Any, loads: Sequence[str], before: float) -> float:
    """Share of its power that the arm has by a message of the power manager, of several loads the least; as before
    where there is none.
    """
    if switches is None:
        return before
    said = status_values(switches)
    fractions = (fraction_of(said.get(load, "on")) for load in loads)
    return min((1.0 if fraction is None else fraction for fraction in fractions), default=1.0)


def _messages(state: ArmAppState, stamp: int) -> Iterator[tuple[str, Any]]:
    if is_due(topic(STATUS), stamp // stamps.CONTROL_PERIOD_NS):
        values = state.goal.status(state.output) | state.base
        level = 1 if values["state"] in ("refused", "failed") or "failed_joints" in values else 0
        yield STATUS, status_message(stamp, "arm", values, values["reason"] or values["state"], level)
    yield "/arm_command", state.command.message(stamp)
