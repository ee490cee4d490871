"""A spindle: a DC motor behind a gear that an amplifier holds at a rate, as seen once a control period.

    T_out = η N K_t (I - I_0) - T_f - b ω,   U = R I + K_t N ω <= U_bus,   I <= I_max

(permanent-magnet motor behind a gear of the ratio N; Fitzgerald, Kingsley & Umans 2003, Electric Machinery, ch. 7.) The
rate follows the command with the amplifier's acceleration, no higher than the voltage allows for the present load. A
load that asks for more than the largest current makes it slow down by what is lacking, J dω/dt = T_max - T_load, with
the rotor's inertia over the gear, until it stands: a stalled spindle takes its largest current, and all of it is heat.

Assumptions: the load's torque opposes the rate and does not depend on it; electrical and mechanical transients shorter
than a control period are left out, as is the energy of the rotor. It turns one way.
"""

import math
from typing import NamedTuple

from sojourn_machine.drives import GearParams, MotorParams


class Spindle(NamedTuple):
    """What turns."""

    motor: MotorParams
    gear: GearParams
    acceleration: float
    """Of the amplifier [rad/s2]."""


class SpindleOutput(NamedTuple):
    """One period of a spindle; powers are means of it [W]."""

    rate: float
    """At the end [rad/s]."""
    current: float
    """[A]"""
    electrical: float
    winding_heat: float
    friction_heat: float
    at_load: float
    """Given to the load."""
    stalled: bool
    """It is told to turn, and its load holds it."""


def spindle_step(
    spindle: Spindle, rate: float, wanted: float, load: float, voltage: float, supply: float, dt: float
) -> SpindleOutput:
    """One period of `dt` [s].

    Args:
        rate, wanted: now and as commanded, 0 or above [rad/s].
        load: torque at the output while it turns [N m]. voltage: of the bus [V]. supply: part of its current, 0 to 1.
    """
    motor, gear, acceleration = spindle
    strength = gear.efficiency * gear.ratio * motor.torque_constant
    most = supply * motor.max_current
    back = motor.torque_constant * gear.ratio
    drag = load + gear.friction_torque
    # current that holds a rate is I_0 + (drag + b ω)/strength; the voltage left for it falls with the rate
    fastest = (voltage - motor.resistance * (motor.no_load_current + drag / strength)) / (
        back + motor.resistance * gear.viscous_friction / strength
    )
    available = strength * max(most - motor.no_load_current, 0.0) - drag - gear.viscous_friction * rate
    stalled = wanted > 0.0 and (available < 0.0 or fastest <= 0.0)
    if stalled:
        lacking = min(available, 0.0) / (motor.rotor_inertia * gear.ratio**2)
        after = max(rate + lacking * dt, 0.0)
    else:
        step = acceleration * dt
        after = min(max(rate + min(max(wanted - rate, -step), step), 0.0), max(fastest, 0.0))
    mean = 0.5 * (rate + after)
    if stalled:
        current = min(most, voltage / motor.resistance)
    elif mean > 0.0 and wanted > 0.0:
        current = min(motor.no_load_current + (drag + gear.viscous_friction * mean) / strength, most)
    else:
        current = 0.0  # it runs down, or stands
    heat = motor.resistance * current * current
    electrical = heat + back * mean * current
    # what a spindle gives while it is braked comes from its rotor too, whose energy is left out
    at_load = min(load * mean, electrical - heat) if current > 0.0 else 0.0
    friction = electrical - heat - at_load
    return SpindleOutput(after, current, electrical, heat, friction, at_load, stalled and after == 0.0)


def stall_torque(motor: MotorParams, gear: GearParams) -> float:
    """Largest torque at the output, as far as the current goes [N m]."""
    torque = gear.efficiency * gear.ratio * motor.torque_constant * (motor.max_current - motor.no_load_current)
    return max(torque - gear.friction_torque, 0.0) if math.isfinite(torque) else 0.0
