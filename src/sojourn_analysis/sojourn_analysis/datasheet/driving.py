"""Driving straight: traction, grade, speed, energy, motors, braking."""

import math
from dataclasses import replace

import numpy as np

from sojourn_analysis.datasheet.figures import Curve, Figure, Section
from sojourn_analysis.datasheet.subject import OWN, Subject
from sojourn_analysis.vehicle.braking import stopping_distance
from sojourn_analysis.vehicle.driveline import largest_wheel_torque
from sojourn_analysis.vehicle.law_wheel import LawWheel
from sojourn_analysis.vehicle.longitudinal import (
    Course,
    SteadyState,
    driving_range,
    greatest_grade,
    greatest_pull,
    greatest_speed,
    loads,
    steady_state,
    time_and_distance_to,
    total_pull,
)
from sojourn_analysis.vehicle.multi_pass import FollowingWheel, passes, sinkage_after
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

SLIPS = np.linspace(0.0, 0.8, 33)
SLOW = 0.2
"""Part of the greatest speed at which the greatest grade is told: crawling."""


def traction(subject: Subject) -> Section:
    """Pull, torque and sinkage of the front wheel against slip."""
    course = subject.course()
    pull, slip = greatest_pull(course, 0.0)
    weight = subject.vehicle.mass * subject.gravity
    load = float(loads(course, 0.0)[0])
    forces = [course.wheels[0].forces(load, float(s)) for s in SLIPS]
    curves = [
        Curve(
            "Pull of one front wheel",
            "slip",
            "force [N]",
            {
                "drawbar pull": (SLIPS, np.array([force.pull for force in forces])),
                "torque over radius": (SLIPS, np.array([force.torque for force in forces]) / course.wheels[0].radius),
            },
        )
    ]
    self_propelled = steady_state(course, subject.vehicle.cruise_speed)
    figures = (
        Figure("greatest_pull", "Greatest drawbar pull, level", pull, "N", f"slip {slip:.2f}"),
        Figure("pull_coefficient", "The same over the weight", pull / weight, ""),
        Figure("level_slip", "Slip on the level", None if self_propelled is None else self_propelled.slip, ""),
        Figure("towing_resistance", "Resistance at slip 0", -total_pull(course, 0.0, 0.0, 0.0), "N"),
    )
    text = f"Soil {subject.soil.name} on {subject.body.name}, law of the wheels: {subject.law}."
    if subject.law != OWN:
        text += " Wheels are taken as rigid."
    return Section("Traction", figures, tuple(curves), text)


def performance(subject: Subject) -> Section:
    """Speed, grade, acceleration, braking, motors."""
    course = subject.course()
    fastest = greatest_speed(course)
    if fastest <= 0.0:
        note = "the motors or the ground do not move it"
        speed = Figure("greatest_speed", "Greatest speed, level", 0.0, "km/h", note)
        return Section("Performance", (speed, Figure("greatest_grade", "Greatest grade", None, "°", note)))
    slow = SLOW * fastest
    grade, limit = greatest_grade(course, slow)
    reference = 0.8 * fastest
    time, distance = time_and_distance_to(course, reference, points=10)
    deceleration = braking_deceleration(course)
    figures = (
        Figure("greatest_speed", "Greatest speed, level", 3.6 * fastest, "km/h", "full voltage"),
        Figure(
            "greatest_grade", f"Greatest grade, at {3.6 * slow:.2g} km/h", math.degrees(grade), "°", f"limit: {limit}"
        ),
        Figure("acceleration_time", f"From rest to {3.6 * reference:.3g} km/h", time, "s"),
        Figure("acceleration_distance", "Distance of that", distance, "m"),
        Figure("braking_deceleration", "Greatest deceleration, wheels not locked", deceleration, "m/s²"),
        Figure(
            "stopping_distance",
            f"Stopping distance from {3.6 * reference:.3g} km/h",
            stopping_distance(reference, deceleration) if deceleration > 0.0 else None,
            "m",
            "no reaction time",
        ),
    )
    speeds = np.linspace(0.05, 0.98, 14) * fastest
    grades = np.degrees([greatest_grade(course, float(speed))[0] for speed in speeds])
    return Section("Performance", figures, (_grade_curve(speeds, grades), _motor_curve(subject, course, fastest)))


