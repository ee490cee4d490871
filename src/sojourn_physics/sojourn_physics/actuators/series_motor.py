"""Series-wound direct-current motor: field and armature carry the same current.

    V = R I + K(I) I w,    K(I) = K_0 / (1 + |I| / I_sat)            (Froehlich's saturation of the iron)
    T = K(I) I |I| - T_f - b w       T_f, b: brushes and bearings; windage and iron losses
    (Fitzgerald, Kingsley and Umans, Electric Machinery, 6th ed. 2003, sec. 7.4 to 7.6)

With I |I| in the torque the sense of rotation does not change with the sign of the current: field and armature change
together. Here rotation in one sense is modelled, w >= 0; a reversing switch on the field is outside of the model.
Without load the rate grows until b w, T_f stop it.
Assumptions: no armature reaction, no remanence: the motor cannot brake on its resistance without an outer excitation.
Range: I from 0 to some multiples of the rated current.
"""

import math

from sojourn_machine.drives import SeriesMotorParams
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.actuators.dc_motor import WorkingPoint


def air_gap_torque(motor: SeriesMotorParams, current: float) -> float:
    """Torque of the field on the armature [N m]."""
    return motor.field_constant * current * abs(current) / (1.0 + abs(current) / motor.saturation_current)


def friction_torque(motor: SeriesMotorParams, rate: float) -> float:
    """What brushes, bearings, windage and iron take at a rate of at least 0 [N m]."""
    return (motor.friction_torque if rate > 0.0 else 0.0) + motor.viscous_friction * rate


def current_for_torque(motor: SeriesMotorParams, torque: float) -> float:
    """Current [A] for a torque in the air gap of at least 0 [N m]: K_0 I^2 - T I/I_sat - T = 0."""
    if not (math.isfinite(torque) and torque >= 0.0):
        raise InvalidValueError("torque", torque, "a finite number, at least 0: this motor drives in one sense")
    half = 0.5 * torque / motor.saturation_current
    return (half + math.sqrt(half * half + motor.field_constant * torque)) / motor.field_constant


def series_working_point(motor: SeriesMotorParams, torque: float, rate: float) -> WorkingPoint:
    """What the motor needs for a torque at the shaft [N m] at a rate of at least 0 [rad/s].

    Raises:
        InvalidValueError: a rate below 0, or a torque that the motor would have to brake with.
    """
    if not (math.isfinite(rate) and rate >= 0.0):
        raise InvalidValueError("rate", rate, "a finite number, at least 0")
    current = current_for_torque(motor, torque + friction_torque(motor, rate))
    back = motor.field_constant * current / (1.0 + current / motor.saturation_current) * rate
    voltage = motor.series_resistance * current + back
    return WorkingPoint(rate, torque, current, voltage, voltage * current)


def series_largest_torque(motor: SeriesMotorParams, rate: float, voltage: float) -> float:
    """Largest torque at the shaft [N m] at a rate of at least 0 [rad/s] and a supply voltage [V], with current limit.

    R I^2 + (R I_s + K_0 I_s w - V) I - V I_s = 0 at the full voltage.
    """
    for name, value in (("rate", rate), ("voltage", voltage)):
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidValueError(name, value, "a finite number, at least 0")
    resistance, saturation = motor.series_resistance, motor.saturation_current
    linear = resistance * saturation + motor.field_constant * saturation * rate - voltage
    root = math.sqrt(linear * linear + 4.0 * resistance * voltage * saturation)
    # the form without cancellation, whichever sign `linear` has
    positive = 2.0 * voltage * saturation / (linear + root) if linear > 0.0 else (root - linear) / (2.0 * resistance)
    current = min(positive, motor.max_current)
    return air_gap_torque(motor, current) - friction_torque(motor, rate)
