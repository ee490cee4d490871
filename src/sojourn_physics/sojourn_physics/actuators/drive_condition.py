"""What changes a drive from one control period to the next: heat of its motor, and its brake.

    heat    temperatures of winding and housing by `motor_thermal`; the winding's resistance and the magnets' constant
            follow them, and the current is held to what winding and magnets stand
    brake   closes in t_close without current (its load is off, or its motor dead), opens in t_open with it; its closed
            share s adds s T_b N to the gear's friction without load, of Dahl's kind as that is, so that it holds a
            joint at a fixed point and its heat is booked with the friction's

Both are slow against a control period, so they stand still within it. Machines that name neither pay nothing.
Assumptions: friction of the brake independent of rate and temperature, the same at rest and sliding.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from sojourn_machine.actuator_choice import ActuatorParams
from sojourn_machine.drives import BrakeParams, JointDriveParams, MotorThermalParams
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.actuators import motor_thermal
from sojourn_physics.actuators.joint_drive import FRICTION, MAX_CURRENT, RATIO, RESISTANCE, TORQUE_CONSTANT

WINDING, HOUSING, CLOSED = range(3)
CONDITION_ROWS = 3
"""Temperatures of winding and housing [K], closed share of the brake [-]; of a drive without one of them, unused."""


Surroundings: TypeAlias = Sequence[float | None]
"""Temperature of what is round each drive; None: as its parameters have it [K]."""


@dataclass(frozen=True, eq=False)
class DriveConditions:
    """Drives of one machine that heat up or have a brake.

    Attributes:
        rows: (drives,) of the joints' tables. thermal, brakes: of each of them, or None.
        parameters: (joints, JOINT_COLUMNS): cold, brakes open.
    """

    rows: IntArray
    thermal: tuple[MotorThermalParams | None, ...]
    brakes: tuple[BrakeParams | None, ...]
    parameters: FloatArray

    def first(self, around: Surroundings | None = None) -> FloatArray:
        """Motors as cold as their surroundings, brakes open: (CONDITION_ROWS, drives)."""
        state = np.zeros((CONDITION_ROWS, len(self.rows)))
        for number, thermal in enumerate(self.thermal):
            if thermal is not None:
                state[:CLOSED, number] = thermal.surroundings + self._shift(thermal, number, around)
        return state

    @staticmethod
    def _shift(thermal: MotorThermalParams, number: int, around: Surroundings | None) -> float:
        """How much warmer it is round a motor than its parameters say [K]."""
        here = None if around is None else around[number]
        return 0.0 if here is None else here - thermal.surroundings

    def now(self, state: FloatArray) -> FloatArray:
        """Parameters of the joints for a period, (joints, JOINT_COLUMNS)."""
        table = self.parameters.copy()
        for number, row in enumerate(self.rows):
            thermal, brake, cold = self.thermal[number], self.brakes[number], self.parameters[row]
            if thermal is not None:
                found = motor_thermal.MotorTemperatures(float(state[WINDING, number]), float(state[HOUSING, number]))
                constant = motor_thermal.warm_torque_constant(thermal, float(cold[TORQUE_CONSTANT]), found.housing)
                table[row, RESISTANCE] = motor_thermal.warm_resistance(float(cold[RESISTANCE]), found.winding)
                table[row, TORQUE_CONSTANT] = constant
                table[row, MAX_CURRENT] = motor_thermal.allowed_current(thermal, float(cold[MAX_CURRENT]), found)
            if brake is not None:
                table[row, FRICTION] += state[CLOSED, number] * brake.holding_torque * cold[RATIO]
        return table

    def after(
        self,
        state: FloatArray,
        table: FloatArray,
        squares: FloatArray,
        limits: FloatArray,
        dt: float,
        around: Surroundings | None = None,
    ) -> FloatArray:
        """State at the end of a period of dt [s].

        Args:
            table: what `now` gave for the period. squares: (joints,) mean square of each motor's current in it [A^2].
            limits: (joints,) part of its current that each motor could draw.
            around: what is round each drive [K]; left out: as the parameters have it.
        """
        new = state.copy()
        for number, row in enumerate(self.rows):
            thermal, brake = self.thermal[number], self.brakes[number]
            if thermal is not None:
                # the equations are linear: as warm as it is round the motor, so much warmer is all of it
                winding, housing = (state[:CLOSED, number] - (shift := self._shift(thermal, number, around))).tolist()
                before = motor_thermal.MotorTemperatures(winding, housing)
                loss = float(table[row, RESISTANCE] * squares[row])
                new[:CLOSED, number] = motor_thermal.step_temperatures(thermal, before, loss, dt)
                new[:CLOSED, number] += shift
            if brake is not None:
                closes = limits[row] <= 0.0
                span = brake.closing_time if closes else brake.opening_time
                change = math.inf if span == 0.0 else dt / span
                new[CLOSED, number] = min(max(state[CLOSED, number] + (change if closes else -change), 0.0), 1.0)
        return new


def conditions_of(drives: Sequence[ActuatorParams | None], parameters: FloatArray) -> DriveConditions | None:
    """Of a machine, joint by joint; None where no motor heats up or has a brake."""
    named = {
        row: drive
        for row, drive in enumerate(drives)
        if isinstance(drive, JointDriveParams) and (drive.thermal or drive.brake)
    }
    if not named:
        return None
    return DriveConditions(
        np.array(list(named), dtype=np.int64),
        tuple(drive.thermal for drive in named.values()),
        tuple(drive.brake for drive in named.values()),
        parameters,
    )
