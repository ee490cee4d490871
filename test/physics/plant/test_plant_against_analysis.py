"""The simulated explorer against the closed analysis of `sojourn_analysis.vehicle`, which shares no code above the
wheel.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.vehicle.from_machine import BusSupply, vehicle_of
from sojourn_analysis.vehicle.longitudinal import steady_state
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_config.bundle import Bundle, read_machine
from sojourn_physics.plant.step import step


@pytest.fixture(scope="module")
def fresh(machine: Callable[..., Any]) -> Any:
    """On ground that does not remember wheels: like the analysis, which knows no ruts."""
    return machine("flat_drive", "terrain.memory=false")


@pytest.fixture(scope="module")
def bundle() -> Bundle:
    return read_machine("explorer", "moon", "lunar_nominal")


@pytest.fixture(scope="module")
def explorer(bundle: Bundle, fresh: Any) -> Subject:
    """The explorer as the analysis sees it, joints where the plant has them."""
    machine = StandingMachine(bundle.urdf_xml, bundle.machine, bundle.gravity)
    index = fresh.model.joint_index
    angles = {name: float(fresh.start.joints[0, index[name]]) for name in bundle.arm.joint_names}
    vehicle = vehicle_of("explorer", machine, BusSupply(29.0, 473.0, 80.0), 0.05, angles)
    return Subject(vehicle, bundle.soil, bundle.body, machine, angles)


def test_wheel_loads_at_rest(explorer: Subject, fresh: Any) -> None:
    """By virtual work without friction, and as the soil carries the settled machine with the friction of its pivots."""
    loads = step(fresh.model, fresh.start, fresh.hold())[1].contacts[fresh.wheels, 8]
    assert explorer.machine is not None
    found = explorer.machine.loads(explorer.machine.stand(lambda x, y: 0.0, angles=explorer.angles)).normal
    assert loads == pytest.approx(found, rel=0.06)
    assert loads.sum() == pytest.approx(found.sum(), rel=1e-4)


def test_power_and_slip_of_a_steady_drive(explorer: Subject, fresh: Any) -> None:
    """Every wheel as on the test bed, one slip for all; power through gear and motor."""
    rate, log = 0.5, []
    fresh.run(14.0, fresh.hold(rate), watch=lambda state, output: log.append((state, output)))
    first, last = log[len(log) // 2][0], log[-1][0]
    seconds = (len(log) - 1 - len(log) // 2) * fresh.model.simulation.control_period
    speed = (last.configuration[0] - first.configuration[0]) / seconds
    power = (last.energy.electrical - first.energy.electrical) / seconds
    state = steady_state(explorer.course(), float(speed))
    assert state is not None and state.feasible
    # the plant counts the friction inside of the motor at the gear's output, where the gear's loss makes it larger
    vehicle = explorer.vehicle
    friction = vehicle.motor.no_load_current * vehicle.motor.torque_constant * vehicle.gear.ratio
    larger = 6.0 * friction * (1.0 / vehicle.gear.efficiency - 1.0) * rate
    assert power == pytest.approx(state.drive_power + larger, rel=0.01)
    assert 1.0 - speed / (rate * 0.125) == pytest.approx(state.slip, abs=0.01)
    front = log[-1][1].contacts[:2, 3]
    # the loads differ by up to 6 % for the friction of the pivots, and the sinkage goes with their power of 2/3
    assert front == pytest.approx(np.full(2, state.wheels[0].sinkage), rel=0.04)


def test_wheels_in_the_ruts_of_those_before_them(explorer: Subject, machine: Callable[..., Any]) -> None:
    """On ground that remembers: pull, torque and sinkage of each axle, one slip for all.

    The loads differ by up to 6 % for the friction of the pivots, and with them what the wheels do.
    """
    with_memory = machine("flat_drive")
    rate, log = 0.5, []
    with_memory.run(32.0, with_memory.hold(rate), watch=lambda state, output: log.append((state, output)))
    # the start stands on virgin soil: the rear wheels reach the ruts of the front ones after 24 s
    contacts = np.mean([output.contacts[:6] for _, output in log[-300:]], axis=0)
    first, last = log[-300][0], log[-1][0]
    seconds = 299 * with_memory.model.simulation.control_period
    speed = float(last.configuration[0] - first.configuration[0]) / seconds
    course = explorer.course_in_ruts()
    state = steady_state(course, speed)
    assert state is not None
    assert state.slip == pytest.approx(1.0 - speed / (rate * 0.125), abs=0.005)
    assert state.slip < 0.6 * steady_state(explorer.course(), speed).slip
    for axle, force in enumerate(state.wheels):
        seen = contacts[2 * axle : 2 * axle + 2]
        assert force.sinkage == pytest.approx(seen[:, 3].mean(), rel=0.06)
        assert force.pull == pytest.approx(seen[:, 6].mean(), abs=0.15)
        assert force.torque == pytest.approx(seen[:, 9].mean(), rel=0.06)
