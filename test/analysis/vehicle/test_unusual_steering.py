"""Slip steering by the balance of power, articulated steering by kinematics and by its rigid limit."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from sojourn_analysis.vehicle.articulated import (
    Joint,
    VehicleUnit,
    eigenvalues,
    stable_speed,
    state_matrix,
    steady_turn,
    turning_radii,
    yaw_rate,
)
from sojourn_analysis.vehicle.handling import SingleTrack, poles
from sojourn_analysis.vehicle.slip_steering import SlipVehicle, spin_moment
from sojourn_analysis.vehicle.slip_steering import steady_turn as slip_turn
from sojourn_analysis.vehicle.slip_steering import wheel_forces as slip_forces
from sojourn_machine.errors import InvalidValueError

PLACES = np.array([[0.4, 0.35], [0.4, -0.35], [-0.4, 0.35], [-0.4, -0.35]])
SKID = SlipVehicle(PLACES, np.full(4, 100.0), 0.6, 1e-3)


@given(left=st.floats(-0.5, 0.5), right=st.floats(-0.5, 0.5))
def test_power_of_the_rims_is_lost_in_sliding(left: float, right: float) -> None:
    if abs(left - right) < 0.02:
        return
    turn = slip_turn(SKID, left, right)
    assert turn.forces.sum(axis=0) == pytest.approx([0.0, 0.0], abs=1e-6)
    assert turn.power == pytest.approx(turn.sliding_power, rel=1e-6)
    assert turn.power > 0.0
    assert turn.width_ratio > 1.0


def test_turning_on_the_spot_against_the_spin_moment() -> None:
    turn = slip_turn(SKID, -0.3, 0.3)
    assert (turn.forward, turn.side) == (pytest.approx(0.0, abs=1e-9), pytest.approx(0.0, abs=1e-9))
    assert 0.0 < turn.yaw_rate < 0.6 / 0.7
    # rims at rest, the machine turned from outside: every wheel resists at right angles to its arm
    forces, _ = slip_forces(SKID, np.zeros(4), np.array([0.0, 0.0, 5.0]))
    moment = np.sum(PLACES[:, 0] * forces[:, 1] - PLACES[:, 1] * forces[:, 0])
    assert moment == pytest.approx(-spin_moment(SKID), rel=1e-3)


def test_a_short_wide_vehicle_turns_as_its_rims_say() -> None:
    """All wheels on one line across: nothing scrubs, the yaw rate is the difference of the rims over the track."""
    wide = SKID._replace(places=PLACES * np.array([1e-6, 1.0]))
    turn = slip_turn(wide, 0.1, 0.3)
    assert turn.yaw_rate == pytest.approx(0.2 / 0.7, rel=1e-4)
    assert turn.forward == pytest.approx(0.2, rel=1e-4)


FRONT, REAR = VehicleUnit(400.0, 150.0, 0.6, 0.7, 30e3), VehicleUnit(500.0, 200.0, 0.8, 0.9, 35e3)


@given(angle=st.floats(0.01, 1.2), a=st.floats(0.3, 2.0), b=st.floats(0.3, 2.0))
def test_both_axles_point_at_one_centre(angle: float, a: float, b: float) -> None:
    front, rear = turning_radii(a, b, angle)
    # front axle at the origin heading along x: the joint is at (-a, 0), the rear axle behind it along -angle
    centre = np.array([0.0, front])
    back = np.array([math.cos(angle), -math.sin(angle)])
    axle = np.array([-a, 0.0]) - b * back
    assert np.dot(centre - axle, back) == pytest.approx(0.0, abs=1e-9)
    assert np.linalg.norm(centre - axle) == pytest.approx(abs(rear))
    assert yaw_rate(a, b, 0.5, angle) == pytest.approx(0.5 / front)


def test_yaw_rate_while_the_joint_turns() -> None:
    """Both axles without side slip, by integrating the rear axle's place and comparing its direction of motion."""
    a, b, speed, rate = 0.7, 0.9, 0.5, 0.3

    def place(time: float, state: np.ndarray) -> list[float]:
        heading = state[2]
        return [speed * math.cos(heading), speed * math.sin(heading), yaw_rate(a, b, speed, rate * time, rate)]

    times = np.array([0.999, 1.0, 1.001])
    path = solve_ivp(place, (0.0, 1.001), [0.0, 0.0, 0.0], t_eval=times, rtol=1e-11, atol=1e-13).y
    joint = path[:2] - a * np.array([np.cos(path[2]), np.sin(path[2])])
    rear_heading = path[2] - rate * times
    axle = joint - b * np.array([np.cos(rear_heading), np.sin(rear_heading)])
    motion = axle[:, 2] - axle[:, 0]
    assert math.atan2(motion[1], motion[0]) == pytest.approx(rear_heading[1], abs=1e-6)


def test_slow_steady_turn_is_kinematic() -> None:
    joint = Joint(1e6, 100.0)
    state = steady_turn(FRONT, REAR, joint, 0.01, 0.05)
    assert state[3] == pytest.approx(0.05, rel=1e-3)
    assert state[1] == pytest.approx(yaw_rate(0.7, 0.9, 0.01, 0.05), rel=2e-3)
    assert state[1] == pytest.approx(state[2])


def test_a_locked_joint_makes_one_rigid_vehicle() -> None:
    speed = 8.0
    mass = FRONT.mass + REAR.mass
    centre = (FRONT.mass * FRONT.centre - REAR.mass * REAR.centre) / mass  # ahead of the joint
    inertia = FRONT.yaw_inertia + FRONT.mass * (FRONT.centre - centre) ** 2
    inertia += REAR.yaw_inertia + REAR.mass * (REAR.centre + centre) ** 2
    rigid = SingleTrack(mass, inertia, (0.7 - centre, -0.9 - centre), (30e3, 35e3), (1.0, 0.0))
    expected = sorted(poles(rigid, speed), key=lambda value: (value.real, value.imag))
    values = eigenvalues(FRONT, REAR, Joint(1e9, 1e5), speed)
    slow = sorted(sorted(values, key=abs)[:2], key=lambda value: (value.real, value.imag))
    assert slow == pytest.approx(expected, rel=1e-3)


def test_eigenvalues_tell_what_the_motion_does() -> None:
    joint = Joint(2e3, 10.0)
    limit, kind = stable_speed(FRONT, REAR, joint, highest=60.0)
    assert 0.0 < limit < 60.0 and kind in ("snaking", "folding")
    for factor, grows in ((0.9, False), (1.1, True)):
        matrix = state_matrix(FRONT, REAR, joint, factor * limit)
        late = np.linalg.norm(expm(matrix * 60.0) @ [0.0, 0.0, 0.0, 0.01])
        assert (late > 0.01) == grows


def test_refusals() -> None:
    with pytest.raises(InvalidValueError, match="angle"):
        turning_radii(1.0, 1.0, 1.6)
    with pytest.raises(InvalidValueError, match="speed"):
        state_matrix(FRONT, REAR, Joint(1.0, 1.0), 0.0)
    assert turning_radii(1.0, 1.0, 0.0) == (math.inf, math.inf)
