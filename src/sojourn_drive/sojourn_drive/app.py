"""The drive without ROS: goals and measurements in, odometry and wheel commands out, by the laws in
`sojourn_flight.supervision`.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from sojourn_config.flight import FlightScenario
from sojourn_contract import stamps
from sojourn_contract.absence import given_up, last_refused, seen_usable
from sojourn_contract.app import Answer, FlightApp, Period, Refusal
from sojourn_contract.barrier import is_due
from sojourn_contract.clouds import points_of
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.hazcam import TOPIC as CLOUD
from sojourn_contract.hazcam import hazard_camera_of, newest_cloud, own_body_of
from sojourn_contract.heartbeat import status_values
from sojourn_contract.kept_data import Kept
from sojourn_contract.kept_goal import GOAL, KeptGoal, kept_goal
from sojourn_contract.run_table import table_of
from sojourn_contract.stereo_pair import pair_place_of
from sojourn_contract.topics import topic
from sojourn_contract.values import Path, TwistStamped
from sojourn_drive.arm_interlock import ArmInterlock
from sojourn_drive.charge import ChargeGauge, PowerSituation
from sojourn_drive.goals import GoalStatus, QuestionStatus, goal_of
from sojourn_drive.measurements import JointMeasurements
from sojourn_drive.memory import Asked, DriveAppState, Heard, Views
from sojourn_drive.placing import PLACE, PlaceStatus, placed
from sojourn_drive.reports import costmap, drive_report, odometry_report, plan
from sojourn_drive.restart import LOST, kept_odometry, less_sure, lost, odometry_of, unseen
from sojourn_drive.stereo import StereoInput
from sojourn_drive.sun import SunSightings
from sojourn_flight.hazards.keep_out import KeepOut
from sojourn_flight.mobility.twist import NO_MOTION, PlanarTwist
from sojourn_flight.odometry.odometry import stood
from sojourn_flight.odometry.visual_state import StereoImages
from sojourn_flight.supervision.arbiter import why_pre_empted
from sojourn_flight.supervision.drive import LONGEST_PERIOD, DriveModel
from sojourn_flight.supervision.drive_status import drive_status
from sojourn_flight.supervision.drive_types import DriveInput, DriveOutput, TwistCommand
from sojourn_machine.errors import InvalidValueError, MachineError
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray

QUESTION = "/drive/question"
MEASUREMENTS = ("/joint_states", "/imu/data")
STOOD_S = 0.5
"""After which no motor draws anything any more."""


class DriveApp(FlightApp[DriveAppState]):
    """Role drive."""

    role = "drive"
    acts_in_silence = True

    def __init__(self, known: FlightScenario) -> None:
        self._charges = tuple(row.name for row in table_of(known).each("/battery_state"))
        self._start, self._start_height = known.start, known.start_height
        camera, pair, zones = hazard_camera_of(known), pair_place_of(known), KeepOut(known.keep_out)
        self.model = DriveModel(known.drive, known.mobility(), camera, pair, zones)
        self._body = own_body_of(known)
        self._measurements = JointMeasurements(known.machine, self.model.mobility.joints, known.urdf_xml)
        self._sun = SunSightings(known)
        self._stereo = StereoInput(known)
        self._charge = ChargeGauge(known.power_manager, self._measurements.loads, known.drive.energy)
        self._interlock = ArmInterlock(known.arm)
        self._imu_load = known.sensors.powered_by.get("imu", "")

    def warm_up(self) -> None:
        """Those of the drive."""
        self.model.warm_up()

    def initial_state(self) -> DriveAppState:
        """Standing where the scenario has it start."""
        drive = self.model.initial_state(self._start.x, self._start.y, self._start.yaw, self._start_height())
        return DriveAppState(drive, self.model.at_rest(drive))

    def to_keep(self, state: DriveAppState) -> dict[str, Any]:
        """Where it is, and what has become of its goal."""
        last = state.asked.last.under_way or state.asked.last
        goal = KeptGoal(last.state, last.reason, last.stamp)._asdict()
        return {"odometry": kept_odometry(state.drive.odometry), GOAL: goal, "lost": state.is_lost}

    def started_again(self, state: DriveAppState, stamp: int, kept: Kept | None) -> DriveAppState:
        """Where the process before has been, or lost; a goal that was under way is lost."""
        estimate = state.drive.odometry
        try:
            if kept is None or kept.values["lost"]:
                raise InvalidValueError("kept", None, "a pose")
            estimate = odometry_of(kept.values["odometry"], estimate)
            way, turn = unseen(self.model.params.limits, max(stamp - kept.stamp, 0) * 1e-9)
            estimate, is_lost = less_sure(estimate, way, turn), False
            alarm = f"the drive was restarted: it goes on from ({estimate.x:.2f}, {estimate.y:.2f}) +- {way:.2f} m"
        except (InvalidValueError, KeyError, TypeError):
            estimate, is_lost, alarm = lost(estimate), True, LOST
        try:
            last = GoalStatus(*kept_goal({} if kept is None else kept.values).after(alarm))
        except InvalidValueError:
            last = GoalStatus(reason=alarm)
        drive = self.model.initial_state(estimate.x, estimate.y, estimate.yaw)
        drive = replace(drive, odometry=estimate, text=alarm)
        return replace(
            DriveAppState(drive, self.model.at_rest(drive)),
            asked=Asked(last=last),
            alarm=alarm,
            is_lost=is_lost,
        )

    def heartbeat_values(self, state: DriveAppState, stamp: int) -> dict[str, str]:
        """Its alarm."""
        return {"alarm": state.alarm} if state.alarm else {}

    def on_new_time(self, state: DriveAppState) -> DriveAppState:
        """A velocity of the old time would never age, and the time since the last measurement is not known."""
        return replace(state, stepped_at=None, asked=replace(state.asked, twist=None))

    def step(self, state: DriveAppState, period: Period) -> tuple[DriveAppState, Answer]:
        """One step of the drive, with the measurements of this period."""
        stamp = period.stamp
        heard = self._hear(state, period.inputs)
        refusals: list[Refusal] = []
        state = self._take_places(state, period.goals, refusals)
        asked = self._take_goals(state, heard, period.goals, stamp, refusals)
        cloud = self._cloud(period.inputs, heard.cloud != state.heard.cloud, refusals)
        images, heard = self._images(period, heard, refusals)
        state = replace(state, asked=asked, heard=heard)
        stepped = self._drive(state, period, Views(cloud, images), refusals)
        usable_at = seen_usable(stamp, heard.usable_at, stepped is not None)
        if stepped is not None:
            state = replace(stepped, heard=replace(stepped.heard, usable_at=usable_at))
            output = state.output
        else:
            cause = last_refused(refusals[-1][1] if refusals else period.last_refusal)
            if heard.dark:
                cause = f"the power manager has switched off {self._imu_load}"
            reason = given_up(MEASUREMENTS, stamp, usable_at, period.inputs, cause)
            if reason:  # nobody knows where the rover is: fail the goal, and drop a velocity
                asked = Asked(asked.last.given_up(reason), abandoned=reason, questioned=asked.questioned)
            state = replace(state, asked=asked, heard=replace(heard, usable_at=usable_at))
            output = _stopped(state.output)
        last = state.asked.last.noted(output.outcomes, state.asked.pending is not None).told(stamp)
        state = replace(state, asked=replace(state.asked, last=last))
        missing = _missing(period)
        return state, Answer(self._messages(state, output, stamp, missing), refusals)

    def _hear(self, state: DriveAppState, inputs: Mapping[str, Any]) -> Heard:
        heard, switches = state.heard, inputs.get("/power/switches")
        limit, dark, off = heard.power_limit, heard.dark, heard.off
        if switches is not None:
            values = status_values(switches)
            limit, dark = self._measurements.power_limit(values, limit), values.get(self._imu_load) == "off"
            off = self._charge.off(values)
        driving, here = state.drive.mode != "idle", state.drive.odometry
        return replace(
            heard,
            power_limit=limit,
            dark=dark,
            off=off,
            interlock=self._interlock.why_not(inputs.get("/joint_states"), driving, heard.interlock),
            supply=self._charge.supply(
                [inputs.get(name) for name in self._charges],
                heard.supply,
                PowerSituation(not driving and here.standing_for > STOOD_S, here.v_x, here.yaw_rate, off),
            ),
            cloud=newest_cloud(inputs.get(CLOUD), heard.cloud),
        )

    def _take_places(
        self, state: DriveAppState, goals: Sequence[tuple[str, Any]], refusals: list[Refusal]
    ) -> DriveAppState:
        """Where operators say that it is; goals of the same period go from there."""
        for name, message in goals:
            if name != PLACE:
                continue
            try:
                drive = placed(self.model, state.drive, message)
                state = replace(state, drive=drive, alarm="", is_lost=False)
                told = PlaceStatus(message.stamp, "done")
            except RefusedMessageError as refusal:
                told = PlaceStatus(message.stamp, "refused", str(refusal))
                refusals.append((name, told.reason))
            state = replace(state, asked=replace(state.asked, placed=told))
        return state

    def _take_goals(
        self,
        state: DriveAppState,
        heard: Heard,
        goals: Sequence[tuple[str, Any]],
        now: int,
        refusals: list[Refusal],
    ) -> Asked:
        """The goal that takes effect now; of several the last."""
        asked = state.asked
        for name, message in goals:
            if name == PLACE:
                continue
            if name == QUESTION:
                asked = self._take_question(state, asked, heard, message, refusals)
            elif heard.interlock and name == "/cmd_vel" and _planar(message) == NO_MOTION:
                continue  # it is asked to stand, and does
            elif heard.interlock:
                asked = replace(asked, last=asked.last.refused(message, heard.interlock))
                none = f"none while {heard.interlock}"
                refusals.append((name, str(RefusedMessageError(name, "header", "a goal now", none))))
            elif name == "/cmd_vel":
                stamp = message.stamp or now
                twist = _planar(message)
                last = asked.last.pre_empted(stamp, "" if asked.pending is None else why_pre_empted(twist))
                asked = replace(asked, last=last, twist=(stamp, twist), pending=None)
            else:
                last = asked.last.begun(message)
                try:
                    self._check_known(state, name, message.frame)
                    asked = replace(asked, pending=goal_of(name, message, state.drive.odometry, last.number), last=last)
                except RefusedMessageError as refusal:
                    last = asked.last.refused(message, str(refusal), asked.pending is not None)
                    asked = replace(asked, last=last)
                    refusals.append((name, str(refusal)))
        return asked

    @staticmethod
    def _take_question(
        state: DriveAppState, asked: Asked, heard: Heard, message: Path, refusals: list[Refusal]
    ) -> Asked:
        """With a question that the drive will answer, or that is refused as its goal would be."""
        told = QuestionStatus(message.stamp)
        try:
            if heard.interlock:
                raise RefusedMessageError(QUESTION, "header", "a goal now", f"none while {heard.interlock}")
            DriveApp._check_known(state, QUESTION, message.frame)
            goal = goal_of(QUESTION, message, state.drive.odometry, 0)
        except RefusedMessageError as refusal:
            refusals.append((QUESTION, str(refusal)))
            return replace(asked, question=None, questioned=replace(told, refused=str(refusal)))
        return replace(asked, question=goal, questioned=told)

    @staticmethod
    def _check_known(state: DriveAppState, name: str, frame: str) -> None:
        """Raise RefusedMessageError for a place that a drive which is lost cannot know."""
        if state.is_lost and frame != "base_link":
            raise RefusedMessageError(name, "header.frame_id", repr(frame), f"base_link: {LOST}")

    def _cloud(self, inputs: Mapping[str, Any], is_new: bool, refusals: list[Refusal]) -> FloatArray | None:
        """Points of a cloud that is new, shape (n, 3) [m], less those on the machine itself; None without one, and of
        one that is refused.
        """
        try:
            points = points_of(CLOUD, inputs[CLOUD]) if is_new else None
            joints = inputs.get("/joint_states")
            if points is None or self._body is None or joints is None:
                return points
            return self._body.left_out(points, joints.names, joints.position)
        except RefusedMessageError as refusal:
            refusals.append((CLOUD, str(refusal)))
            return None

    def _images(self, period: Period, heard: Heard, refusals: list[Refusal]) -> tuple[StereoImages | None, Heard]:
        """Images of a stereo pair that are new; None without, and of those that are refused."""
        try:
            images, taken = self._stereo.images(period.stamp, period.inputs, heard.images)
        except RefusedMessageError as refusal:
            refusals.append((refusal.topic, str(refusal)))
            return None, replace(heard, images=period.stamp)
        return images, heard if taken == heard.images else replace(heard, images=taken)

    def _drive(
        self, state: DriveAppState, period: Period, views: Views, refusals: list[Refusal]
    ) -> DriveAppState | None:
        """The state after a step with the measurements of this period; None where they cannot be used, with the refusal
        added to `refusals`.
        """
        joints, imu = (period.inputs.get(name) for name in MEASUREMENTS)
        if joints is None or imu is None:  # refused on arrival, or too old
            return None
        stamp, drive = period.stamp, state.drive
        try:
            measured, heard = self._measured(state, period, views)
            if state.stepped_at is None and stamp > stamps.CONTROL_PERIOD_NS:
                drive = self.model.in_motion(drive)
            since = _since(state.stepped_at, stamp)
            if since > LONGEST_PERIOD:
                odometry = stood(self.model.params.odometry, drive.odometry, since - LONGEST_PERIOD)
                drive = replace(drive, odometry=odometry)
            drive, output = self.model.step(drive, measured, min(since, LONGEST_PERIOD))
        except (MachineError, RefusedMessageError) as error:
            refusals.append(("/joint_states", str(error)))
            return None
        asked = replace(state.asked, pending=None, abandoned="", question=None)
        gyro = measured.felt.gyro or (0.0, 0.0, 0.0)
        told = replace(output, make_status=None)
        return replace(
            state,
            drive=drive,
            output=told,
            asked=asked,
            heard=heard,
            stepped_at=stamp,
            tilt_rates=(gyro[0], gyro[1]),
        )

    def _measured(self, state: DriveAppState, period: Period, views: Views) -> tuple[DriveInput, Heard]:
        """What the drive is told of this period, and what has been heard with it."""
        inputs, asked, heard = period.inputs, state.asked, state.heard
        sun, sun_at = self._sun.sighting(period.stamp, inputs.get("/sun_direction"), heard.sun)
        twist = None
        if asked.twist is not None:
            sent, wanted = asked.twist
            twist = TwistCommand(wanted, max(period.stamp - sent, 0) * 1e-9)
        joints, imu = (inputs[name] for name in MEASUREMENTS)
        measured = replace(
            self._measurements.drive_input(joints, imu),
            sun=sun,
            cloud=views.cloud,
            images=views.images,
            twist=twist,
            goal=asked.pending,
            question=asked.question,
            supply=heard.supply,
            power_limit=heard.power_limit,
        )
        if asked.abandoned:
            measured = replace(measured, stop=True, stop_reason=asked.abandoned)
        if heard.interlock:
            measured = replace(measured, goal=None, stop=True, stop_reason=heard.interlock)
        return measured, replace(heard, sun=sun_at)

    def _messages(
        self, state: DriveAppState, output: DriveOutput, stamp: int, missing: str
    ) -> Iterator[tuple[str, Any]]:
        yield "/drive_command", self._measurements.command(stamp, output)  # first: the plant waits for it
        yield "/odom", odometry_report(stamp, output, state.tilt_rates)
        if is_due(topic("/drive/status"), stamp // stamps.CONTROL_PERIOD_NS):
            status = {} if output.pace is None else drive_status(self.model, state.drive, output.pace)
            said = state.asked.last.status(state.drive)
            if state.asked.question is None:  # what has been asked is answered
                status |= state.asked.questioned.status(state.drive.foreseen)
            status |= state.asked.placed.status()
            if missing:  # long before a goal is given up for it
                status["missing_inputs"] = missing
            yield "/drive/status", drive_report(stamp, said, status)
        if is_due(topic("/plan"), stamp // stamps.CONTROL_PERIOD_NS):
            yield "/plan", plan(stamp, state.drive)
        if is_due(topic("/local_costmap/costmap"), stamp // stamps.CONTROL_PERIOD_NS):
            yield "/local_costmap/costmap", costmap(stamp, state.drive.avoidance)


def _missing(period: Period) -> str:
    """Measurements that a period lacks, and why, where they were refused; "" where it has all."""
    missing = [name for name in MEASUREMENTS if period.inputs.get(name) is None]
    if not missing:
        return ""
    cause = last_refused(period.last_refusal) if period.last_refusal.startswith(tuple(missing)) else ""
    return f"{', '.join(missing)}; {cause}" if cause else ", ".join(missing)


def _stopped(output: DriveOutput) -> DriveOutput:
    """Nothing moves, and what is held by its position stays where it is."""
    return replace(output, references=output.references.stopped(), outcomes=())


def _since(before: int | None, stamp: int) -> float:
    """Time since the last period with measurements [s]: of a drive that has just started one."""
    return stamps.CONTROL_PERIOD_S if before is None else (stamp - before) * 1e-9


def _planar(message: TwistStamped) -> PlanarTwist:
    return PlanarTwist(float(message.linear[0]), float(message.linear[1]), float(message.angular[2]))
