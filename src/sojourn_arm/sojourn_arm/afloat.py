"""Goals of an arm whose base floats free: a pose is a place in space, and is reached there although the base gives way.

A pose in base_link means base_link as it is when the goal takes effect. The posture is sought that has the hand there
once the base has given way by the motion to it (`floating_base.foretold`), as a fixed point of inverse kinematics and
foretelling. Once the arm has come to rest, the base is looked for where its turn, by the IMU, and its centre of mass
have it; where the hand is further off than `tolerance` the same is done again from there.

Space moves with the centre of mass of the machine: what drifts as a whole cannot be felt aboard.
"""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from sojourn_arm.rover import in_base
from sojourn_arm.tasks import Request
from sojourn_contract.values import Imu
from sojourn_flight.arm.floating_base import FloatingBase
from sojourn_flight.arm.goal_events import GoalEvent, was
from sojourn_flight.arm.goals import PoseGoal, pose_target
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.planning import solve_pose
from sojourn_flight.arm.refusal import GoalRefusedError
from sojourn_flight.arm.state import ArmOutput
from sojourn_machine.evolution import replace
from sojourn_machine.mounting import IMU_LINK, mounting
from sojourn_machine.params import FloatArray

MOST_CORRECTIONS = 5
MOST_LOOKS = 30
"""At where the base comes to, for one posture."""
SAME_PLACE = 0.1
"""Part of the tolerance by which two looks may differ for the same."""


@dataclass(frozen=True, slots=True, eq=False)
class Attitude:
    """Joints and base at one moment."""

    joints: FloatArray
    """(n,) [rad or m]"""
    rotation: FloatArray
    """Of base_link in the world of the IMU, (3, 3)."""


@dataclass(frozen=True, slots=True, eq=False)
class SpaceGoal:
    """What is asked for of the hand, or of the joints, and since when."""

    then: Attitude
    place: PoseGoal | None = None
    """In base_link of then; None where joints are asked for, or once it has ended."""
    correction: PoseGoal | None = None
    """The same in base_link as it is to become, which the arm is given next."""
    corrections: int = 0


