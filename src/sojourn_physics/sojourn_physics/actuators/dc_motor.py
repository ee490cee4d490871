"""Steady working points of a permanent-magnet direct-current motor, brushed or brushless seen from its supply.

    V = R I + k w,      T = k (I - sign(w) I_0)                  (k = K_T = K_B in SI units)
    stall  I_s = V/R, T_s = k I_s;   no load  w_0 = (V - R I_0)/k
    efficiency  n = T w / (V I),  greatest at I = sqrt(I_0 I_s):  n_max = (1 - sqrt(I_0/I_s))^2
    mechanical time constant  t_m = R J / k^2
    (Fitzgerald, Kingsley and Umans, Electric Machinery, 6th ed. 2003, ch. 7; maxon, Key information on motors)

Here T is the torque at the shaft. The stall torque of catalogues leaves out the friction I_0 k; so does `stall_torque`.
Assumptions: linear magnetic circuit, one winding temperature (see `motor_thermal` for others), friction independent of
the rate. Range: the four quadrants, within the speed and current that the catalogue allows.
"""

import math
from typing import NamedTuple

from sojourn_machine.drives import MotorParams
from sojourn_machine.errors import InvalidValueError


class WorkingPoint(NamedTuple):
    """Motor in steady rotation: rate [rad/s], shaft torque [N m], current [A], voltage [V], electrical power [W]."""

    rate: float
    torque: float
    current: float
    voltage: float
    power: float

    @property
    def efficiency(self) -> float:
        """Mechanical over electrical power when it drives, the inverse when it brakes and feeds back; 0 elsewhere."""
        out = self.torque * self.rate
        if out > 0.0 and self.power > 0.0:
            return out / self.power
        if out < 0.0 and self.power < 0.0:
            return self.power / out
        return 0.0


def stall_current(motor: MotorParams, voltage: float) -> float:
    """Current of the standing motor at a voltage [V], in A."""
    return _finite("voltage", voltage) / motor.resistance


def stall_torque(motor: MotorParams, voltage: float) -> float:
    """Torque of the standing motor at a voltage [V], friction left out as in catalogues [N m]."""
    return motor.torque_constant * stall_current(motor, voltage)


def no_load_rate(motor: MotorParams, voltage: float) -> float:
    """Rate at which the free motor turns [rad/s]; 0 where the voltage [V] does not overcome its friction."""
    drop = motor.resistance * motor.no_load_current
    magnitude = abs(_finite("voltage", voltage))
    return math.copysign(max(magnitude - drop, 0.0) / motor.torque_constant, voltage)


def greatest_efficiency(motor: MotorParams, voltage: float) -> float:
    """Largest efficiency at a voltage [V] of more than the one that overcomes the friction."""
    stall = abs(stall_current(motor, voltage))
    if stall <= motor.no_load_current:
        raise InvalidValueError("voltage", voltage, f"more than {motor.resistance * motor.no_load_current:g} V")
    return (1.0 - math.sqrt(motor.no_load_current / stall)) ** 2


def mechanical_time_constant(motor: MotorParams, load_inertia: float = 0.0) -> float:
    """Time constant of the rate after a step of voltage, R J/k^2 [s], with a load [kg m^2] on the shaft."""
    return motor.resistance * (motor.rotor_inertia + load_inertia) / motor.torque_constant**2


def working_point(motor: MotorParams, torque: float, rate: float) -> WorkingPoint:
    """What the motor needs for a shaft torque [N m] at a rate [rad/s].

    Raises:
        InvalidValueError: a number that is not finite.
    """
    _finite("torque", torque)
    _finite("rate", rate)
    friction = math.copysign(motor.no_load_current, rate) if rate else 0.0
    current = torque / motor.torque_constant + friction
    voltage = motor.resistance * current + motor.torque_constant * rate
    return WorkingPoint(rate, torque, current, voltage, voltage * current)


def largest_torque(motor: MotorParams, rate: float, voltage: float) -> float:
    """Largest driving torque at the shaft [N m] at a rate of at least 0 [rad/s], with the current limit.

    Args:
        voltage: of the supply, at least 0 [V].

    Raises:
        InvalidValueError: a negative or non-finite number.
    """
    for name, value in (("rate", rate), ("voltage", voltage)):
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidValueError(name, value, "a finite number, at least 0")
    current = min((voltage - motor.torque_constant * rate) / motor.resistance, motor.max_current)
    return motor.torque_constant * (current - (motor.no_load_current if rate > 0.0 else 0.0))


def _finite(name: str, value: float) -> float:
    if not math.isfinite(value):
        raise InvalidValueError(name, value, "a finite number")
    return value
