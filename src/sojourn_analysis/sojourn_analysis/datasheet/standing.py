"""Standing: masses, wheel loads, tip-over angles, steps."""

import math

import numpy as np
from scipy.spatial import ConvexHull

from sojourn_analysis.datasheet.figures import Curve, Figure, Section
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.vehicle.longitudinal import loads
from sojourn_analysis.vehicle.stability import tip_over_margin
from sojourn_analysis.vehicle.step_climbing import SideView, highest_step, least_friction
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

STEP_FRICTIONS = (0.4, 0.6, 0.7, 0.8, 0.9, 1.0)
FIRM_FRICTION = 0.8
"""Of rock under metal wheels with grousers, for the headline step."""


def general(subject: Subject) -> Section:
    """Sizes and masses."""
    vehicle = subject.vehicle
    figures = [
        Figure("mass", "Mass", vehicle.mass, "kg"),
        Figure("weight", "Weight here", vehicle.mass * subject.gravity, "N"),
        Figure(
            "sunlight", "Sunlight here, above any air", subject.body.solar_flux, "W/m²", "mean distance from the Sun"
        ),
        Figure("wheelbase", "Wheelbase, first to last axle", vehicle.wheelbase, "m"),
        Figure("track", "Track, widest axle", max(axle.track for axle in vehicle.axles), "m"),
        Figure("centre_of_mass_height", "Height of the centre of mass", vehicle.height, "m"),
        Figure("clearance", "Ground clearance", vehicle.clearance, "m"),
        Figure("wheels", "Wheels", 2.0 * len(vehicle.axles), ""),
        Figure("driven_wheels", "Driven wheels", 2.0 * sum(axle.driven for axle in vehicle.axles), ""),
        Figure("wheel_diameter", "Diameter of the front wheels", 2.0 * vehicle.axles[0].wheel_radius, "m"),
        Figure("roll_inertia", "Moment of inertia, roll", vehicle.roll_inertia, "kg m²"),
        Figure("pitch_inertia", "Moment of inertia, pitch", vehicle.pitch_inertia, "kg m²"),
        Figure("yaw_inertia", "Moment of inertia, yaw", vehicle.yaw_inertia, "kg m²"),
    ]
    return Section("Vehicle", tuple(figures))


def standing(subject: Subject) -> Section:
    """Loads of the axles and tip-over angles."""
    vehicle, course = subject.vehicle, subject.course()
    level = loads(course, 0.0)
    figures = [
        Figure(f"load_{axle.name}", f"Load of one wheel, {axle.name} axle", float(load), "N")
        for axle, load in zip(vehicle.axles, level, strict=True)
    ]
    for axle, wheel, load in zip(vehicle.axles, course.wheels, level, strict=True):
        figures.append(
            Figure(
                f"sinkage_{axle.name}",
                f"Sinkage while rolling, {axle.name} axle",
                1000.0 * wheel.forces(float(load), 0.05).sinkage,
                "mm",
                "slip 0.05",
            )
        )
    directions = np.linspace(0.0, 2.0 * math.pi, 181)
    angles = np.degrees(tip_over_angles(subject.places, vehicle.height, directions))
    named = (
        ("forward", "ahead", 0),
        ("left", "to the left", 45),
        ("backward", "behind", 90),
        ("right", "to the right", 135),
    )
    for name, words, i in named:
        figures.append(Figure(f"tip_over_{name}", f"Tip-over angle, downhill is {words}", float(angles[i]), "°"))
    margin = float(
        tip_over_margin(_contacts(subject)[None], np.ones((1, len(subject.places)), bool), _centre(subject))[0]
    )
    figures += [
        Figure("tip_over_least", "Tip-over angle, least of all directions", math.degrees(margin), "°"),
    ]
    grades = np.radians(np.linspace(-30.0, 30.0, 25))
    shares = []
    for grade in grades:
        try:
            shares.append(loads(course, float(grade)))
        except InvalidValueError:  # it has tipped over
            shares.append(np.full(len(vehicle.axles), math.nan))
    lines = {axle.name: (np.degrees(grades), np.array(shares)[:, index]) for index, axle in enumerate(vehicle.axles)}
    curves = (
        Curve("Load of one wheel on a grade", "grade, uphill positive [°]", "load [N]", lines),
        Curve(
            "Tip-over angle by the direction of the slope",
            "direction downhill, from forward to the left [°]",
            "angle [°]",
            {"suspension locked": (np.degrees(directions), angles)},
        ),
    )
    text = "At rest. "
    if vehicle.equalising and subject.machine is not None:
        text += "Loads by virtual work on the machine's joints: the suspension equalises. "
    elif len(vehicle.axles) > 2 and vehicle.axles[0].spring_rate is not None:
        text += "More than two axles on springs: the rates of the springs decide. "
    return Section("Standing", tuple(figures), curves, text + "Tipping with the suspension locked.")


def steps(subject: Subject) -> Section:
    """Highest steps."""
    side = subject.side()
    if side is None:
        return Section("Steps", (Figure("highest_step", "Highest step", None, "m", "no analysis for this suspension"),))
    try:
        least_friction(side, 0.01, subject.gravity)
    except InvalidValueError:
        return Section("Steps", (Figure("highest_step", "Highest step", None, "m", "no analysis for this suspension"),))
    heights = np.array([highest_step(side, friction, subject.gravity, highest=1.0) for friction in STEP_FRICTIONS])
    headline = float(heights[STEP_FRICTIONS.index(FIRM_FRICTION)])
    radius = side.wheels[0].radius
    figures = (
        Figure("highest_step", "Highest step, every wheel in turn", headline, "m", f"friction {FIRM_FRICTION:g}"),
        Figure("step_over_diameter", "The same, in diameters of a wheel", headline / (2.0 * radius), ""),
        Figure(
            "step_friction", "Friction for a step of one wheel diameter", _friction_for_diameter(side, subject.gravity)
        ),
    )
    line = {"all wheels driven": (np.array(STEP_FRICTIONS), heights)}
    curve = Curve("Highest step", "friction coefficient", "height [m]", line)
    text = "Quasi-static, rigid vertical step; motors share the traction as is best. "
    text += "The flat underside of the body is kept clear of the edge, the arms of a suspension are not. "
    text += "The bogies turn within their limits." if side.bogie_mass > 0.0 else "The suspension is taken as locked."
    return Section("Steps", figures, (curve,), text)


def _friction_for_diameter(side: SideView, gravity: float) -> float | str:
    needed = least_friction(side, 2.0 * side.wheels[0].radius, gravity)
    return needed if math.isfinite(needed) else "not climbed"


def tip_over_angles(places: FloatArray, height: float, directions: FloatArray) -> FloatArray:
    """Slope [rad] at which a machine tips over downhill, by direction from x to y [rad], shape (n,).

    Args:
        places: of its contacts, from under its centre of mass, (contacts, 2) [m]. height: of that centre [m].
    """
    hull = ConvexHull(places)
    normals, offsets = hull.equations[:, :2], -hull.equations[:, 2]
    ways = np.column_stack([np.cos(directions), np.sin(directions)])
    speed = ways @ normals.T
    with np.errstate(divide="ignore"):
        distance = np.where(speed > 1e-12, offsets / np.where(speed > 1e-12, speed, 1.0), np.inf).min(axis=1)
    return np.asarray(np.arctan(distance / height))


def _contacts(subject: Subject) -> FloatArray:
    return np.column_stack([subject.places, np.zeros(len(subject.places))])


def _centre(subject: Subject) -> FloatArray:
    return np.array([[0.0, 0.0, subject.vehicle.height]])
