"""Motor, gear and wheel in steady motion, and the mass that their rotation adds.

    wheel torque  T_w = n N T_m - T_f - b w_w          driving: n of the power goes through (loss of the gear under
    load)
                  T_w = N T_m / n - T_f - b w_w        braking, the wheel drives the motor (Genta and Genta 2017, sec.
                  5.9)
    equivalent mass  m_e = m + sum_i (J_w,i + N^2 J_m,i) / (r_i^2 (1 - s))    (Genta and Morello 2009, vol. 2, sec.
    23.8)

(1 - s): the wheel turns faster than it travels. Assumptions: a stiff driveline; one efficiency in each sense of power;
motors alike at all wheels. Feeding energy back is left to the motor: a permanent-magnet motor gives it to the bus, a
series motor cannot brake, so its machine brakes with friction.
"""

from typing import Protocol

from sojourn_analysis.vehicle.params import VehicleParams
from sojourn_machine.drives import GearParams, MotorParams, SeriesMotorParams
from sojourn_physics.actuators.dc_motor import WorkingPoint, largest_torque, working_point
from sojourn_physics.actuators.series_motor import series_largest_torque, series_working_point


class Driveline(Protocol):
    """A vehicle with one motor and gear at each wheel or sprocket."""

    @property
    def motor(self) -> MotorParams | SeriesMotorParams:
        """Of each."""

    @property
    def gear(self) -> GearParams:
        """Of each."""

    @property
    def bus_voltage(self) -> float:
        """[V]"""

    @property
    def controller_efficiency(self) -> float:
        """[-]"""


def motor_torque(vehicle: Driveline, wheel_torque: float, wheel_rate: float) -> float:
    """Torque of one motor [N m] for a torque [N m] and a rate of at least 0 [rad/s] at its wheel."""
    gear = vehicle.gear
    through = wheel_torque + (gear.friction_torque if wheel_rate > 0.0 else 0.0) + gear.viscous_friction * wheel_rate
    return through / gear.ratio / gear.efficiency if through >= 0.0 else through / gear.ratio * gear.efficiency


def motor_point(vehicle: Driveline, wheel_torque: float, wheel_rate: float) -> WorkingPoint:
    """Working point of one motor. A series motor that would have to brake takes no current: its brake does it."""
    torque, rate = motor_torque(vehicle, wheel_torque, wheel_rate), vehicle.gear.ratio * wheel_rate
    motor = vehicle.motor
    if isinstance(motor, MotorParams):
        return working_point(motor, torque, rate)
    try_torque = max(torque, 0.0)
    return series_working_point(motor, try_torque, rate) if torque > 0.0 else WorkingPoint(rate, 0.0, 0.0, 0.0, 0.0)


def bus_power(vehicle: Driveline, point: WorkingPoint) -> float:
    """Power that one motor draws from the bus through its controller, negative where it feeds back [W]."""
    efficiency = vehicle.controller_efficiency
    return point.power / efficiency if point.power > 0.0 else point.power * efficiency


def largest_wheel_torque(vehicle: Driveline, wheel_rate: float) -> float:
    """Largest driving torque at one wheel [N m] at a rate of at least 0 [rad/s]: bus voltage and current limit."""
    gear, motor = vehicle.gear, vehicle.motor
    rate = gear.ratio * wheel_rate
    if isinstance(motor, SeriesMotorParams):
        torque = series_largest_torque(motor, rate, vehicle.bus_voltage)
    else:
        torque = largest_torque(motor, rate, vehicle.bus_voltage)
    friction = (gear.friction_torque if wheel_rate > 0.0 else 0.0) + gear.viscous_friction * wheel_rate
    return gear.efficiency * gear.ratio * torque - friction


def equivalent_mass(vehicle: VehicleParams, slip: float = 0.0) -> float:
    """Mass that resists acceleration: body, wheels and rotors [kg]; the slip is below 1."""
    total = vehicle.mass
    for axle in vehicle.axles:
        inertia = axle.wheel_inertia
        if axle.driven:
            inertia += vehicle.gear.ratio**2 * vehicle.motor.rotor_inertia
        total += 2.0 * inertia / (axle.wheel_radius**2 * (1.0 - slip))
    return total
