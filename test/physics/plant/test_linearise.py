"""The linearised plant against the plant itself, against formulas of suspensions, and against those of handling."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from scipy.linalg import expm

from sojourn_analysis.modal.linear_modes import ground_response, modes, reduced, response
from sojourn_analysis.modal.linearise import LinearPlant, linearise
from sojourn_analysis.vehicle.body_motion import first_nulls
from sojourn_analysis.vehicle.handling import SingleTrack, poles, steady_gains
from sojourn_analysis.vehicle.quarter_car import QuarterCar, responses, state_matrices
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_machine.drives import JointDriveParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import SuspensionParams
from sojourn_machine.params import FloatArray
from sojourn_machine.supports import WheelParams
from sojourn_physics.contact.contact_law import StateColumn
from sojourn_physics.contact.hysteresis import ON_BACKBONE
from sojourn_physics.environment.gravity.field import UniformField
from sojourn_physics.plant.model import PlantModel, Site
from sojourn_physics.plant.state import PlantCommand, PlantState, zeros_command
from sojourn_physics.plant.step import initial_state, step
from sojourn_studies.wheeled_platform import STRUT_MASS, WHEEL_MASS, Chassis, wheeled_platform

EARTH = 9.81
PLACES = (0.8, -0.8)
CHASSIS = 200.0
SPRING, DAMPING = 8e3, 500.0
RADIUS, TRACK = 0.2, 1.2
SPEED = 3.0


def drive(load: str, mode: str, **servo: float) -> JointDriveParams:
    """A motor without loss, and all but without inertia."""
    return JointDriveParams.model_validate({
        "joints": ["pattern"], "load": load,
        "motor": {"resistance": 0.01, "torque_constant": 1.0, "rotor_inertia": 1e-9, "no_load_current": 0.0,
                  "max_current": 500.0},
        "gear": {"ratio": 50.0, "efficiency": 1.0, "friction_torque": 0.0, "viscous_friction": 0.0},
        "servo": {"mode": mode, "max_torque": 1e5, **servo},
    })  # fmt: skip


def wheel(**contact: Any) -> WheelParams:
    return WheelParams.model_validate(
        {"name": "pattern", "joint": "pattern", "radius": RADIUS, "width": 0.1, "contact": contact}
    )


def plant_of(scenario: LoadedScenario, platform: Any) -> tuple[PlantModel, PlantState, PlantCommand]:
    site = Site(scenario.height_field(), list(scenario.soils.values()), UniformField(EARTH))
    model = PlantModel(platform.urdf_xml, platform.machine, site, scenario.power, scenario.simulation)
    state = initial_state(model, 0.0, 0.0, 0.0, 0.8)
    command = zeros_command(len(model.joints.names), len(model.loads))
    return model, state, command


@pytest.fixture(scope="module")
def rock() -> LoadedScenario:
    return load_scenario("flat_drive", ["soil=rigid_rock", "soil.contact_damping=0", "terrain.size_x=60"])


@pytest.fixture(scope="module")
def sprung(rock: LoadedScenario) -> tuple[PlantModel, PlantState, PlantCommand]:
    """On struts and elastic wheels, rolling freely at SPEED; its inertia makes both ends independent: J = m a b."""
    pattern = wheel(
        model="brush", stiffness=5e4, damping=0.0, longitudinal_stiffness=1e4, cornering_stiffness=5e3,
        relaxation_length=0.05, friction=1.0, rolling_resistance=0.0,
    )  # fmt: skip
    platform = wheeled_platform(
        PLACES, pattern, [drive("drive", "rate", proportional=10.0)],
        struts=SuspensionParams(joints=("pattern",), stiffness=SPRING, damping=DAMPING), track=TRACK,
        chassis=Chassis(CHASSIS, (40.0, CHASSIS * PLACES[0] ** 2, 150.0), (0.0, 0.1)),
    )  # fmt: skip
    model, state, command = plant_of(rock, platform)
    command.load_fractions[[load.name for load in model.loads].index("drive")] = 0.0
    return model, *rolling(model, state, command, SPEED)


def rolling(
    model: PlantModel, state: PlantState, command: PlantCommand, speed: float
) -> tuple[PlantState, PlantCommand]:
    """The state at a speed, after it has come to rest in all else."""
    state = state.copy()
    state.velocity[0] = speed
    state.velocity[model.joints.columns[model.reference_rows([w.joint for w in model.machine.wheels])]] = speed / RADIUS
    for _ in range(100):
        state, _ = step(model, state, command)
    return state, command


@pytest.fixture(scope="module")
def linear(sprung: tuple[PlantModel, PlantState, PlantCommand]) -> LinearPlant:
    return linearise(*sprung)


def tyre_rate(sprung: tuple[PlantModel, PlantState, PlantCommand]) -> float:
    """dN/dh of one wheel by its own law: the linear wheel in series with the rock, whose load goes with z^1.5 [N/m]."""
    model, state, command = sprung
    contact = step(model, state, command)[1].contacts[0]
    load, sinkage = float(contact[8]), float(contact[3])
    return 1.0 / (1.0 / 5e4 + sinkage / (1.5 * load))


def quarter(sprung: tuple[PlantModel, PlantState, PlantCommand]) -> QuarterCar:
    return QuarterCar(CHASSIS / 4.0, SPRING, DAMPING, tyre_rate(sprung), WHEEL_MASS + STRUT_MASS)


def nearest(values: FloatArray, wanted: complex) -> complex:
    return complex(values[np.argmin(np.abs(values - wanted))])


def test_bounce_pitch_and_wheel_hop_are_those_of_quarter_cars(
    linear: LinearPlant, sprung: tuple[PlantModel, PlantState, PlantCommand]
) -> None:
    """With J = m a b bounce, pitch and both hops of the wheels are the two modes of the quarter car, twice each."""
    expected = np.linalg.eigvals(state_matrices(quarter(sprung))[0])
    body, hop = sorted(expected[expected.imag > 0.0], key=abs)
    found = {mode.name: mode.eigenvalue for mode in modes(linear)}
    for name, tolerance in (("z", 1e-3), ("pitch", 5e-3)):
        assert abs(found[name] - body) < tolerance * abs(body)
    # of the four, those in which left and right wheels go against one another are shifted by the tyres across
    hops = [mode.eigenvalue for mode in modes(linear)]
    assert sum(abs(value - hop) < 5e-3 * abs(hop) for value in hops) == 2


def test_ride_over_a_profile_by_quarter_cars_and_the_wheelbase(
    linear: LinearPlant, sprung: tuple[PlantModel, PlantState, PlantCommand]
) -> None:
    """Bounce is the quarter car's answer times (1 + e^(-s l/V))/2, with its null at V/2l; pitch is the other half."""
    wheelbase = PLACES[0] - PLACES[1]
    null, _ = first_nulls(wheelbase, SPEED)
    frequencies = np.array([0.3, null, 1.5, 2.0, 4.0, 8.0])
    late = np.exp(-2j * np.pi * frequencies * wheelbase / SPEED)
    car = responses(quarter(sprung), frequencies).acceleration
    bounce, pitch = ground_response(linear, "z", frequencies), ground_response(linear, "pitch", frequencies)
    scale = np.abs(car)
    assert np.all(np.abs(bounce - car * (1.0 + late) / 2.0) < 0.005 * scale)
    # the wheels on a slope also pull along the ground, below the centre of mass
    assert np.all(np.abs(pitch - car * (late - 1.0) / wheelbase) < 0.03 * scale / wheelbase)


