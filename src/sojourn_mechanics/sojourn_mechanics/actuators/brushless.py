"""Three-phase brushless motor with sinusoidal back-EMF, in the rotor's axes d and q (amplitude-invariant Park
transform).

    v_d = R i_d + L_d i_d' - w_e L_q i_q
    v_q = R i_q + L_q i_q' + w_e (L_d i_d + psi),       w_e = p w, p pole pairs
    T   = 1.5 p [psi i_q + (L_d - L_q) i_d i_q] - T_f sign(w) - b w + T_c sin(N_c th + f_c)         (cogging)
    inverter: sqrt(v_d^2 + v_q^2) <= V_dc/sqrt(3)       (space-vector modulation)
R, L of one phase (half of those measured between two terminals in star). K_T = 1.5 p psi is the torque per amplitude of
the phase current; the DC motor of `joint_drive` that is equivalent at the supply has k = sqrt(3) p psi, R = 2 R_phase.
(Krause, Wasynczuk, Sudhoff and Pekarek 2013, Analysis of Electric Machinery, ch. 8.)
Assumptions: no saturation, no iron loss but b w, ideal inverter. The step is implicit (trapezoidal) in the currents.
Range: steps below a tenth of the electrical period.
"""

import math
from typing import NamedTuple

import numpy as np
from pydantic import Field

from sojourn_mechanics.errors import InvalidValueError
from sojourn_mechanics.params import Params


class BrushlessParams(Params):
    """A brushless motor."""

    phase_resistance: float = Field(gt=0.0, le=1e4, description="R of one phase [ohm]")
    inductance_d: float = Field(gt=0.0, le=10.0, description="L_d [H]")
    inductance_q: float = Field(gt=0.0, le=10.0, description="L_q [H]")
    flux: float = Field(gt=0.0, le=100.0, description="psi, flux linkage of the magnets [V s]")
    pole_pairs: int = Field(ge=1, le=100, description="p [-]")
    rotor_inertia: float = Field(gt=0.0, le=10.0, description="[kg m^2]")
    friction_torque: float = Field(default=0.0, ge=0.0, le=100.0, description="T_f [N m]")
    viscous_friction: float = Field(default=0.0, ge=0.0, le=10.0, description="b [N m s/rad]")
    cogging_torque: float = Field(default=0.0, ge=0.0, le=100.0, description="T_c [N m]")
    cogging_periods: int = Field(default=0, ge=0, le=10_000, description="N_c, of the cogging in one turn [-]")
    cogging_phase: float = Field(default=0.0, ge=-7.0, le=7.0, description="f_c [rad]")
    max_current: float = Field(gt=0.0, le=5000.0, description="amplitude of the phase current [A]")


class BrushlessState(NamedTuple):
    """Currents i_d, i_q [A], rate [rad/s] and angle [rad] of the rotor."""

    current_d: float
    current_q: float
    rate: float
    angle: float


def torque_constant(motor: BrushlessParams) -> float:
    """K_T = 1.5 p psi [N m/A], for the amplitude of the phase current without i_d."""
    return 1.5 * motor.pole_pairs * motor.flux


def electromagnetic_torque(motor: BrushlessParams, current_d: float, current_q: float) -> float:
    """Torque of the air gap [N m]: magnets and saliency."""
    saliency = (motor.inductance_d - motor.inductance_q) * current_d * current_q
    return 1.5 * motor.pole_pairs * (motor.flux * current_q + saliency)


def cogging(motor: BrushlessParams, angle: float) -> float:
    """Torque of the magnets on the teeth [N m]; no work over a period."""
    return motor.cogging_torque * math.sin(motor.cogging_periods * angle + motor.cogging_phase)


def steady_voltage(motor: BrushlessParams, current_d: float, current_q: float, rate: float) -> tuple[float, float]:
    """v_d, v_q [V] that hold currents [A] at a rate [rad/s]."""
    electrical = motor.pole_pairs * rate
    v_d = motor.phase_resistance * current_d - electrical * motor.inductance_q * current_q
    v_q = motor.phase_resistance * current_q + electrical * (motor.inductance_d * current_d + motor.flux)
    return v_d, v_q


def largest_torque(motor: BrushlessParams, rate: float, bus_voltage: float) -> tuple[float, float, float]:
    """Largest torque of the air gap at a rate of at least 0, with its i_d and i_q: (T [N m], i_d, i_q [A]).

    With i_d = 0 while the voltage suffices; beyond, i_d < 0 weakens the field within the current limit. Torque 0 and
    the currents (0, 0) where no current within the limit holds the voltage (the motor turns too fast).
    """
    for name, value in (("rate", rate), ("bus_voltage", bus_voltage)):
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidValueError(name, value, "a finite number, at least 0")
    limit = bus_voltage / math.sqrt(3.0)
    best = (0.0, 0.0, 0.0)
    for current_d in np.linspace(0.0, -motor.max_current, 201):
        room = math.sqrt(max(motor.max_current**2 - float(current_d) ** 2, 0.0))
        # |v|^2 is a parabola in i_q: its larger root bounds i_q
        electrical = motor.pole_pairs * rate
        a = motor.phase_resistance**2 + (electrical * motor.inductance_q) ** 2
        back = electrical * (motor.inductance_d * float(current_d) + motor.flux)
        r_d = motor.phase_resistance * float(current_d)
        b = 2.0 * motor.phase_resistance * back - 2.0 * r_d * electrical * motor.inductance_q
        c = r_d * r_d + back * back - limit * limit
        discriminant = b * b - 4.0 * a * c
        if discriminant < 0.0:
            continue
        current_q = min((-b + math.sqrt(discriminant)) / (2.0 * a), room)
        torque = electromagnetic_torque(motor, float(current_d), current_q)
        if torque > best[0] + 1e-12:
            best = (torque, float(current_d), current_q)
    return best


def step_brushless(
    motor: BrushlessParams, state: BrushlessState, voltage: tuple[float, float], load: float, inertia: float, dt: float
) -> BrushlessState:
    """After dt [s] under v_d, v_q [V], with a load torque [N m] and inertia [kg m^2] on the shaft."""
    electrical = motor.pole_pairs * state.rate
    resistance = motor.phase_resistance
    ld, lq = motor.inductance_d, motor.inductance_q
    matrix = np.array([[-resistance / ld, electrical * lq / ld], [-electrical * ld / lq, -resistance / lq]])
    source = np.array([voltage[0] / ld, (voltage[1] - electrical * motor.flux) / lq])
    now = np.array([state.current_d, state.current_q])
    half = 0.5 * dt * matrix
    currents = np.linalg.solve(np.eye(2) - half, now + half @ now + dt * source)
    mean = 0.5 * (now + currents)
    drive = electromagnetic_torque(motor, float(mean[0]), float(mean[1])) + cogging(motor, state.angle) - load
    total = motor.rotor_inertia + inertia
    rate = (state.rate + dt * drive / total) / (1.0 + dt * motor.viscous_friction / total)
    # dry friction: what it can take in the step without turning the motion round
    slowed = max(abs(rate) - dt * motor.friction_torque / total, 0.0)
    rate = math.copysign(slowed, rate)
    angle = state.angle + dt * rate
    return BrushlessState(float(currents[0]), float(currents[1]), rate, angle)
