"""A machine in the gravity of its place: what it weighs, how it flies, and that a flight for good is told."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

from sojourn_config.scenario import load_scenario
from sojourn_contract.app import Period
from sojourn_physics.environment.gravity.field import BodyField
from sojourn_plant.app import PlantApp

Machines = Callable[..., Any]
ITOKAWA = ("body=itokawa", "site={latitude_deg: 20, longitude_deg: 70}", "soil=rigid_rock")


def thrown_up(one: Any, velocity: list[float]) -> Any:
    state = one.thrown("z", 0.0, 5.0)
    moving = state.velocity.copy()
    moving[:3] = pin.Quaternion(state.configuration[3:7]).inverse() * np.array(velocity)
    return replace(state, velocity=moving)


@pytest.mark.parametrize("latitude", [0.0, 60.0])
def test_at_rest_the_ground_carries_the_weight_of_the_place(machine: Machines, latitude: float) -> None:
    one = machine("flat_drive", "body=earth", f"site={{latitude_deg: {latitude}}}", "soil=rigid_rock")
    seen: list[Any] = []
    one.run(0.02, watch=lambda _, output: seen.append(output.contacts[:, 6:9].sum(axis=0)))
    weight = one.model.mass * one.model.field.acceleration(one.start.configuration[:3])
    np.testing.assert_allclose(seen[0], -weight, atol=2e-3 * one.weight)
    assert one.weight == pytest.approx(one.model.mass * (9.7803 if latitude == 0.0 else 9.8192), rel=1e-4)


def test_a_flight_over_itokawa_is_the_orbit_there(machine: Machines) -> None:
    """Against the motion in a frame that does not turn, found by another integrator."""
    one = machine("flat_drive", *ITOKAWA)
    field = one.model.field
    assert isinstance(field, BodyField)
    start = thrown_up(one, [0.03, -0.02, 0.04])
    end = one.run(60.0, state=start)
    frame, spin = field.frame, np.array((0.0, 0.0, field.spin))
    centre = pin.centerOfMass(one.model.multibody, one.model.data, start.configuration)
    velocity = frame.rotation @ np.array([0.03, -0.02, 0.04]) + np.cross(spin, frame.in_body(centre))

    def fall(time: float, both: Any) -> Any:
        turned = pin.utils.rotate("z", field.spin * time)
        return np.concatenate((both[3:], turned @ field.attraction.acceleration(turned.T @ both[:3])))

    found = solve_ivp(fall, (0.0, 60.0), np.concatenate((frame.in_body(centre), velocity)), rtol=1e-10, atol=1e-10)
    expected = pin.utils.rotate("z", field.spin * 60.0).T @ found.y[:3, -1]
    there = pin.centerOfMass(one.model.multibody, one.model.data, end.configuration)
    np.testing.assert_allclose(frame.in_body(there), expected, atol=2e-3)  # after 3 m of flight
    assert np.linalg.norm(there - centre) > 2.0
    coriolis = 2.0 * np.linalg.norm(np.cross(spin, velocity)) * 60.0**2 / 2.0
    assert coriolis > 1e-2  # without it the flight would end elsewhere


def test_energy_is_kept_in_a_field_that_changes(machine: Machines) -> None:
    one = machine("flat_drive", *ITOKAWA)
    start = thrown_up(one, [0.0, 0.0, 0.5])
    first = one.run(0.02, state=start)
    end = one.run(30.0, state=first)
    kinetic = 0.5 * one.model.mass * 0.25
    assert end.energy.mechanical - first.energy.mechanical == pytest.approx(0.0, abs=1e-4 * kinetic)
    risen = one.model.mass * (
        one.model.field.potential(end.configuration[:3]) - one.model.field.potential(start.configuration[:3])
    )
    assert risen > 1e-3 * kinetic  # and it has gone up


def test_faster_than_escape_is_told_and_slower_comes_back(machine: Machines) -> None:
    one = machine("flat_drive", *ITOKAWA)
    speed = one.model.field.escape_speed(one.start.configuration[:3])
    assert 0.1 < speed < 0.2
    slow, fast = (one.run(0.1, state=thrown_up(one, [0.0, 0.0, part * speed])) for part in (0.8, 1.1))
    assert not slow.flight.escaped
    assert fast.flight.escaped
    assert one.run(1.0).flight == one.start.flight == type(one.start.flight)()


def test_a_long_flight_is_told_and_ends_on_the_ground(machine: Machines) -> None:
    one = machine("flat_drive", "body=ceres", "site={latitude_deg: 0}", "soil=rigid_rock")
    state = thrown_up(one, [0.0, 0.0, 0.0])
    state = replace(state, velocity=np.concatenate(([0.0, 0.0, 1.4], state.velocity[3:])))
    up = one.run(9.9, state=state)
    assert up.flight.periods == 495 and not up.flight.long
    later = one.run(0.2, state=up)
    assert later.flight.long and not later.flight.escaped
    down = one.run(10.0, state=later)
    assert down.flight.periods < 250  # it has been back on the ground
    assert down.flight.long


def test_the_run_says_that_the_rover_has_left(machine: Machines) -> None:
    app = PlantApp(load_scenario("flat_drive", ITOKAWA))
    state = app.initial_state()
    up = thrown_up(machine("flat_drive", *ITOKAWA), [0.0, 0.0, 0.3])
    after, answer = app.step(replace(state, machine=up), Period(0, {}))
    list(answer.messages)
    assert list(answer.errors) == ["the rover has left the ground faster than gravity can bring it back"]
    assert not app.step(after, Period(20_000_000, {}))[1].errors  # told once
    assert "off the ground for" not in app.heartbeat_values(after, 0)
    long = replace(after, machine=replace(after.machine, flight=after.machine.flight._replace(periods=600)))
    assert app.heartbeat_values(long, 0)["off the ground for"] == "12 s"


def test_a_machine_on_its_foundation_does_not_fly(machine: Machines) -> None:
    one = machine("puma560_course")
    hold = one.hold()
    assert one.run(0.1, hold).flight == type(one.start.flight)()