def energy(subject: Subject) -> Section:
    """Energy and range."""
    course, vehicle = subject.course(), subject.vehicle
    cruise = vehicle.cruise_speed
    state = steady_state(course, cruise)
    figures = [Figure("cruise_speed", "Cruise speed", 3.6 * cruise, "km/h")]
    if state is None or not state.feasible:
        note = "cruise speed is not reached on this ground"
        figures.append(Figure("energy_per_km", "Energy at cruise, level", None, "Wh/km", note))
        figures.append(Figure("greatest_range", "Range at cruise, level", None, "km", note))
        return Section("Energy", tuple(figures))
    figures += [
        Figure("energy_per_km", "Energy at cruise, level", state.energy_per_metre / 3.6, "Wh/km"),
        Figure("bus_power", "Power from the bus at cruise", state.bus_power, "W"),
        Figure("drive_power", "Of that, drives", state.drive_power, "W"),
        Figure("house_power", "Of that, all else", vehicle.house_power, "W"),
        Figure("motor_efficiency", "Efficiency of a motor at cruise", state.motors[0].efficiency, ""),
        Figure("motor_current", "Current of a motor at cruise", state.motors[0].current, "A"),
        Figure("greatest_range", "Range at cruise, level", driving_range(course, cruise) / 1000.0, "km"),
    ]
    for law in subject.laws:
        if law != subject.law:
            value = _energy_per_km(subject.course(law), cruise)
            key = "energy_per_km_" + law.replace(" ", "_")
            figures.append(Figure(key, f"Energy at cruise, level, law: {law}", value, "Wh/km"))
    top = greatest_speed(course)
    speeds = np.linspace(0.1, 0.98, 16) * top
    lines = {}
    for degrees in (0.0, 5.0, 10.0):
        states = [steady_state(course, float(speed), math.radians(degrees)) for speed in speeds]
        values = [math.nan if s is None or not s.feasible else s.energy_per_metre / 3.6 for s in states]
        lines[f"{degrees:g}° up"] = (3.6 * speeds, np.array(values))
    points = {"cruise": (3.6 * cruise, state.energy_per_metre / 3.6)}
    curve = Curve("Energy of the bus", "speed [km/h]", "energy [Wh/km]", lines, points)
    text = (
        f"Gear efficiency {vehicle.gear.efficiency:g}, controller {vehicle.controller_efficiency:g}; nothing is tuned."
    )
    return Section("Energy", tuple(figures), (curve,), text)


def traverses(subject: Subject) -> Section | None:
    """Charge that drives take, at their mean speed on level ground; halts are left out."""
    vehicle, figures = subject.vehicle, []
    for drive in vehicle.traverses:
        speed = drive.distance_km / drive.hours / 3.6
        charge, note = None, "its mean speed is not reached on this ground"
        state = steady_state(subject.course(), speed)
        if state is not None and state.feasible:
            charge = state.bus_power * drive.hours / vehicle.bus_voltage
            note = f"{drive.distance_km:g} km at {3.6 * speed:.3g} km/h, {charge / drive.distance_km:.3g} Ah/km"
        figures.append(Figure(f"charge_{drive.name}", f"Charge of {drive.label}", charge, "Ah", note))
    text = f"Mean speed, level ground, {vehicle.bus_voltage:g} V; no grades, obstacles, starts and halts."
    return Section("Traverses", tuple(figures), (), text) if figures else None


def ruts(subject: Subject) -> Section:
    """What rear wheels spare in the ruts of the front ones."""
    try:
        return _ruts(subject)
    except InvalidValueError as error:
        return Section("Ruts", (Figure("rut_depth", "Depth of the ruts", None, "mm", f"not told: {error}"),))


