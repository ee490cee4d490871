"""Steering kinematics against closed forms, published geometry and numpy's least squares."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from placements import geometry_from_placements
from sojourn_flight.mobility.kinematics import limited_twist, wheels_from_twist
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.mobility.wheel_twist import twist_from_wheels, velocity_kernel
from sojourn_machine.errors import MachineError
from sojourn_machine.params import FloatArray

FULL = (-1.6, 1.6)  # a little more than a half turn in all: every heading can be reached


def machine(positions: list[tuple[float, float]], limits: tuple[float, float] = FULL) -> FloatArray:
    """All wheels steered, radius 0.2 m."""
    names = [f"wheel_{i}" for i in range(len(positions))]
    count = len(positions)
    return geometry_from_placements(names, positions, [0.2] * count, [limits] * count).table()


@st.composite
def machines(draw: st.DrawFn) -> FloatArray:
    """3 to 10 wheels; fixed ones only on the y axis, where a twist without v_y suits them."""
    count = draw(st.integers(3, 10))
    place = st.floats(-2.0, 2.0)
    steered = [True, *draw(st.lists(st.booleans(), min_size=count - 1, max_size=count - 1))]
    positions = [(draw(place) if turns else 0.0, draw(place)) for turns in steered]
    spread = np.ptp(np.array(positions), axis=0)
    assume(np.hypot(*spread) > 0.3)
    radii = draw(st.lists(st.floats(0.05, 0.5), min_size=count, max_size=count))
    limits = [FULL if turns else None for turns in steered]
    return geometry_from_placements([f"w{i}" for i in range(count)], positions, radii, limits).table()


@settings(max_examples=150, deadline=None)
@given(
    machines(),
    st.floats(-1.0, 1.0),
    st.floats(-1.0, 1.0),
    st.floats(-1.0, 1.0),
    st.randoms(use_true_random=False),
)
def test_twist_to_wheels_and_back(table: FloatArray, v_x: float, v_y: float, yaw_rate: float, random) -> None:
    if (table[:, 3] == 0.0).any():
        v_y = 0.0
    present = np.array([random.uniform(*FULL) if wheel[3] else 0.0 for wheel in table])
    wheels = wheels_from_twist(table, PlanarTwist(v_x, v_y, yaw_rate), present)
    assert (wheels.steer_angles >= table[:, 4]).all()
    assert (wheels.steer_angles <= table[:, 5]).all()
    assert np.abs(wheels.residual).max() < 1e-9
    back = twist_from_wheels(table, wheels.wheel_rates, wheels.steer_angles)
    np.testing.assert_allclose(back[:3], (v_x, v_y, yaw_rate), rtol=0.0, atol=1e-9)
    assert back.residual < 1e-9
    known = velocity_kernel(table, wheels.wheel_rates, wheels.steer_angles, np.zeros(len(table)), yaw_rate, 1.0)
    np.testing.assert_allclose(known, (v_x, v_y, 0.0), rtol=0.0, atol=1e-9)


@settings(max_examples=100, deadline=None)
@given(st.floats(-3.1, 3.1), st.floats(-2.0, 2.0), st.floats(-3.5, -1.6), st.floats(1.6, 3.5))
def test_the_nearest_heading_inside_the_limits_is_taken(
    direction: float, present: float, lower: float, upper: float
) -> None:
    table = machine([(0.5, 0.5), (0.5, -0.5), (-0.5, 0.0)], (lower, upper))
    twist = PlanarTwist(math.cos(direction), math.sin(direction), 0.0)
    wheels = wheels_from_twist(table, twist, np.full(3, present))
    inside = [direction + k * math.pi for k in range(-4, 5) if lower <= direction + k * math.pi <= upper]
    nearest = min(abs(angle - present) for angle in inside)
    assert abs(wheels.steer_angles[0] - present) == pytest.approx(nearest, abs=1e-8)
    # rolls the right way: rate along the heading is the velocity
    heading = np.array([math.cos(wheels.steer_angles[0]), math.sin(wheels.steer_angles[0])])
    np.testing.assert_allclose(0.2 * wheels.wheel_rates[0] * heading, twist[:2], atol=1e-9)


@pytest.mark.published("the vehicle's turning radius of 10 ft, and its geometry")
def test_lunar_roving_vehicle_ackermann_angles() -> None:
    # Wheelbase 2.286 m, track 1.829 m, both axles steered against each other: with the outer wheel at 22 deg
    # the ideal inner angle is 48.8 deg, the centre's radius 1.915 m, the outer wheel's 3.05 m (10 ft).
    x, y = 2.286 / 2, 1.829 / 2
    table = machine([(x, y), (x, -y), (-x, y), (-x, -y)], (-0.9, 0.9))
    radius = x / math.tan(math.radians(22.0)) - y
    assert radius == pytest.approx(1.915, abs=0.001)
    wheels = wheels_from_twist(table, PlanarTwist(1.915, 0.0, 1.0), np.zeros(4))
    angles = np.degrees(wheels.steer_angles)
    assert angles == pytest.approx(np.array([48.8, 22.0, -48.8, -22.0]), abs=0.05)
    assert wheels.wheel_rates[1] * 0.2 == pytest.approx(3.05, abs=0.005)


def test_axles_meet_in_the_centre_of_rotation(explorer: SteeringGeometryParams) -> None:
    table = explorer.table()
    wheels = wheels_from_twist(table, PlanarTwist(0.1, 0.0, 0.05), np.zeros(6))
    centre = np.array([0.0, 0.1 / 0.05])
    for row, angle, rate in zip(table, wheels.steer_angles, wheels.wheel_rates, strict=True):
        arm = row[:2] - centre
        assert arm @ [math.cos(angle), math.sin(angle)] == pytest.approx(0.0, abs=1e-12)
        assert rate * row[2] == pytest.approx(0.05 * np.hypot(*arm))


def test_crab_turns_all_wheels_the_same_way() -> None:
    table = machine([(0.7, 0.5), (0.7, -0.5), (-0.7, 0.5), (-0.7, -0.5)])
    angle = math.radians(30.0)
    wheels = wheels_from_twist(table, PlanarTwist(math.cos(angle), math.sin(angle), 0.0), np.zeros(4))
    np.testing.assert_allclose(wheels.steer_angles, angle)
    np.testing.assert_allclose(wheels.wheel_rates, 1.0 / 0.2)


def test_sideways_from_straight_ahead_rolls_forward() -> None:
    table = machine([(0.7, 0.5), (0.7, -0.5), (-0.7, 0.0)])
    wheels = wheels_from_twist(table, PlanarTwist(0.0, -1.0, 0.0), np.zeros(3))
    np.testing.assert_allclose(wheels.steer_angles, -math.pi / 2)
    np.testing.assert_allclose(wheels.wheel_rates, 5.0)


def test_point_turn_of_the_explorer_is_folded_into_the_limits(explorer: SteeringGeometryParams) -> None:
    wheels = wheels_from_twist(explorer.table(), PlanarTwist(0.0, 0.0, 0.1), np.zeros(6))
    corner = math.atan2(0.705, 0.53)  # the left wheels go backwards: 127 deg becomes -53 deg with a negative rate
    np.testing.assert_allclose(wheels.steer_angles, [-corner, corner, 0.0, 0.0, corner, -corner])
    far, near = 0.1 * math.hypot(0.705, 0.53) / 0.125, 0.1 * 0.53 / 0.125
    np.testing.assert_allclose(wheels.wheel_rates, [-far, far, -near, near, -far, far])


def test_angle_out_of_reach_is_clipped_and_the_rest_reported() -> None:
    table = machine([(0.7, 0.5), (0.7, -0.5), (-0.7, 0.0)], (-0.3, 0.3))
    direction = math.radians(45.0)
    wheels = wheels_from_twist(table, PlanarTwist(math.cos(direction), math.sin(direction), 0.0), np.zeros(3))
    np.testing.assert_allclose(wheels.steer_angles, 0.3)
    np.testing.assert_allclose(wheels.wheel_rates, math.cos(direction - 0.3) / 0.2)
    np.testing.assert_allclose(wheels.residual, math.sin(direction - 0.3))


def test_fixed_wheels_off_the_axis_report_what_they_scrub() -> None:
    corners = [(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)]
    geometry = geometry_from_placements(list("abcd"), corners, [0.2] * 4, [None] * 4)
    table = geometry.table()
    wheels = wheels_from_twist(table, PlanarTwist(0.0, 0.0, 1.0), np.zeros(4))
    np.testing.assert_allclose(wheels.residual, [0.5, 0.5, -0.5, -0.5])
    np.testing.assert_allclose(wheels.wheel_rates, [-2.0, 2.0, -2.0, 2.0])
    # free-rolling centres 1.5 tracks apart: the sides must differ by so much more
    wider = geometry.table(1.5)
    wheels = wheels_from_twist(wider, PlanarTwist(0.3, 0.0, 1.0), np.zeros(4))
    np.testing.assert_allclose(wheels.wheel_rates, (0.3 + 0.6 * np.array([-1, 1, -1, 1])) / 0.2)
    back = twist_from_wheels(wider, wheels.wheel_rates, wheels.steer_angles, 0.5)
    np.testing.assert_allclose(back, (0.3, 0.0, 1.0, 0.0), atol=1e-12)


def test_no_twist_keeps_the_angles(explorer: SteeringGeometryParams) -> None:
    present = np.array([0.3, -0.2, 0.0, 0.0, 0.1, 1.0])
    wheels = wheels_from_twist(explorer.table(), PlanarTwist(0.0, 0.0, 0.0), present)
    np.testing.assert_array_equal(wheels.steer_angles, present)
    np.testing.assert_array_equal(wheels.wheel_rates, np.zeros(6))


@settings(max_examples=60, deadline=None)
@given(machines(), st.floats(0.01, 1.0), st.integers(0, 2**32 - 1))
def test_inverse_is_the_weighted_least_squares_solution(table: FloatArray, weight: float, seed: int) -> None:
    generator = np.random.default_rng(seed)
    count = len(table)
    rates = generator.normal(size=count)
    angles = np.where(table[:, 3] > 0.5, generator.uniform(-1.5, 1.5, count), 0.0)
    x, y, radius = table[:, 0], table[:, 1], table[:, 2]
    along, across = np.cos(angles), np.sin(angles)
    roll = np.column_stack([along, across, x * across - y * along])
    slide = np.column_stack([-across, along, x * along + y * across])
    lines = np.vstack([roll, math.sqrt(weight) * slide])
    right = np.concatenate([radius * rates, np.zeros(count)])
    expected = np.linalg.lstsq(lines, right, rcond=None)[0]
    found = twist_from_wheels(table, rates, angles, weight)
    np.testing.assert_allclose(found[:3], expected, atol=1e-7)
    misfit = np.concatenate([roll, slide]) @ expected - right
    assert found.residual == pytest.approx(math.sqrt(misfit @ misfit / count), abs=1e-7)
    yaw_rate = 0.3
    known = np.linalg.lstsq(lines[:, :2], right - yaw_rate * lines[:, 2], rcond=None)[0]
    np.testing.assert_allclose(
        velocity_kernel(table, rates, angles, np.zeros(count), yaw_rate, weight)[:2], known, atol=1e-7
    )


@settings(max_examples=100, deadline=None)
@given(machines(), st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)))
def test_limited_twist_is_inside_all_limits_and_keeps_its_centre(
    table: FloatArray, numbers: tuple[float, float, float]
) -> None:
    twist = PlanarTwist(*numbers)
    limited, factor = limited_twist(table, twist, 0.5, 0.4, 2.0)
    assert 0.0 < factor <= 1.0
    np.testing.assert_allclose(limited, np.array(twist) * factor)
    speed_ratio = math.hypot(limited.v_x, limited.v_y) / 0.5
    rates = wheels_from_twist(table, limited, np.zeros(len(table))).wheel_rates
    ratios = [speed_ratio, abs(limited.yaw_rate) / 0.4, np.abs(rates).max() / 2.0]
    assert max(ratios) <= 1.0 + 1e-9
    if factor < 1.0:
        assert max(ratios) == pytest.approx(1.0)


def test_bad_numbers_are_refused_by_name(explorer: SteeringGeometryParams) -> None:
    table = explorer.table()
    with pytest.raises(MachineError, match="yaw_rate = nan"):
        wheels_from_twist(table, PlanarTwist(0.0, 0.0, math.nan), np.zeros(6))
    with pytest.raises(MachineError, match="present steer angles"):
        wheels_from_twist(table, PlanarTwist(0.0, 0.0, 0.0), np.zeros(5))
    with pytest.raises(MachineError, match="wheel rates"):
        twist_from_wheels(table, np.full(6, math.inf), np.zeros(6))
    with pytest.raises(MachineError, match="lateral_weight"):
        twist_from_wheels(table, np.zeros(6), np.zeros(6), 0.0)
