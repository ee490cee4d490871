"""Straight driving: balances of force and power, limits approached from both sides, quadrature against simulation."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from sojourn_analysis.vehicle.axle_loads import axle_loads
from sojourn_analysis.vehicle.driveline import equivalent_mass, largest_wheel_torque, motor_point
from sojourn_analysis.vehicle.longitudinal import (
    Course,
    driving_range,
    full_throttle_acceleration,
    greatest_grade,
    greatest_pull,
    greatest_speed,
    steady_state,
    time_and_distance_to,
)
from sojourn_analysis.vehicle.params import VehicleParams
from sojourn_machine.errors import InvalidValueError


@given(pull=st.floats(-300.0, 300.0), height=st.floats(0.1, 1.0), shift=st.floats(-0.5, 0.5))
def test_two_axles_carry_what_the_levers_say(pull: float, height: float, shift: float) -> None:
    x = np.array([1.2 + shift, -1.1 + shift])
    front, rear = axle_loads(x, height, 1000.0, pull, [3.0, 7.0])
    assert front == pytest.approx((1000.0 * -x[1] - pull * height) / 2.3)
    assert rear == pytest.approx((1000.0 * x[0] + pull * height) / 2.3)


def test_three_axles_deform_as_one_body() -> None:
    x, rates = np.array([1.0, 0.1, -1.2]), np.array([2.0, 5.0, 3.0])
    found = axle_loads(x, 0.5, 900.0, 100.0, rates)
    assert found.sum() == pytest.approx(900.0)
    assert found @ x == pytest.approx(-50.0)
    deflection = found / rates
    assert np.polyfit(x, deflection, 1) @ [x[1], 1.0] == pytest.approx(deflection[1])


def test_an_axle_lifts_before_it_pulls() -> None:
    x = np.array([1.0, 0.0, -1.0])
    found = axle_loads(x, 1.0, 1000.0, 900.0)
    assert found[0] == 0.0
    assert found.sum() == pytest.approx(1000.0)
    with pytest.raises(InvalidValueError, match="tip"):
        axle_loads(x, 1.0, 1000.0, 1100.0)


@pytest.mark.parametrize("grade_deg", [-10.0, 0.0, 8.0, 18.0])
def test_steady_state_balances_force_and_power(on_soil: Course, grade_deg: float) -> None:
    grade, speed = math.radians(grade_deg), 1.2
    state = steady_state(on_soil, speed, grade)
    assert state is not None
    vehicle = on_soil.vehicle
    assert 2.0 * sum(w.pull for w in state.wheels) == pytest.approx(
        vehicle.mass * on_soil.gravity * math.sin(grade), abs=1e-6
    )
    # electrical power = rise + soil + gear + motor and controller losses; the first two are what the wheels take
    at_wheels = 2.0 * sum(w.torque for w in state.wheels) * state.wheel_rate
    lifted = vehicle.mass * on_soil.gravity * math.sin(grade) * speed
    in_soil = at_wheels - lifted
    assert in_soil > 0.0
    if at_wheels > 0.0:
        assert state.drive_power > at_wheels / vehicle.gear.efficiency


def test_friction_limits_the_grade_on_rock(on_rock: Course) -> None:
    """With strong motors: tan(grade) = mu s/(s + s_c) at the greatest slip, whatever each axle carries."""
    motor = on_rock.vehicle.motor.model_copy(update={"max_current": 400.0})
    strong = Course(on_rock.vehicle.model_copy(update={"motor": motor}), on_rock.wheels, on_rock.gravity)
    grade, limit = greatest_grade(strong, 0.05)
    assert limit == "traction"
    assert math.tan(grade) == pytest.approx(0.8 * 0.8 / 0.85, rel=1e-5)
    pull, slip = greatest_pull(strong, 0.3, 0.05)
    weight = strong.vehicle.mass * strong.gravity * math.cos(0.3)
    assert slip == pytest.approx(0.8)
    assert pull == pytest.approx(weight * math.tan(grade), rel=1e-5)


def test_motors_limit_the_grade_at_speed(on_rock: Course) -> None:
    """No slip to speak of: 4 T(V/r)/r = m g (sin a + f cos a)."""
    grade, limit = greatest_grade(on_rock, 2.5)
    assert limit == "motor"
    at_no_slip = 4.0 * largest_wheel_torque(on_rock.vehicle, 2.5 / 0.4065) / 0.4065
    weight = on_rock.vehicle.mass * on_rock.gravity
    needed = weight * (math.sin(grade) + (0.02 + 1e-3 * 6.25) * math.cos(grade))
    assert 0.9 * at_no_slip < needed < at_no_slip


def test_no_faster_than_the_whole_voltage(on_soil: Course) -> None:
    """A little below the greatest speed, at one slip for all, the most loaded motor is at the bus voltage."""
    fastest = greatest_speed(on_soil, 0.05)
    state = steady_state(on_soil, 0.98 * fastest, 0.05)
    assert state is not None
    voltages = [motor.voltage for motor in state.motors]
    assert min(voltages) < on_soil.vehicle.bus_voltage
    beyond = steady_state(on_soil, 1.02 * fastest, 0.05)
    assert beyond is not None and not beyond.feasible


def test_range_is_the_battery_over_the_energy(on_soil: Course) -> None:
    state = steady_state(on_soil, 3.0)
    assert state is not None
    time = on_soil.vehicle.battery_energy_wh * 3600.0 / state.bus_power
    assert driving_range(on_soil, 3.0) == pytest.approx(3.0 * time)
    assert driving_range(on_soil, 3.0, math.radians(35.0)) == 0.0


def test_acceleration_by_quadrature_and_by_simulation(on_rock: Course) -> None:
    speed = 2.5
    time, distance = time_and_distance_to(on_rock, speed)
    grid = np.linspace(0.0, speed, 26)
    accelerations = [full_throttle_acceleration(on_rock, float(v)) for v in grid]
    solution = solve_ivp(
        lambda t, y: [y[1], np.interp(y[1], grid, accelerations)], (0.0, time), [0.0, 0.0], rtol=1e-8, max_step=0.05
    )
    assert solution.y[1, -1] == pytest.approx(speed, rel=3e-3)
    assert solution.y[0, -1] == pytest.approx(distance, rel=5e-3)


def test_equivalent_mass_is_that_of_the_kinetic_energy(lrv: VehicleParams) -> None:
    speed, slip = 2.0, 0.1
    wheel_rate = speed / 0.4065
    rotor = 80.0 * wheel_rate
    energy = 0.5 * lrv.mass * speed**2 + 4 * 0.5 * (lrv.axles[0].wheel_inertia * wheel_rate**2 + 1e-4 * rotor**2)
    assert equivalent_mass(lrv) == pytest.approx(2.0 * energy / speed**2)
    assert equivalent_mass(lrv, slip) > equivalent_mass(lrv)


def test_full_torque_accelerates_the_equivalent_mass(on_rock: Course) -> None:
    """m_e a = sum of the torques over the radius, less the rolling resistance, where slip is small."""
    speed = 3.0
    wheel = replace(on_rock.wheels[0], half_slip=1e-5)
    found = full_throttle_acceleration(replace(on_rock, wheels=[wheel, wheel]), speed)
    vehicle = on_rock.vehicle
    force = 4 * largest_wheel_torque(vehicle, speed / 0.4065) / 0.4065
    force -= vehicle.mass * on_rock.gravity * (0.02 + 1e-3 * speed**2)
    assert found == pytest.approx(force / equivalent_mass(vehicle), rel=1e-3)


def test_series_motor_does_not_brake(lrv: VehicleParams) -> None:
    point = motor_point(lrv, -5.0, 5.0)
    assert point.current == 0.0 and point.power == 0.0


def test_bad_numbers_are_refused(on_soil: Course) -> None:
    with pytest.raises(InvalidValueError, match="speed"):
        steady_state(on_soil, 0.0)
    with pytest.raises(InvalidValueError, match="grade"):
        steady_state(on_soil, 1.0, 2.0)
