"""Each fault of the plant acts as it should, by what is known of the machine, however it is made."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.fault_names import FAULTS
from sojourn_machine.power.surroundings import PowerSurroundings
from sojourn_physics.actuators.joint_drive import MOTOR_RATE
from sojourn_physics.faults.acting import Acting, FaultyPlant, TimedFaults
from sojourn_physics.faults.plant_fault import PlantFault
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand, PlantState
from sojourn_physics.plant.step import step

STEERING, WHEEL = "steer_front_left_joint", "wheel_front_left_joint"
SHOULDER = "arm_elevation_joint"
PERIOD = 0.02


def fault(kind: str, **words: Any) -> PlantFault:
    """Any kind by its name, as a message says it."""
    made = FAULTS.get(kind).model_validate({"kind": kind, "at": 0.0, **words})
    assert isinstance(made, PlantFault)
    return made


def driven(machine: Any, faults: Sequence[PlantFault], command: PlantCommand, seconds: float) -> list:
    """State and output of each period, with the faults at their times."""
    plant, acting, state, history = FaultyPlant(machine.model), (), machine.start, []
    schedule = TimedFaults(plant, faults)
    for tick in range(round(seconds / PERIOD)):
        acting = schedule.at(acting, state, PERIOD * (tick + 1))
        model, told = plant.on(acting, command)
        state, output = step(model, state, told)
        history.append((state, output))
    return history


@pytest.mark.parametrize(("angle_deg", "held"), [(None, 0.0), (20.0, math.radians(20.0))])
def test_a_servo_that_is_locked_stays_where_it_is_whatever_is_commanded(
    flat: Any, angle_deg: float | None, held: float
) -> None:
    command = flat.hold()
    steering, other = flat.model.reference_rows([STEERING, "steer_front_right_joint"])
    command.reference[0, [steering, other]] = -0.4
    state, _ = driven(flat, [fault("servo_locked", joint=STEERING, angle_deg=angle_deg)], command, 3.0)[-1]
    assert state.joints[0, steering] == pytest.approx(held, abs=2e-3)
    assert state.joints[0, other] == pytest.approx(-0.4, abs=5e-3)


def test_a_dead_motor_takes_no_current_and_is_turned_by_the_ground(flat: Any) -> None:
    (wheel,) = flat.model.reference_rows([WHEEL])
    history = driven(flat, [fault("motor_dead", joint=WHEEL, at=1.0)], flat.hold(0.5), 3.0)
    before, after = history[40], history[-1]
    assert before[1].currents[wheel] > 0.1
    assert after[1].currents[wheel] == 0.0
    assert after[1].efforts[wheel] < -2.0  # the gear's friction
    assert 0.0 < after[0].velocity[flat.model.joints.columns[wheel]] < 0.45
    # what the other motors put in still goes somewhere
    assert after[0].energy.balance_error(history[60][0].energy) < 0.01


def test_a_motor_that_is_well_again_drives_again(flat: Any) -> None:
    (wheel,) = flat.model.reference_rows([WHEEL])
    history = driven(flat, [fault("motor_dead", joint=WHEEL, at=0.5, until=1.5)], flat.hold(0.5), 3.0)
    assert history[60][1].currents[wheel] == 0.0
    assert history[-1][0].velocity[flat.model.joints.columns[wheel]] == pytest.approx(0.5, abs=0.02)


def test_a_weak_motor_draws_no_more_than_its_part(flat: Any) -> None:
    (wheel,) = flat.model.reference_rows([WHEEL])
    drive = next(drive for drive in flat.model.machine.drives if WHEEL in drive.joints)
    most = 0.02 * drive.motor.max_current
    history = driven(flat, [fault("motor_weak", joint=WHEEL, part=0.02)], flat.hold(0.5), 2.0)
    currents = np.array([abs(output.currents[wheel]) for _, output in history])
    assert currents.max() == pytest.approx(most, rel=1e-6)


def test_a_seized_wheel_stands_while_its_motor_works_against_it(flat: Any) -> None:
    (wheel,) = flat.model.reference_rows([WHEEL])
    history = driven(flat, [fault("joint_seized", joint=WHEEL, at=1.0)], flat.hold(0.5), 3.0)
    column = flat.model.joints.columns[wheel]
    assert history[40][0].velocity[column] == pytest.approx(0.5, abs=0.02)
    turned = history[-1][0].joints[0, wheel] - history[60][0].joints[0, wheel]
    assert abs(turned) < 1e-3
    others = [wheel.joint for wheel in flat.model.machine.wheels if wheel.joint != WHEEL]
    working = np.abs(history[-1][1].currents)
    assert working[wheel] > 1.5 * working[flat.model.reference_rows(others)].max()
    assert history[-1][0].energy.balance_error(history[60][0].energy) < 0.01


def test_a_broken_gear_leaves_the_joint_to_the_ground_and_lets_the_motor_turn(flat: Any) -> None:
    (wheel,) = flat.model.reference_rows([WHEEL])
    history = driven(flat, [fault("gear_broken", joint=WHEEL, at=1.0, friction=0.0)], flat.hold(0.5), 4.0)
    state, output = history[-1]
    assert state.joints[MOTOR_RATE, wheel] == pytest.approx(0.5, abs=0.01)
    assert output.efforts[wheel] == pytest.approx(0.0, abs=1e-9)  # not even the gear's friction
    # rolling freely, it goes as fast as the ground does, which is less than the rate of wheels that drive and slip
    rate = state.velocity[flat.model.joints.columns[wheel]]
    driving = state.velocity[flat.model.joints.columns[flat.model.reference_rows(["wheel_rear_left_joint"])[0]]]
    assert 0.5 * driving < rate < driving


def test_a_free_joint_gives_way_to_the_weight_on_it(flat: Any) -> None:
    """The elevation of the stowed arm carries its weight; without drive it sinks, and its potential energy goes."""
    joint = int(flat.model.reference_rows([SHOULDER])[0])
    held = driven(flat, [], flat.hold(), 1.0)[-1][0]
    freed = driven(flat, [fault("joint_free", joint=SHOULDER, friction=0.0)], flat.hold(), 1.0)
    assert held.joints[0, joint] == pytest.approx(flat.start.joints[0, joint], abs=5e-3)
    assert abs(freed[-1][0].joints[0, joint] - flat.start.joints[0, joint]) > 0.02
    assert freed[-1][0].energy.mechanical < flat.start.energy.mechanical
    assert freed[-1][1].currents[joint] == 0.0


def test_a_stuck_brake_holds_an_arm_that_is_told_to_move(machine: Callable) -> None:
    arm = machine("srms_course")
    joint = next(drive for drive in arm.model.machine.drives if getattr(drive, "brake", None)).joints[0]
    (place,) = arm.model.reference_rows([joint])
    command = arm.hold()
    command.reference[0, place] += 0.02
    moved = driven(arm, [], command, 4.0)[-1][0].joints[0, place] - arm.start.joints[0, place]
    stuck = driven(arm, [fault("brake_stuck", joint=joint)], command, 4.0)[-1][0].joints[0, place]
    assert moved > 0.01
    assert abs(stuck - arm.start.joints[0, place]) < 0.2 * moved  # the play and the give of the gear behind it
    off = replace(command, load_fractions=np.zeros_like(command.load_fractions))
    opened = driven(arm, [fault("brake_stuck", joint=joint, where="open")], off, 1.0)[-1][0].conditions
    closed = driven(arm, [], off, 1.0)[-1][0].conditions
    column = arm.model.conditions.rows.tolist().index(place)
    assert opened[2, column] == 0.0 < closed[2, column]


def test_a_lost_string_leaves_half_of_the_charge_and_twice_the_resistance(flat: Any) -> None:
    sound = flat.model.power.stores[0]
    lost = FaultyPlant(flat.model)
    acting = lost.with_fault((), fault("string_lost"), "a", flat.start)
    left = lost.model(acting).power.stores[0]
    state = flat.start.power.stores[0]
    assert left.charge_capacity == pytest.approx(sound.charge_capacity / 2.0)
    assert left.point(state).resistance == pytest.approx(2.0 * sound.point(state).resistance)
    drained = [driven(flat, faults, flat.hold(), 2.0)[-1][0].power for faults in ([], [fault("string_lost")])]
    spent = [flat.start.power.stores[0].soc - power.stores[0].soc for power in drained]
    assert spent[1] == pytest.approx(2.0 * spent[0], rel=0.02)


def test_a_shorted_cell_takes_its_share_of_the_voltage(flat: Any) -> None:
    cells = flat.model.power.params.battery.cells_series
    sound = driven(flat, [], flat.hold(), 0.1)[-1][1].power.voltage
    less = driven(flat, [fault("cell_shorted")], flat.hold(), 0.1)[-1][1].power.voltage
    assert less / sound == pytest.approx((cells - 1) / cells, rel=0.01)


def test_a_short_draws_what_its_resistance_takes(flat: Any) -> None:
    sound = driven(flat, [], flat.hold(), 0.5)[-1][1].power
    shorted = driven(flat, [fault("bus_short", resistance=10.0)], flat.hold(), 0.5)[-1]
    power = shorted[1].power
    assert power.store_currents[0] - power.load_current.sum() == pytest.approx(power.voltage / 10.0, rel=1e-9)
    assert power.load_power.shape == sound.load_power.shape
    assert power.voltage < sound.voltage
    account, before = shorted[0].power.energy, flat.start.power.energy
    given = account.stores - before.stores + account.sources - before.sources
    assert given == pytest.approx(account.loads - before.loads + account.shunts - before.shunts, rel=1e-9)


@pytest.mark.parametrize(("words", "drawn"), [({"where": "on"}, True), ({"where": "off"}, False)])
def test_a_stuck_switch_is_as_it_is_whatever_is_commanded(flat: Any, words: dict[str, str], drawn: bool) -> None:
    load = [one.name for one in flat.model.loads].index("cameras")
    command = flat.hold()
    command.load_fractions[load] = 0.0 if drawn else 1.0
    power = driven(flat, [fault("switch_stuck", load="cameras", **words)], command, 0.1)[-1][1].power
    assert (power.load_power[load] > 0.0) == drawn


def test_a_dead_load_draws_nothing(flat: Any) -> None:
    load = [one.name for one in flat.model.loads].index("survival_heater")
    assert driven(flat, [], flat.hold(), 0.1)[-1][1].power.load_power[load] > 0.0
    dead = driven(flat, [fault("load_dead", load="survival_heater")], flat.hold(), 0.1)
    assert dead[-1][1].power.load_power[load] == 0.0


def test_a_wheel_sinks_deeper_where_the_ground_is_softer(flat: Any) -> None:
    """Bekker's plate: with a third of the stiffness the load is borne deeper, and all wheels still carry the weight."""
    x, y = flat.start.configuration[:2]
    soft = driven(flat, [fault("soft_patch", x=x, y=y, radius=3.0, part=0.3)], flat.hold(), 4.0)[-1]
    assert soft[0].configuration[2] < flat.start.configuration[2] - 1e-3
    assert soft[1].contacts[flat.wheels, ReportColumn.FORCE_Z].sum() == pytest.approx(flat.weight, rel=0.02)