def test_poles_and_gains_of_steering(rock: LoadedScenario) -> None:
    """Eigenvalues at a speed by the single-track model, and the steady yaw rate for a steering angle: understeer."""
    cornering, front, rear, speed = 800.0, 0.5, -0.7, 4.0
    pattern = wheel(
        model="brush", stiffness=5e6, damping=20.0, longitudinal_stiffness=1e3, cornering_stiffness=cornering,
        relaxation_length=2e-3, friction=1.5, rolling_resistance=0.0,
    )  # fmt: skip
    platform = wheeled_platform(
        [front, rear], pattern, [drive("drive", "rate", proportional=10.0)],
        drive("steer", "position", proportional=1e6, derivative=1e3), (0,), track=TRACK,
    )  # fmt: skip
    model, state, command = plant_of(rock, platform)
    command.load_fractions[[load.name for load in model.loads].index("drive")] = 0.0
    state, command = rolling(model, state, command, speed)
    steers = [each.steer_joint for each in platform.machine.wheels if each.steer_joint is not None]
    linear = linearise(model, state, command, steers)
    contact = step(model, state, command)[1].contacts[0]
    depth = float(contact[3] + contact[11])
    trail = math.sqrt(depth * (2.0 * RADIUS - depth)) / 3.0
    pin.ccrba(model.multibody, model.data, state.configuration, np.zeros(model.multibody.nv))
    inertia = float(np.array(model.data.Ig.inertia)[2, 2]) + 4.0 * 0.5 * WHEEL_MASS * (0.5 * TRACK) ** 2
    centre = float(pin.centerOfMass(model.multibody, model.data, state.configuration)[0] - state.configuration[0])
    x = (front - centre - trail, rear - centre - trail)
    car = SingleTrack(model.mass, inertia, x, (2.0 * cornering, 2.0 * cornering), (1.0, 0.0))
    for pole in poles(car, speed):
        assert abs(nearest(np.linalg.eigvals(linear.a), pole) - pole) < 0.02 * abs(pole)
    slow = np.array([0.01])
    both = {f"reference {joint}": 1.0 + 0.0j for joint in steers}
    rate = response(linear, "yaw", both, slow) / (2j * math.pi * slow)
    assert abs(rate[0]) == pytest.approx(steady_gains(car, speed).yaw_rate, rel=0.01)


@pytest.fixture(scope="module")
def explorer(machine: Callable[..., Any]) -> tuple[PlantModel, PlantState, PlantCommand]:
    """Parked on lunar soil."""
    parked = machine("flat_drive", "terrain.memory=false")
    return parked.model, parked.start, parked.hold()


