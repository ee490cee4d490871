"""Motors, gears and servos that are strong enough for a machine: those of config/parts, so many of them as it takes.

A drive of n equal motors on one gear is one motor with resistance / n, n times the inertia, the current at no load and
the largest current, and the same torque constant. n need not be whole: it says how large a motor of that make is.

    torque of the joint     T = n i k ratio efficiency
    reflected inertia       J = n ratio^2 J_rotor + J_load
    servo                   proportional = 100 J /s (rate),  2300 J /s^2 (angle): 15 and 8 Hz, as on the rovers of
                            config/machines
"""

from dataclasses import dataclass

from sojourn_config.load import load_params
from sojourn_config.starter.size import StarterSize
from sojourn_machine.drives import MotorParams

DRIVING, STEERING = "maxon_re40", "maxon_re25"
CURRENT = {DRIVING: 6.0, STEERING: 2.0}
"""Largest of one motor: its rating for lasting work, and a little above it for steering, which is short [A]."""
LEAST_VOLTS = 22.0
"""Of the bus, empty, by config/parts/default_power.yaml [V]."""
PULL = 1.5
"""Largest force at a rim over the weight on the wheel: slopes, edges, and the sideways drag of turns [-]."""
STEER_RATE = 0.6
"""Of a steering joint [rad/s]."""
STEER_RATIO = 600.0


@dataclass(frozen=True)
class StarterDrive:
    """A drive of a group of joints.

    Args:
        joints: it turns, one motor each. load: of the bus. effort: largest torque of a joint [N m].
        power: of all motors at half of the torque and half of the rate, at which the limit of speed is [W].
        lines: of machine.yaml, below `joints`.
    """

    joints: tuple[str, ...]
    load: str
    effort: float
    power: float
    lines: tuple[str, ...]


@dataclass(frozen=True)
class _Gear:
    ratio: float
    efficiency: float


def rim_effort(size: StarterSize) -> float:
    """Torque that a wheel or a sprocket is to have [N m]."""
    return PULL * size.load * size.radius


def driving(joints: tuple[str, ...], size: StarterSize, spin: float) -> StarterDrive:
    """Of wheels or sprockets; spin: moment of inertia of one about its axle [kg m^2]."""
    motor = _motor(DRIVING)
    ratio = float(f"{0.6 * LEAST_VOLTS / motor.torque_constant / size.rim_rate:.2g}")
    number, inertia = _number_of(DRIVING, rim_effort(size), _Gear(ratio, 0.72))
    effort, gain = rim_effort(size), 100.0 * (inertia + spin)
    lines = (
        _motor_line(DRIVING, number),
        _gear_line(ratio, 0.72, 0.04 * effort, 0.02 * effort),
        f"servo: {{mode: rate, proportional: {gain:.3g}, integral: {2.0 * gain:.3g}, max_torque: {1.3 * effort:.3g}}}",
    )
    working = effort * size.rim_rate / 0.72 + number * CURRENT[DRIVING] ** 2 * motor.resistance
    return StarterDrive(joints, "drive", effort, len(joints) * 0.25 * working, lines)


def steering(joints: tuple[str, ...], effort: float, inertia: float, make: str = STEERING) -> StarterDrive:
    """Of joints that steer. effort: [N m]. inertia: that one of them turns [kg m^2]."""
    motor, gear = _motor(make), _Gear(STEER_RATIO, 0.65)
    number, reflected = _number_of(make, effort, gear)
    total = reflected + inertia
    lines = (
        _motor_line(make, number),
        _gear_line(gear.ratio, gear.efficiency, 0.04 * effort, 0.03 * effort),
        f"servo: {{mode: position, proportional: {2300.0 * total:.3g}, integral: {1000.0 * total:.3g}, "
        f"derivative: {180.0 * total:.3g}, max_torque: {effort:.3g}}}",
    )
    working = effort * STEER_RATE / gear.efficiency + number * CURRENT[make] ** 2 * motor.resistance
    return StarterDrive(joints, "steer", effort, len(joints) * 0.5 * working, lines)


def _motor(make: str) -> MotorParams:
    return load_params("parts", make, MotorParams, [f"max_current={CURRENT[make]}"])


def _number_of(make: str, effort: float, gear: _Gear) -> tuple[float, float]:
    """How many motors it takes for a torque of the joint [N m], and their inertia seen there [kg m^2]."""
    motor = _motor(make)
    one = CURRENT[make] * motor.torque_constant * gear.ratio * gear.efficiency
    number = float(f"{1.15 * effort / one:.2g}")  # what friction takes, with a little to spare
    return number, number * gear.ratio**2 * motor.rotor_inertia


def _motor_line(make: str, number: float) -> str:
    one = _motor(make)
    scaled = {
        "resistance": one.resistance / number,
        "rotor_inertia": one.rotor_inertia * number,
        "no_load_current": one.no_load_current * number,
        "max_current": CURRENT[make] * number,
    }
    values = ", ".join(f"{key}: {value:.3g}" for key, value in scaled.items())
    return f"motor: {{extends: {make}, {values}}} # {number:g} of them"


def _gear_line(ratio: float, efficiency: float, friction: float, viscous: float) -> str:
    return (
        f"gear: {{ratio: {ratio:.3g}, efficiency: {efficiency}, friction_torque: {friction:.3g}, "
        f"viscous_friction: {viscous:.3g}}}"
    )