def test_patches_that_lie_upon_each_other_are_softer_together(flat: Any) -> None:
    """Of the same middle the second ended the plant: the ground had a name twice."""
    x, y = (round(float(place), 2) for place in flat.start.configuration[:2])
    plant, acting = FaultyPlant(flat.model), Acting()
    for name, radius, part in (("narrow", 1.0, 0.1), ("wide", 3.0, 0.5)):
        patch = fault("soft_patch", x=x, y=y, radius=radius, part=part)
        acting = plant.with_fault(acting, patch, name, flat.start)

    def stiffness(model: PlantModel, ahead: float) -> float:
        site = model.given.site
        return {soil.name: soil.k_phi for soil in site.soils}[site.terrain.soil_name(x + ahead, y)]

    parts = [stiffness(plant.model(acting), ahead) / stiffness(flat.model, ahead) for ahead in (0.0, 2.0, 5.0)]
    assert parts == pytest.approx([0.05, 0.5, 1.0])


def test_dust_and_a_wrong_angle_take_power_from_an_array(machine: Callable) -> None:
    solar = machine("mars_sol")
    names = list(solar.model.power.params.sources)
    source = next(name for name in names if solar.model.power.params.sources[name].kind == "photovoltaic_array")
    plant = FaultyPlant(solar.model)
    clean = solar.model.given.power.sources[source]
    dusty = plant.model(plant.with_fault((), fault("array_dust", source=source, share=0.4), "a", solar.start))
    turned = fault("panel_stuck", source=source, normal=(0.0, 1.0, 0.0))
    aside = plant.model(plant.with_fault((), turned, "a", solar.start))
    light = PowerSurroundings(to_sun=np.array([0.0, 0.0, 1.0]), up=np.array([0.0, 0.0, 1.0]), direct=500.0, diffuse=0.0)
    state = clean.initial_state()
    most = clean.point(state, light).power
    assert most > 0.0
    # nearly in proportion to the light: the voltage falls a little with it besides
    assert 0.5 * most < dusty.power.params.sources[source].point(state, light).power < 0.6 * most
    assert aside.power.params.sources[source].point(state, light).power == 0.0


