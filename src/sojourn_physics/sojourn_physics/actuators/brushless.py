"""Three-phase brushless motor with sinusoidal back-EMF, in the rotor's axes d and q (amplitude-invariant Park
transform).

    v_d = R i_d - w_e L_q i_q,   v_q = R i_q + w_e (L_d i_d + psi),       w_e = p w, p pole pairs; steady currents
    T   = 1.5 p [psi i_q + (L_d - L_q) i_d i_q] - T_f sign(w) - b w
    inverter: sqrt(v_d^2 + v_q^2) <= V_dc/sqrt(3)       (space-vector modulation)
R, L of one phase (half of those measured between two terminals in star). K_T = 1.5 p psi is the torque per amplitude of
the phase current; the DC motor that is equivalent at the supply has k = sqrt(3) p psi, R = 2 R_phase: with i_d = 0 it
has the same torque and takes the same power, and the plant takes it so (`BrushlessMotorParams.from_supply`); what is
left out is the drop w_e L_q i_q across the other axis, which brings the voltage's limit a little earlier.
(Krause, Wasynczuk, Sudhoff and Pekarek 2013, Analysis of Electric Machinery, ch. 8.)
Assumptions: no saturation, no iron loss but b w, no cogging, ideal inverter.
"""

import math

import numpy as np

from sojourn_machine.drives import BrushlessMotorParams
from sojourn_machine.errors import InvalidValueError


def torque_constant(motor: BrushlessMotorParams) -> float:
    """K_T = 1.5 p psi [N m/A], for the amplitude of the phase current without i_d."""
    return 1.5 * motor.pole_pairs * motor.flux


def electromagnetic_torque(motor: BrushlessMotorParams, current_d: float, current_q: float) -> float:
    """Torque of the air gap [N m]: magnets and saliency."""
    saliency = (motor.inductance_d - motor.inductance_q) * current_d * current_q
    return 1.5 * motor.pole_pairs * (motor.flux * current_q + saliency)


def largest_torque(motor: BrushlessMotorParams, rate: float, bus_voltage: float) -> tuple[float, float, float]:
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
