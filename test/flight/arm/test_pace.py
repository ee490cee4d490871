"""Pauses on the path at any moment, and motions under less power than they were planned for."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_flight.arm import controller
from sojourn_flight.arm.dynamics import rigid_effort
from sojourn_flight.arm.goals import JointGoal, NamedGoal, PauseGoal, ResumeGoal, StopGoal, TrajectoryGoal
from sojourn_flight.arm.model import build_arm_model
from sojourn_flight.arm.motion_load import motor_efforts, power_drawn
from sojourn_flight.arm.phases import Moving, Stopping
from sojourn_flight.arm.state import ArmInput, ArmOutput, ArmState, Granted, initial_state
from sojourn_flight.arm.trajectory import JointReference, at_rest, point_to_point, stop

DT = 0.02
MARS = np.array([0.0, 0.0, -3.71])
SCENARIO = load_scenario("flat_drive")
PARAMS = SCENARIO.carried_arm().model_copy(update={"gear_compliance": (), "gear_backlash": (), "bearing_friction": ()})
MODEL = build_arm_model(SCENARIO.urdf_xml, PARAMS)


class Follower:
    """An arm that is where its reference is; every sample of it is checked: speed, acceleration, and jerk as the third
    difference of the commands."""

    def __init__(self) -> None:
        self.state: ArmState = initial_state(PARAMS)
        self.joints = np.array(PARAMS.named_poses["unfold"])
        self.granted: float | None = None
        self.current = 1.0
        self.samples: list[JointReference] = []
        self.power: list[float] = []
        self.out: ArmOutput | None = None
        self.period()

    def period(self, goal: Any = None) -> ArmOutput:
        """One period; the limits of speed and acceleration hold in it."""
        asked = ArmInput(self.joints, np.zeros(5), MARS, goal, granted=Granted(self.granted, self.current))
        self.state, self.out = controller.step(PARAMS, MODEL, self.state, asked, DT)
        self.joints = self.state.reference.position
        reference = self.state.reference
        self.samples.append(reference)
        jerk = np.diff([sample.position for sample in self.samples[-4:]], 3, axis=0) / DT**3
        assert np.all(np.abs(jerk) <= MODEL.max_jerk * (1.0 + 1e-4))
        assert np.all(np.abs(reference.velocity) <= MODEL.max_velocity * (1.0 + 1e-6))
        assert np.all(np.abs(reference.acceleration) <= MODEL.max_acceleration * (1.0 + 1e-4))
        rigid = rigid_effort(MODEL, reference.position, reference.velocity, reference.acceleration, MARS)
        motor = motor_efforts(PARAMS, rigid[None, :], reference.velocity[None, :])
        self.power.append(float(power_drawn(PARAMS, motor, reference.velocity[None, :])[0]))
        return self.out

    @property
    def moving(self) -> Moving:
        assert isinstance(self.state.phase, Moving)
        return self.state.phase

    def until(self, done: Callable[[ArmOutput], bool], periods: int = 6000) -> ArmOutput:
        for _ in range(periods):
            out = self.period()
            if done(out):
                return out
        raise AssertionError(f"never: {out}")


def _off_line(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> float:
    """Largest distance of points (m, n) from the straight line in joint space."""
    along = (end - start) / np.linalg.norm(end - start)
    out = points - start
    return float(np.max(np.linalg.norm(out - np.outer(out @ along, along), axis=1)))


@given(at=st.integers(min_value=1, max_value=700), rest=st.integers(min_value=1, max_value=60))
@settings(max_examples=12, deadline=None)
def test_a_pause_at_any_moment_rests_on_the_path_and_goes_on_to_the_same_end(at: int, rest: int) -> None:
    arm = Follower()
    start, end = arm.joints, np.array([0.9, -0.4, 0.9, -0.3, 1.1])
    arm.period(JointGoal(PARAMS.joint_names, tuple(end)))
    for _ in range(at):
        arm.period()
    if not isinstance(arm.state.phase, Moving):
        with pytest.raises(AssertionError):
            arm.until(lambda out: out.status == "paused", 5)
        return
    arm.period(PauseGoal())
    out = arm.until(lambda out: out.status in ("paused", "reached"), 400)
    if out.status == "paused":
        still = arm.joints.copy()
        for _ in range(rest):
            assert not np.any(np.abs(arm.period().velocities) > 1e-9)
        assert arm.joints == pytest.approx(still, abs=1e-12)
        assert "paused at" in out.reason
        arm.period(ResumeGoal())
    assert arm.until(lambda out: out.status != "moving").status == "reached"
    assert arm.joints == pytest.approx(end, abs=1e-9)
    assert _off_line(np.array([sample.position for sample in arm.samples]), start, end) < 1e-9


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("standing", [0.0, 1e-12])
def test_a_trajectory_that_stands_is_paused_too(standing: float) -> None:
    """An operator may ask to wait in a posture. The pause was accepted and never came, and a division was 0 / 0."""
    arm = Follower()
    points = (tuple(arm.joints), tuple(arm.joints + standing), tuple(arm.joints))
    arm.period(TrajectoryGoal(PARAMS.joint_names, (1.0, 4.0, 8.0), points))
    arm.period(PauseGoal())
    out = arm.until(lambda out: out.status != "moving", 100)
    assert out.status == "paused"
    for _ in range(500):
        assert arm.period().status == "paused", "for longer than the trajectory lasts"
    arm.period(ResumeGoal())
    assert arm.until(lambda out: out.status != "moving").status == "reached"


def test_pause_and_resume_are_refused_where_there_is_nothing_to_do() -> None:
    arm = Follower()
    assert "no motion is under way" in arm.period(PauseGoal()).reason
    assert "no motion is paused" in arm.period(ResumeGoal()).reason
    arm.period(NamedGoal("stow"))
    arm.period(PauseGoal())
    assert "already" in arm.period(PauseGoal()).reason
    arm.until(lambda out: out.status == "paused")
    arm.period(StopGoal())
    assert arm.until(lambda out: out.status != "moving").status == "stopped"
    assert "no motion is paused" in arm.period(ResumeGoal()).reason


def test_a_stop_on_a_straight_line_stays_on_it() -> None:
    """It used to stop every joint for itself, and left the line that had been checked for collisions."""
    start, end = np.array(PARAMS.named_poses["unfold"]), np.array([0.9, -0.4, 0.9, -0.3, 1.1])
    path = point_to_point(MODEL, at_rest(start), end)
    for share in np.linspace(0.02, 0.98, 25):
        brake = stop(MODEL, JointReference(*path.sample(share * path.duration)))
        points = brake.samples(np.linspace(0.0, brake.duration, 50))
        assert _off_line(points, start, end) < 1e-6
        assert not np.any(np.abs(brake.sample(brake.duration)[1]) > 1e-9)


def test_with_less_power_granted_a_motion_is_planned_slower() -> None:
    full, little = Follower(), Follower()
    full.period(NamedGoal("stow"))
    assert isinstance(full.state.phase, Moving)
    full.until(lambda out: out.status == "reached")
    peak = max(full.power)
    little.granted = 0.4 * peak
    little.period(NamedGoal("stow"))
    little.until(lambda out: out.status == "reached")
    assert len(little.samples) > 1.3 * len(full.samples)
    assert max(little.power) <= 0.4 * peak * (1.0 + 1e-6)


def test_a_motion_under_way_slows_down_when_power_is_taken_and_takes_up_speed_again() -> None:
    plain, arm = Follower(), Follower()
    for each in (plain, arm):
        each.period(NamedGoal("stow"))
    plain.until(lambda out: out.status == "reached")
    peak = max(plain.power)
    for _ in range(60):
        arm.period()
    arm.granted = 0.35 * peak
    assert "W are granted" in arm.period().reason
    for _ in range(60):
        arm.period()
    first = len(arm.power)
    for _ in range(100):
        arm.period()
    assert max(arm.power[first:]) <= 0.35 * peak
    assert 0.0 < arm.moving.pace < 1.0 and arm.moving.clock.rate == pytest.approx(arm.moving.pace, abs=1e-6)
    arm.granted = None
    arm.period()
    assert arm.moving.pace == 1.0
    arm.until(lambda out: out.status == "reached")
    assert len(plain.samples) < len(arm.samples)
    ways = [np.array([sample.position for sample in each.samples]) for each in (plain, arm)]
    assert _largest_gap(*ways) < 5e-3, "the same path"


def _largest_gap(path: np.ndarray, other: np.ndarray) -> float:
    """Largest distance of points of `other` from the nearest of `path`."""
    return float(max(np.min(np.linalg.norm(path - point, axis=1)) for point in other))


def test_a_stop_under_little_power_takes_as_long_as_the_limits_ask_for() -> None:
    """The time to go used to be that of a motion at the pace that the power allows."""
    arm = Follower()
    arm.period(NamedGoal("stow"))
    for _ in range(60):
        arm.period()
    arm.granted = 0.35 * max(arm.power)
    for _ in range(30):
        arm.period()
    assert 0.0 < arm.moving.pace < 0.9
    brake = stop(MODEL, arm.state.reference)
    out = arm.period(StopGoal())
    assert isinstance(arm.state.phase, Stopping) and out.time_to_go == pytest.approx(brake.duration - DT, abs=1e-9)
    assert arm.until(lambda out: out.status != "moving").status == "stopped"


def test_where_not_even_holding_is_granted_it_waits() -> None:
    arm = Follower()
    arm.period(NamedGoal("stow"))
    for _ in range(50):
        arm.period()
    arm.granted = 1e-6
    arm.period()
    assert "to hold the arm the arm would draw" in arm.state.reason and arm.moving.pace == 0.0
    for _ in range(200):
        arm.period()
    assert not np.any(arm.samples[-1].velocity) and arm.out is not None and arm.out.status == "moving"
    arm.granted = 50.0
    assert arm.until(lambda out: out.status != "moving").status == "reached"


def test_with_a_share_of_its_current_a_motor_has_a_share_of_its_torque() -> None:
    """A plan that needs more is slower or refused; it used to be planned with all of it, and the arm fell behind."""
    arm = Follower()
    arm.granted, arm.current = 2.5, 2.5 / 80.0
    out = arm.period(NamedGoal("stow"))
    assert out.status == "refused" and "of what it can give, however slowly it moves" in out.reason
    arm.granted, arm.current = 40.0, 0.5
    assert arm.period(NamedGoal("stow")).status == "moving"
    arm.granted, arm.current = 2.5, 2.5 / 80.0
    arm.period()
    assert arm.moving.pace == 0.0 and "waits: 2.5 W are granted, and to hold the arm arm_" in arm.state.reason


def test_a_state_that_was_saved_in_a_pause_goes_on_the_same_way() -> None:
    arm, twin = Follower(), Follower()
    arm.period(NamedGoal("stow"))
    for _ in range(80):
        arm.period()
    arm.period(PauseGoal())
    for _ in range(20):
        arm.period()
    twin.state, twin.joints, twin.samples = replace(arm.state), arm.joints, []
    for _ in range(40):
        assert np.array_equal(arm.period().positions, twin.period().positions)
