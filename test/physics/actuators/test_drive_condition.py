"""Heat and brakes of drives over control periods: against integration, the energy account and by hand."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from sojourn_config.bundle import read_machine
from sojourn_machine.drives import BrakeParams, JointDriveParams, MotorThermalParams
from sojourn_physics.actuators import joint_drive as jd
from sojourn_physics.actuators.drive_condition import CLOSED, HOUSING, WINDING, conditions_of
from sojourn_physics.actuators.motor_thermal import demagnetisation_current
from sojourn_physics.plant.model import PlantModel, Site
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import initial_state, step
from sojourn_physics.terrain.height_field import HeightField

HEAT = MotorThermalParams(
    winding_capacity=8.0, housing_capacity=120.0, winding_to_housing=3.1, housing_to_ambient=14.0, surroundings=250.0,
    derate_temperature=390.0, largest_temperature=428.0,
    demagnetisation_cold=(253.0, 12.0), demagnetisation_hot=(373.0, 6.0),
)  # fmt: skip
BRAKE = BrakeParams(holding_torque=1.5, closing_time=0.05, opening_time=0.1)
PERIOD = 0.02
REACHING = {"arm_shoulder_joint": -0.3, "arm_elbow_joint": 0.2}


def drive(**more: object) -> JointDriveParams:
    return JointDriveParams.model_validate({
        "joints": ["a"], "load": "arm",
        "motor": {
            "resistance": 2.0, "torque_constant": 0.2, "rotor_inertia": 1e-4, "no_load_current": 0.0, "max_current": 7.0
        },
        "gear": {"ratio": 100.0, "efficiency": 0.9, "friction_torque": 3.0, "viscous_friction": 1.0},
        "servo": {"mode": "rate", "proportional": 1.0, "max_torque": 100.0},
        **more,
    })  # fmt: skip


def table() -> np.ndarray:
    rows = np.zeros((2, jd.JOINT_COLUMNS))
    rows[1, [jd.RESISTANCE, jd.TORQUE_CONSTANT, jd.MAX_CURRENT, jd.RATIO, jd.FRICTION]] = 2.0, 0.2, 7.0, 100.0, 3.0
    return rows


def test_a_machine_that_names_neither_has_none() -> None:
    assert conditions_of([None, drive()], table()) is None


def test_a_held_current_heats_the_motor_as_integration_says() -> None:
    """The winding's resistance grows as it warms, so the heat does."""
    conditions = conditions_of([None, drive(thermal=HEAT)], table())
    assert conditions is not None
    state, current = conditions.first(), 2.5
    assert state[WINDING, 0] == state[HOUSING, 0] == 250.0

    def flow(t: float, x: np.ndarray) -> list[float]:
        loss = 2.0 * (1.0 + 0.0039 * (x[0] - 298.15)) * current**2
        through = (x[0] - x[1]) / 3.1
        return [(loss - through) / 8.0, (through - (x[1] - 250.0) / 14.0) / 120.0]

    path = solve_ivp(flow, (0.0, 60.0), [250.0, 250.0], rtol=1e-9, atol=1e-9)
    squares = np.array([0.0, current**2])
    for _ in range(3000):
        state = conditions.after(state, conditions.now(state), squares, np.ones(2), PERIOD)
    assert state[:CLOSED, 0] == pytest.approx(path.y[:, -1], abs=0.02)


@settings(max_examples=30, deadline=None)
@given(here=st.floats(100.0, 330.0), current=st.floats(0.0, 5.0))
def test_what_is_round_a_motor_stands_for_what_its_parameters_say(here: float, current: float) -> None:
    """A motor in a cold place is one whose parameters name that place; one without a place of its own goes by them."""
    told = conditions_of([None, drive(thermal=HEAT)], table())
    named = conditions_of([None, drive(thermal=HEAT.model_copy(update={"surroundings": here}))], table())
    assert told is not None and named is not None
    state, other, plain = told.first([here]), named.first(), told.first()
    squares = np.array([0.0, current**2])
    for _ in range(200):
        state = told.after(state, told.now(state), squares, np.ones(2), 1.0, [here])
        other = named.after(other, named.now(other), squares, np.ones(2), 1.0)
    assert state == pytest.approx(other, rel=1e-9)
    assert (told.first([None]) == plain).all()


def test_a_hot_motor_is_weaker_and_is_held_back() -> None:
    conditions = conditions_of([None, drive(thermal=HEAT)], table())
    assert conditions is not None
    state = conditions.first()
    state[:CLOSED, 0] = 409.0, 338.15  # in the middle of derating; magnets 40 K over 25 degrees
    warm = conditions.now(state)[1]
    assert warm[jd.TORQUE_CONSTANT] == pytest.approx(0.2 * (1.0 - 0.0011 * 40.0))
    assert warm[jd.RESISTANCE] == pytest.approx(2.0 * (1.0 + 0.0039 * (409.0 - 298.15)))
    assert warm[jd.MAX_CURRENT] == pytest.approx(3.5)
    state[:CLOSED, 0] = 300.0, 385.0  # a cool winding beside magnets that would lose their field
    assert conditions.now(state)[1, jd.MAX_CURRENT] == pytest.approx(demagnetisation_current(HEAT, 385.0))
    assert demagnetisation_current(HEAT, 385.0) < 7.0
    assert conditions.now(state)[0] == pytest.approx(table()[0])


