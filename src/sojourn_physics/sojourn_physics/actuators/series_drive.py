"""Series motor with its brake in a joint's drive: what `joint_drive` asks of it, compiled. The law is `series_motor`'s.

The amplifier turns the field round with the sense of the torque, so that the motor drives both ways:

    torque N T(I), T = K_0 I^2/(1 + I/I_sat) >= 0;  with all of the voltage
    R I^2 + (R I_sat + K_0 I_sat |w| - V) I - V I_sat = 0

The motor gives nothing back to the bus and brakes nothing: without remanence it has no field to do it with. A friction
brake in the wheel does (the hand controller of the lunar roving vehicle switches the drive off, then pulls the drums).
It acts where the servo asks for a torque against the motion, where the commanded rate is zero, and where the load is
switched off; it is limited by the servo's largest torque, draws no current, and its work is friction heat.
Rates and torques are those of the motor's shaft unless told otherwise. Range: that of `series_motor`; quasi-static.
"""

import math

from sojourn_machine.kernels import kernel


@kernel
def series_torque(constant: float, saturation: float, current: float) -> float:
    """T [N m] of a current of at least 0 [A]. constant: K_0 [N m/A^2]. saturation: I_sat [A]."""
    return constant * current * current / (1.0 + current / saturation)


@kernel
def series_current(constant: float, saturation: float, torque: float) -> float:
    """Current [A] of a torque of at least 0 [N m]: the inverse of `series_torque`."""
    half = 0.5 * torque / saturation
    return (half + math.sqrt(half * half + constant * torque)) / constant


@kernel
def torque_at_full_voltage(
    constant: float, saturation: float, resistance: float, voltage: float, rate: float
) -> tuple[float, float]:
    """T [N m] and -dT/dw [N m s] with all of the voltage [V] at a rate of at least 0 [rad/s]."""
    linear = (resistance + constant * rate) * saturation - voltage
    root = math.sqrt(linear * linear + 4.0 * resistance * voltage * saturation)
    if root == 0.0:
        return 0.0, 0.0
    # the form without cancellation, whichever sign `linear` has
    current = 2.0 * voltage * saturation / (linear + root) if linear > 0.0 else (root - linear) / (2.0 * resistance)
    part = 1.0 + current / saturation
    growth = constant * current * (1.0 + part) / (part * part)
    return series_torque(constant, saturation, current), growth * constant * saturation * current / root
