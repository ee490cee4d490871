"""Steering without steered wheels: two bodies with a joint between them, and one side faster than the other."""

import math

import numpy as np

from sojourn_analysis.datasheet.figures import Curve, Figure, Section
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.vehicle.articulated import eigenvalues, stable_speed, turning_radii
from sojourn_analysis.vehicle.longitudinal import loads
from sojourn_analysis.vehicle.side_force import cornering_stiffness
from sojourn_analysis.vehicle.slip_steering import SlipVehicle, spin_moment, steady_turn
from sojourn_analysis.vehicle.two_bodies import two_bodies
from sojourn_analysis.vehicle.wheel_loads import StandingMachine

SLIDING_ANGLE = 0.6
"""Slip angle at which the side force of the soil is taken as that of a sliding wheel [rad]."""
SLIP_SPEED = 0.05
"""Slip speed over which the friction of sliding wheels builds up, over the cruise speed."""
FASTEST = 20.0
"""End of the search for the speed at which an articulated machine snakes or folds [m/s]."""


def articulated_steering(subject: Subject, machine: StandingMachine, joint: str) -> Section:
    """Turning circle and oscillation of two bodies with a joint between them."""
    halves = two_bodies(machine, joint, subject.angles)
    level = loads(subject.course(), 0.0)
    stiffness = [
        2.0 * cornering_stiffness(subject.side_force(axle), float(load))
        for axle, load in zip(subject.vehicle.axles, level, strict=True)
    ]
    front = halves.front._replace(stiffness=stiffness[0])
    rear = halves.rear._replace(stiffness=stiffness[-1])
    front_radius, rear_radius = turning_radii(front.axle, rear.axle, halves.largest_angle)
    cruise = subject.vehicle.cruise_speed
    values = eigenvalues(front, rear, halves.joint, cruise)
    swings = [complex(value) for value in values if value.imag > 1e-9]
    slowest = max(values, key=lambda value: float(value.real))
    critical, kind = stable_speed(front, rear, halves.joint, FASTEST)
    outer = front_radius + 0.5 * subject.vehicle.axles[0].track
    figures = [
        Figure("articulation_angle", "Largest articulation", math.degrees(halves.largest_angle), "°"),
        Figure("outer_wheel_radius", "Radius of the outer wheel's path, full lock", outer, "m"),
        Figure("centre_radius", "Radius of the front axle's middle, full lock", front_radius, "m"),
        Figure("rear_radius", "Radius of the rear axle's middle, full lock", rear_radius, "m"),
        Figure("articulated_yaw_rate", "Yaw rate there at cruise speed", math.degrees(cruise / front_radius), "°/s"),
        Figure("articulated_pole", "Slowest pole at cruise speed, real part", float(slowest.real), "1/s"),
        Figure("articulated_critical_speed", "Steady up to", critical, "m/s", kind),
    ]
    for number, value in enumerate(sorted(swings, key=abs), 1):
        note = f"damping ratio {-value.real / abs(value):.2f}"
        label = "Oscillation of the bodies at cruise speed"
        figures.append(Figure(f"articulated_mode_{number}", label, abs(value) / (2.0 * math.pi), "Hz", note))
    angles = np.linspace(0.05, 1.0, 40) * halves.largest_angle
    radii = np.array([turning_radii(front.axle, rear.axle, float(angle)) for angle in angles])
    lines = {"front axle": (np.degrees(angles), radii[:, 0]), "rear axle": (np.degrees(angles), radii[:, 1])}
    curve = Curve("Turning radius", "articulation [°]", "radius of the axle's middle [m]", lines)
    text = "Low speed: no side slip. Oscillation: linear, side force of the soil, the servo as spring and damper."
    return Section("Steering", tuple(figures), (curve,), text)


def slip_steering(subject: Subject) -> Section | None:
    """Turns with one side faster than the other: all that a machine of fixed wheels has. None where wheels steer."""
    vehicle = subject.vehicle
    if subject.rolls_sideways or any(axle.max_steer > 0.0 for axle in vehicle.axles):
        return None
    level = loads(subject.course(), 0.0)
    sliding = [
        -subject.side_force(axle).force(float(load), SLIDING_ANGLE)
        for axle, load in zip(vehicle.axles, level, strict=True)
    ]
    speed = vehicle.cruise_speed
    friction = float(sum(sliding) / level.sum())
    machine = SlipVehicle(subject.places, np.repeat(level, 2), friction, SLIP_SPEED * speed)
    spin = steady_turn(machine, -speed, speed)
    shares = np.linspace(-1.0, 0.95, 40)
    turns = [steady_turn(machine, float(share) * speed, speed) for share in shares]
    angle = f"side slip {math.degrees(SLIDING_ANGLE):.0f}°"
    figures = (
        Figure("slip_friction", "Side force over load, sliding", friction, "", angle),
        Figure("spin_moment", "Moment that resists a turn on the spot", spin_moment(machine), "N m"),
        Figure("spin_power", "Power into the ground for it, rims at cruise speed", spin.power, "W"),
        Figure("spin_rate", "Yaw rate of it", math.degrees(spin.yaw_rate), "°/s"),
        Figure("width_ratio", "Effective over built track", spin.width_ratio, "", "free-rolling centres of the sides"),
    )
    radii = np.array([turn.forward / turn.yaw_rate for turn in turns])
    powers = np.array([turn.power for turn in turns])
    abscissa = "speed of the inner over that of the outer side"
    curves = (
        Curve("Radius of a slip-steered turn", abscissa, "radius [m]", {"centre of mass": (shares, radii)}),
        Curve("Power into the ground", abscissa, "power [W]", {"all wheels": (shares, powers)}),
    )
    text = "Level ground, low speed. Coulomb friction as large as the side force of the sliding wheel on this soil, "
    return Section("Slip steering", figures, curves, text + "which holds what the wheel pushes aside.")