def test_a_brake_closes_without_current_and_opens_with_it() -> None:
    conditions = conditions_of([None, drive(brake=BRAKE)], table())
    assert conditions is not None
    state, closed = conditions.first(), []
    for on in (0.0,) * 4 + (0.5,) * 6:
        now = conditions.now(state)
        closed.append(float(state[CLOSED, 0]))
        assert now[1, jd.FRICTION] == pytest.approx(3.0 + closed[-1] * 150.0)
        state = conditions.after(state, now, np.zeros(2), np.array([1.0, on]), PERIOD)
    assert closed == pytest.approx([0.0, 0.4, 0.8, 1.0, 1.0, 0.8, 0.6, 0.4, 0.2, 0.0], abs=1e-12)
    at_once = conditions_of([None, drive(brake=BrakeParams(holding_torque=1.0, closing_time=0.0))], table())
    assert at_once is not None
    assert at_once.after(at_once.first(), table(), np.zeros(2), np.zeros(2), PERIOD)[CLOSED, 0] == 1.0


def stand(**change: object) -> PlantModel:
    """A PUMA 560 on its stand, all of its drives changed."""
    bundle = read_machine("puma560", "earth", "lunar_nominal")
    drives = tuple(one.model_copy(update=change) for one in bundle.machine.drives)
    ground = HeightField(np.zeros((41, 41)), np.zeros((41, 41), np.uint8), 0.1, -2.0, -2.0, (bundle.soil.name,))
    rover = bundle.machine.model_copy(update={"drives": drives})
    site = Site(ground, list(bundle.soils.values()), bundle.gravity_field)
    return PlantModel(bundle.urdf_xml, rover, site, bundle.power)


def test_brakes_hold_an_arm_without_power_that_would_fall() -> None:
    fallen = {}
    for name, change in (("braked", {"brake": BrakeParams(holding_torque=1.5)}), ("free", {})):
        model = stand(**change)
        start = initial_state(model, 0.0, 0.0, 0.0, 0.8, REACHING)
        command = zeros_command(len(model.joints.names), len(model.loads))
        command.reference[0] = start.motor_angles
        off = replace(command, load_fractions=np.zeros(len(model.loads)))
        state = start
        for _ in range(25):
            state, _ = step(model, state, off)
        fallen[name] = float(np.abs(state.joints[jd.ANGLE] - start.joints[jd.ANGLE]).max())
        assert state.energy.balance_error(start.energy) < 1e-3
        if name == "braked":
            before = state.joints[jd.ANGLE].copy()
            for _ in range(50):
                state, _ = step(model, state, off)
            assert state.joints[jd.ANGLE] == pytest.approx(before, abs=1e-7)  # at rest
            for _ in range(25):
                state, _ = step(model, state, command)
            assert state.conditions is not None and state.conditions[CLOSED].max() == 0.0
    assert fallen["braked"] < 0.01 < 0.2 < fallen["free"]


def test_the_heat_of_the_windings_is_in_the_motors() -> None:
    """Temperatures times capacities, and what has gone to the surroundings, are the account's winding heat."""
    model = stand(thermal=HEAT.model_copy(update={"surroundings": 298.15}))
    state = initial_state(model, 0.0, 0.0, 0.0, 0.8, REACHING)
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    lost, begun = 0.0, state.energy.winding_heat
    for _ in range(100):
        before = state
        state, _ = step(model, state, command)
        assert before.conditions is not None and state.conditions is not None
        middle = 0.5 * (before.conditions[HOUSING] + state.conditions[HOUSING])
        lost += PERIOD * float(np.sum(middle - 298.15)) / 14.0
    assert state.conditions is not None
    rise = state.conditions[:CLOSED].sum(axis=1) - 298.15 * state.conditions.shape[1]
    stored = 8.0 * rise[WINDING] + 120.0 * rise[HOUSING]
    assert stored + lost == pytest.approx(state.energy.winding_heat - begun, rel=1e-3)
    assert state.conditions[WINDING].max() > 299.0


def test_arms_of_ours_name_them() -> None:
    """The SRMS has brushless motors with brakes that heat up, the gantry a screw; a series motor has no magnets."""
    bundle = read_machine("srms", "low_earth_orbit", "rigid_rock")
    assert all(one.brake and one.thermal and one.motor.kind == "brushless" for one in bundle.machine.drives)
    gantry = read_machine("cartesian", "earth", "lunar_nominal").machine.drives[2]
    assert gantry.transmission.ratio == pytest.approx(628.3185307)
    assert gantry.transmission.efficiency == pytest.approx(0.9, rel=1e-3)
    lrv = read_machine("lrv", "moon", "lunar_nominal").machine.drives[0]
    with pytest.raises(ValueError, match="magnets"):
        JointDriveParams.model_validate(lrv.model_dump() | {"thermal": HEAT.model_dump()})