class Afloat:
    """Aims at places in space, and looks whether they were reached."""

    def __init__(self, params: ArmParams, model: ArmModel, urdf_xml: str) -> None:
        self._params, self._model = params, model
        self._base = FloatingBase(urdf_xml, params)
        self._imu_to_base = mounting(urdf_xml, IMU_LINK)[0]
        self._near = 2.0 * params.joint_tolerance * model.reach
        self._aligned = params.joint_tolerance * model.joint_count

    def attitude(self, joints: FloatArray, imu: Imu) -> Attitude:
        """By the measurements of a period."""
        turn = pin.Quaternion(np.asarray(imu.orientation)).normalized().toRotationMatrix()
        return Attitude(joints, turn @ self._imu_to_base.T)

    def taken(self, before: SpaceGoal | None, request: Request, now: Attitude) -> tuple[SpaceGoal, Request]:
        """The goal of a period, and what the arm is asked for.

        Raises:
            GoalRefusedError: a place from which the base would carry the hand away again.
        """
        if before is not None and request == before.correction:  # by value: one that is kept is read as two objects
            return before, request
        if not isinstance(request, PoseGoal):
            return SpaceGoal(now), request
        return SpaceGoal(now, request), self._aimed(request, now.joints)

    def followed(
        self, goal: SpaceGoal, request: Request | None, now: Attitude, output: ArmOutput
    ) -> tuple[SpaceGoal, ArmOutput]:
        """The goal after a period in which the arm was asked for `request`, and what is told of it."""
        events = output.events
        if request is not None and request == goal.correction:
            goal, events = replace(goal, correction=None), tuple([self._of_correction(event) for event in events])
            events = tuple([event for event in events if event.outcome != "accepted"])
        if goal.place is not None and was("reached", events):
            goal, ended = self._arrived(goal, goal.place, now)
            events = tuple([event for event in events if event.outcome != "reached"]) + ended
        if any(event.outcome in ("reached", "stopped", "failed", "refused") for event in events):
            goal = replace(goal, place=None, correction=None)
        return goal, output if events is output.events else replace(output, events=events)

    def told(self, goal: SpaceGoal, now: Attitude) -> dict[str, str]:
        """How the base has given way since the goal, as it is believed."""
        base = self._given_way(goal.then, now)
        moved, turned = np.linalg.norm(base.translation), np.linalg.norm(pin.log3(base.rotation))
        return {
            "base_moved_m": f"{moved:.4f}",
            "base_turned_deg": f"{np.degrees(turned):.3f}",
            "corrections": str(goal.corrections),
        }

    def _given_way(self, then: Attitude, now: Attitude) -> pin.SE3:
        return self._base.given_way(then.joints, now.joints, then.rotation.T @ now.rotation)

    @staticmethod
    def _of_correction(event: GoalEvent) -> GoalEvent:
        if event.outcome != "refused":
            return event
        return GoalEvent("failed", f"the base has given way, and the arm cannot make up for it: {event.reason}")

    def _arrived(self, goal: SpaceGoal, place: PoseGoal, now: Attitude) -> tuple[SpaceGoal, tuple[GoalEvent, ...]]:
        """The arm is at rest: the goal is reached, or it goes on, or it is not."""
        here = in_base(place, self._given_way(goal.then, now))
        apart, turned = self._off(here, now.joints)
        if apart <= self._near and turned <= self._aligned:
            return goal, (GoalEvent("reached"),)
        off = f"the hand is {1e3 * apart:.1f} mm and {np.degrees(turned):.2f} degrees off its place in space"
        if goal.corrections == MOST_CORRECTIONS:
            return goal, (GoalEvent("failed", f"{off} after {MOST_CORRECTIONS} corrections"),)
        try:
            correction = self._aimed(here, now.joints)
        except GoalRefusedError as error:
            return goal, (GoalEvent("failed", f"{off}, and {error}"),)
        return replace(goal, correction=correction, corrections=goal.corrections + 1), ()

    def _aimed(self, place: PoseGoal, joints: FloatArray) -> PoseGoal:
        """A place in base_link of now as it is in base_link once the arm has gone there from (n,)."""
        aim, point = place, np.array(place.position)
        for _ in range(MOST_LOOKS):
            posture = self._posture(aim, joints)
            if posture is None:
                return aim  # the arm will say why
            aim = in_base(place, self._base.foretold(joints, posture))
            before, point = point, np.array(aim.position)
            if np.linalg.norm(point - before) < SAME_PLACE * self._near:
                return aim
        raise GoalRefusedError("the base gives way so far that no posture was found which has the hand there")

    def _posture(self, aim: PoseGoal, joints: FloatArray) -> FloatArray | None:
        """That the arm will take, if none other is in its way; None where there is none."""
        position, direction = pose_target(aim)
        wishes = [direction]
        if direction is None and self._params.preferred_direction is not None:
            wishes.insert(0, np.array(self._params.preferred_direction))
        for wish in wishes:
            found = solve_pose(self._params, self._model, position, wish, joints, explain=False)
            if found.status == "solved":
                return found.solutions[0]
        return None

    def _off(self, here: PoseGoal, joints: FloatArray) -> tuple[float, float]:
        """How far the hand is off a place in base_link of now [m], [rad]."""
        position, wanted = pose_target(here)
        tip, turned = forward_kinematics(self._model, joints), 0.0
        if wanted is not None and wanted.ndim == 2:
            turned = float(np.linalg.norm(pin.log3(wanted.T @ tip.rotation)))
        elif wanted is not None:
            turned = float(np.arccos(np.clip(wanted @ tip.tool_direction, -1.0, 1.0)))
        return float(np.linalg.norm(position - tip.position)), turned