def _ruts(subject: Subject) -> Section:
    course, cruise = subject.course_in_ruts(), subject.vehicle.cruise_speed
    following = [number for number, wheel in enumerate(course.wheels) if isinstance(wheel, FollowingWheel)]
    if not subject.on_soil or not following or subject.soil.kind == "rigid":
        note = "no wheel follows in the track of another" if not following else "its wheels do not sink in"
        return Section("Ruts", (Figure("rut_depth", "Depth of the ruts", None, "mm", note),))
    fresh = steady_state(subject.course(OWN), cruise)
    state = steady_state(course, cruise)
    front = LawWheel(subject.vehicle.axles[0].wheel, subject.soil, subject.gravity)
    load = float(loads(course, 0.0)[0])
    slip = fresh.slip if fresh is not None else 0.2
    count = len(subject.vehicle.axles)
    forces, depths = passes(front, load, slip, count + 1)
    figures = [
        Figure("rut_depth", "Rut behind the front wheel", 1000.0 * float(depths[1]), "mm", f"slip {slip:.2f}"),
        Figure("rut_depth_last", f"Rut behind {count} such wheels", 1000.0 * float(depths[-1]), "mm"),
        *(
            Figure(f"compaction_pass_{number}", f"Compaction resistance, pass {number}", force.compaction, "N")
            for number, force in enumerate(forces[:count], 1)
        ),
        Figure(
            "level_slip_fresh", "Slip on the level, every wheel on fresh soil", None if fresh is None else fresh.slip
        ),
        Figure("level_slip_in_ruts", "Slip on the level, rear wheels in ruts", None if state is None else state.slip),
        Figure("energy_per_km_fresh", "Energy at cruise, all wheels on fresh soil", _per_km(fresh), "Wh/km"),
        Figure("energy_per_km_in_ruts", "Energy at cruise, rear wheels in ruts", _per_km(state), "Wh/km"),
    ]
    if OWN in subject.laws:
        value = _energy_per_km(subject.course_in_ruts(rigid=True), cruise)
        label = "The same, if its wheels were rigid"
        figures.append(Figure("energy_per_km_rigid_in_ruts", label, value, "Wh/km"))
    lines = {}
    for number in range(count):
        wheel = replace(front, greatest=_greatest(front, load, slip, number))
        lines[f"pass {number + 1}"] = (SLIPS, np.array([wheel.forces(load, float(s)).pull for s in SLIPS]))
    curve = Curve("Pull of a front wheel, by pass", "slip", "drawbar pull [N]", lines)
    text = "Contact model and memory of the plant: soil that has been pressed before springs back, and is virgin below."
    return Section("Ruts", tuple(figures), (curve,), text)


def _greatest(wheel: LawWheel, load: float, slip: float, count: int) -> float:
    """Sinkage that a number of passes have reached [m]."""
    for _ in range(count):
        wheel = replace(wheel, greatest=sinkage_after(wheel, load, slip))
    return wheel.greatest


def _energy_per_km(course: Course, cruise: float) -> float | None:
    try:
        return _per_km(steady_state(course, cruise))
    except InvalidValueError:  # the soil does not carry the wheels
        return None


def _per_km(state: SteadyState | None) -> float | None:
    return None if state is None or not state.feasible else state.energy_per_metre / 3.6


def braking_deceleration(course: Course) -> float:
    """Greatest deceleration for which all wheels hold at a slip of -0.3, level ground [m/s^2]."""
    low, high = 0.0, 2.0 * course.gravity
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        try:
            holds = -total_pull(course, 0.0, -0.3, 0.0, -middle) >= course.vehicle.mass * middle
        except InvalidValueError:  # it tips over forward
            holds = False
        low, high = (middle, high) if holds else (low, middle)
    return low


def _grade_curve(speeds: FloatArray, grades: FloatArray) -> Curve:
    return Curve("Greatest grade by speed", "speed [km/h]", "grade [°]", {"motors and ground": (3.6 * speeds, grades)})


def _motor_curve(subject: Subject, course: Course, fastest: float) -> Curve:
    """Torque of one wheel's motor over its rate: envelope and working points."""
    vehicle = subject.vehicle
    radius = vehicle.axles[0].wheel_radius
    rates = np.linspace(0.0, 1.25 * fastest / radius, 40)
    torques = np.array([max(largest_wheel_torque(vehicle, float(rate)), 0.0) for rate in rates])
    points = {}
    cruise = vehicle.cruise_speed
    for degrees in (0.0, 5.0, 10.0, 15.0):
        state = steady_state(course, cruise, math.radians(degrees))
        if state is not None and state.feasible:
            torque = max(force.torque for force in state.wheels)
            points["level" if degrees == 0.0 else f"{degrees:g}° up"] = (state.wheel_rate, torque)
    line = {"full voltage and current": (rates, torques)}
    return Curve(
        "Torque of one wheel, working points at cruise speed", "wheel rate [rad/s]", "torque [N m]", line, points
    )
