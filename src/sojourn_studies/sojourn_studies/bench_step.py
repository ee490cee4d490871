"""Bench of the plant's step, and the yardstick that other figures are told in.

Machines of one kind differ by a factor of two, and one machine from one moment to the next. So every speed is told
besides in Y, what three calls of Pinocchio take at that moment for the same machine: aba, forwardKinematics and
computeJointJacobians.
"""

import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin

from sojourn_config.scenario import load_scenario
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_physics.plant.kernels import open_period, touch_ground
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantState, zeros_command
from sojourn_physics.plant.step import step
from sojourn_plant.start import build_plant

YARDSTICK = ("aba", "forwardKinematics", "computeJointJacobians")
ROUNDS = 9
PERIODS_A_ROUND = 50
CALLS_A_ROUND = 1000
WHEEL_RATE = 0.5
"""[rad/s]"""
TARGETS = {
    "plant step [Y]": ("<=", 3.5),
    "plant step over floor": ("<=", 2.5),
    "contact kernel for each wheel or track [us]": ("<=", 2.5),
}


def bench_step(scenario: str) -> dict[str, float]:
    """Microseconds of a physics step while driving, of its floor, and the plant's own speed; medians over rounds.
    What does not drive stands.

    The floor of a step is what its libraries alone would take, measured in the same rounds: the yardstick Y and the
    contact kernel.
    """
    model, state = build_plant(load_scenario(scenario))
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    drives = model.reference_rows([support.joint for support in model.machine.rolling])
    command.reference[1, drives] = WHEEL_RATE
    state, _ = step(model, state, command)
    calls = _floor_calls(model, state)
    samples: dict[str, list[float]] = {name: [] for name in (*calls, "step")}
    for _ in range(ROUNDS):
        for name, call in calls.items():
            samples[name].append(_microseconds(call, CALLS_A_ROUND))
        begin = time.perf_counter()
        for _ in range(PERIODS_A_ROUND):
            state, _ = step(model, state, command)
        steps = PERIODS_A_ROUND * model.simulation.substeps
        samples["step"].append((time.perf_counter() - begin) / steps * 1e6)
    medians = {name: statistics.median(values) for name, values in samples.items()}
    floor = sum(medians[name] for name in calls)
    unit = sum(medians[name] for name in YARDSTICK)
    each = medians["contact kernel"] / max(len(model.machine.rolling), 1)
    return {
        "Y = aba + forwardKinematics + computeJointJacobians [us]": unit,
        "plant step [us]": medians["step"],
        "plant step [Y]": medians["step"] / unit,
        "floor of the step [us]": floor,
        "plant step over floor": medians["step"] / floor,
        **{f"  {name} [us]": medians[name] for name in calls},
        "contact kernel for each wheel or track [us]": each,
        "plant alone, times real time": CONTROL_PERIOD_S / (medians["step"] * 1e-6 * model.simulation.substeps),
    }


class Yardstick:
    """Y, measured again whenever it is asked for."""

    def __init__(self) -> None:
        self._calls = _yardstick_calls(*build_plant(load_scenario("flat_drive")))

    def microseconds(self) -> float:
        """Y now [us]: the sum of the medians."""
        samples = [[_microseconds(call, CALLS_A_ROUND) for call in self._calls.values()] for _ in range(ROUNDS)]
        return sum(statistics.median(column) for column in zip(*samples, strict=True))


def _floor_calls(model: PlantModel, state: PlantState) -> dict[str, Callable[[], Any]]:
    """The yardstick, and the contacts of this state in the memory of a period of their own."""
    tables = model.work.tables
    pin.computeJointJacobians(model.multibody, model.data, state.configuration)
    rates = tables.motion.rates.copy()
    rates[0] = state.velocity
    own = tables._replace(
        multibody=tables.multibody._replace(
            placements=model.placements.copy(), jacobian=np.asfortranarray(model.jacobian.copy())
        ),
        motion=tables.motion._replace(rates=rates, supports=state.supports.copy()),
        report=tables.report.copy(),
    )
    period = open_period(own)
    return {**_yardstick_calls(model, state), "contact kernel": lambda: touch_ground(period, 0)}


def _yardstick_calls(model: PlantModel, state: PlantState) -> dict[str, Callable[[], Any]]:
    """The calls of YARDSTICK."""
    multibody, data = model.multibody, model.data
    q, v, torque = state.configuration.copy(), state.velocity.copy(), np.zeros(model.multibody.nv)
    return {
        "aba": lambda: pin.aba(multibody, data, q, v, torque),
        "forwardKinematics": lambda: pin.forwardKinematics(multibody, data, q),
        "computeJointJacobians": lambda: pin.computeJointJacobians(multibody, data, q),
    }


def _microseconds(call: Callable[[], Any], count: int) -> float:
    call()
    begin = time.perf_counter()
    for _ in range(count):
        call()
    return (time.perf_counter() - begin) / count * 1e6
