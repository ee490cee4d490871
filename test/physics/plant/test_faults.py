"""Motors that fail in the plant: a locked joint holds, a dead motor takes no current and the ground may turn it."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.plant.faults import MotorFaults
from sojourn_physics.plant.params import FaultParams
from sojourn_physics.plant.state import PlantCommand, PlantState
from sojourn_physics.plant.step import step

STEERING, WHEEL = "steer_front_left_joint", "wheel_front_left_joint"


def driven(machine: Callable, faults: list[FaultParams], command: PlantCommand, seconds: float) -> list:
    """State and output of each period, with the faults on the command."""
    acting, held, state, history = MotorFaults(machine.model, faults), {}, machine.start, []
    for tick in range(round(seconds / 0.02)):
        told, held = acting.on(command, held, state.joints[0], 0.02 * (tick + 1))
        state, output = step(machine.model, state, told)
        history.append((state, output))
    return history


@pytest.mark.parametrize(("angle_deg", "held"), [(None, 0.0), (20.0, math.radians(20.0))])
def test_a_locked_steering_stays_where_it_is_whatever_is_commanded(
    flat: Callable, angle_deg: float | None, held: float
) -> None:
    command = flat.hold()
    steering, other = flat.model.reference_rows([STEERING, "steer_front_right_joint"])
    command.reference[0, [steering, other]] = -0.4
    fault = FaultParams(joint=STEERING, kind="locked", at_s=0.0, angle_deg=angle_deg)
    state, _ = driven(flat, [fault], command, 3.0)[-1]
    assert state.joints[0, steering] == pytest.approx(held, abs=2e-3)
    assert state.joints[0, other] == pytest.approx(-0.4, abs=5e-3)


def test_a_dead_motor_takes_no_current_and_is_turned_by_the_ground(flat: Callable) -> None:
    (wheel,) = flat.model.reference_rows([WHEEL])
    fault = FaultParams(joint=WHEEL, kind="dead", at_s=1.0)
    history = driven(flat, [fault], flat.hold(0.5), 3.0)
    before, after = history[40], history[-1]
    assert before[1].currents[wheel] > 0.1
    assert after[1].currents[wheel] == 0.0
    assert after[1].efforts[wheel] < -2.0  # the gear's friction
    column = flat.model.joints.columns[wheel]
    assert 0.0 < after[0].velocity[column] < 0.45
    # what the other motors put in still goes somewhere
    assert after[0].energy.balance_error(history[60][0].energy) < 0.01


def test_a_locked_wheel_stops(flat: Callable) -> None:
    (wheel,) = flat.model.reference_rows([WHEEL])
    history = driven(flat, [FaultParams(joint=WHEEL, kind="locked", at_s=1.0)], flat.hold(0.5), 4.0)
    column = flat.model.joints.columns[wheel]
    assert history[40][0].velocity[column] == pytest.approx(0.5, abs=0.02)
    assert abs(history[-1][0].velocity[column]) < 0.005  # a hundredth of what is commanded


def test_before_its_time_a_fault_changes_nothing(
    flat: Callable, numbers_of: Callable[[PlantState], np.ndarray]
) -> None:
    command = flat.hold(0.5)
    late = [FaultParams(joint=WHEEL, kind="dead", at_s=100.0), FaultParams(joint=STEERING, kind="locked", at_s=50.0)]
    np.testing.assert_array_equal(
        numbers_of(driven(flat, late, command, 0.5)[-1][0]), numbers_of(driven(flat, [], command, 0.5)[-1][0])
    )
    well = replace(command, motor_health=np.ones(len(flat.model.joints.names)))
    np.testing.assert_array_equal(
        numbers_of(step(flat.model, flat.start, well)[0]), numbers_of(step(flat.model, flat.start, command)[0])
    )


def test_faults_that_cannot_be_are_refused(flat: Callable) -> None:
    with pytest.raises(ValidationError, match="only a locked joint has an angle"):
        FaultParams(joint=WHEEL, kind="dead", at_s=0.0, angle_deg=20.0)
    with pytest.raises(InvalidValueError, match="wheel_front_leg_joint"):
        MotorFaults(flat.model, [FaultParams(joint="wheel_front_leg_joint", kind="dead", at_s=0.0)])
    with pytest.raises(InvalidValueError, match="health"):
        step(flat.model, flat.start, replace(flat.hold(), motor_health=np.ones(3)))