def test_the_plant_swings_out_as_the_linear_one(explorer: tuple[PlantModel, PlantState, PlantCommand]) -> None:
    """Lifted by 0.1 mm, tilted and pushed a little, for a third of a second: A against a thousand steps' worth.

    On soil that is sheared for the first time in every direction: what turns in it loses energy, which is not linear.
    """
    model, start, command = explorer
    start = start.copy()
    start.supports.wheels[:, StateColumn.LARGEST_SHEAR] = ON_BACKBONE
    linear = linearise(model, start, command)
    count = linear.size
    change = np.zeros(len(linear.a))
    for name, amount in {"z": 1e-4, "pitch": 2e-4, "roll": 2e-4, "rocker_left_joint": 1e-4}.items():
        change[linear.index(name)] = amount
    change[count + linear.index("x")] = 1e-4
    # the bogies' friction has come to rest at its limit, where it holds one way and slides the other: not linear
    rows = [linear.index(name) for name in ("x", "y", "z", "roll", "pitch", "yaw")]
    state = moved(model, start, linear, change)
    period = model.simulation.control_period
    transition, expected = expm(linear.a * period), change
    seen, told = [], []
    for _ in range(16):
        state, _ = step(model, state, command)
        expected = transition @ expected
        seen.append(difference(model, start, state)[: len(linear.coordinates)][rows])
        told.append(expected[:count][rows])
    largest = np.abs(np.array(told)).max(axis=0)
    assert largest.min() > 2e-5
    assert np.all(np.abs(np.array(seen) - np.array(told)).max(axis=0) < 0.03 * largest)


def test_reduced_to_its_mechanics_it_swings_as_the_whole(
    explorer: tuple[PlantModel, PlantState, PlantCommand],
) -> None:
    """Parked, the memory of contacts and friction is an elastic one: nothing of base and suspension is lost."""
    linear = linearise(*explorer)
    a, b = reduced(linear)
    assert a.shape == (2 * linear.size, 2 * linear.size) and b.shape == (2 * linear.size, len(linear.inputs))
    whole, part = ({mode.name: mode.eigenvalue for mode in modes(linear, given)} for given in (None, a))
    for name in ("x", "y", "z", "roll", "pitch", "yaw", "rocker_left_joint"):
        assert part[name] == pytest.approx(whole[name], rel=2e-3)


def test_step_sizes_hardly_matter(explorer: tuple[PlantModel, PlantState, PlantCommand]) -> None:
    """What the header says of both steps."""
    names = ("x", "y", "z", "roll", "pitch", "yaw", "rocker_left_joint")

    def found(**steps: float) -> FloatArray:
        values = {mode.name: mode.frequency for mode in modes(linearise(*explorer, **steps))}
        return np.array([values[name] for name in names])

    usual = found()
    assert found(difference=1e-7) == pytest.approx(usual, rel=3e-4)
    assert found(difference=1e-5) == pytest.approx(usual, rel=1e-3)
    for time_step in (3e-6, 3e-5):
        assert found(time_step=time_step) == pytest.approx(usual, rel=3e-4)


def test_what_is_no_equilibrium_is_refused(
    explorer: tuple[PlantModel, PlantState, PlantCommand], machine: Callable[..., Any]
) -> None:
    model, start, command = explorer
    thrown = replace(start.copy(), velocity=start.velocity + 0.3)
    with pytest.raises(InvalidValueError, match="accelerations up to"):
        linearise(model, thrown, command)
    slope = machine("parked_slope")
    with pytest.raises(InvalidValueError, match="flat ground"):
        linearise(slope.model, slope.start, slope.hold())
    with pytest.raises(InvalidValueError, match="elbow"):
        linearise(model, start, command, ["elbow"])


def moved(model: PlantModel, state: PlantState, linear: LinearPlant, change: FloatArray) -> PlantState:
    """A state whose coordinates and rates are changed as the linear plant has them."""
    motion, rates = np.zeros(model.multibody.nv), np.zeros(model.multibody.nv)
    for index, name in enumerate(linear.coordinates):
        columns = {index: 1.0} if index < 6 else {int(model.joints.columns[model.joint_index[name]]): 1.0}
        for coupling in model.machine.couplings:
            if coupling.first == name:
                columns[int(model.joints.columns[model.joint_index[coupling.second]])] = -1.0 / coupling.ratio
        for column, share in columns.items():
            motion[column] += share * change[index]
            rates[column] += share * change[linear.size + index]
    state = state.copy()
    state.joints[0] += motion[model.joints.columns]
    return replace(
        state,
        configuration=pin.integrate(model.multibody, state.configuration, motion),
        velocity=state.velocity + rates,
    )


def difference(model: PlantModel, before: PlantState, after: PlantState) -> FloatArray:
    """Of the coordinates; coupled joints that are left out come last in the explorer's order of use here."""
    motion = pin.difference(model.multibody, before.configuration, after.configuration)
    dropped = {int(model.joints.columns[model.joint_index[c.second]]) for c in model.machine.couplings}
    return np.array([value for column, value in enumerate(motion) if column not in dropped])