def test_before_its_time_a_fault_changes_nothing(flat: Any, numbers_of: Callable[[PlantState], np.ndarray]) -> None:
    command = flat.hold(0.5)
    late = [fault("motor_dead", joint=WHEEL, at=100.0), fault("joint_seized", joint=STEERING, at=50.0)]
    np.testing.assert_array_equal(
        numbers_of(driven(flat, late, command, 0.5)[-1][0]), numbers_of(driven(flat, [], command, 0.5)[-1][0])
    )
    well = replace(command, motor_health=np.ones(len(flat.model.joints.names)))
    np.testing.assert_array_equal(
        numbers_of(step(flat.model, flat.start, well)[0]), numbers_of(step(flat.model, flat.start, command)[0])
    )


def test_a_plant_made_anew_for_a_fault_is_the_same_plant_but_for_it(
    flat: Any, numbers_of: Callable[[PlantState], np.ndarray]
) -> None:
    nothing = fault("motor_weak", joint=WHEEL, part=0.999999)  # of which it never needs the rest
    np.testing.assert_array_equal(
        numbers_of(driven(flat, [nothing], flat.hold(0.2), 1.0)[-1][0]),
        numbers_of(driven(flat, [], flat.hold(0.2), 1.0)[-1][0]),
    )


def test_numbers_that_cannot_be_are_refused(flat: Any) -> None:
    with pytest.raises(InvalidValueError, match="health"):
        step(flat.model, flat.start, replace(flat.hold(), motor_health=np.ones(3)))
    with pytest.raises(ValueError, match="does not go again"):
        fault("gear_broken", joint=WHEEL, until=3.0)
