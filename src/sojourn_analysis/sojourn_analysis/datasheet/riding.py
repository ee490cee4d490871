"""Riding: suspension modes, nulls of the wheelbase, ride over rough ground."""

import math

import numpy as np

from sojourn_analysis.datasheet.figures import Curve, Figure, Section
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.modal.linear_modes import ground_response
from sojourn_analysis.modal.linearise import LinearPlant
from sojourn_analysis.vehicle.body_motion import (
    ElasticAxle,
    first_nulls,
    heave_and_pitch_modes,
    response_to_ground,
    roll_motion,
)
from sojourn_analysis.vehicle.ground_roughness import Roughness, iso_8608, lunar
from sojourn_analysis.vehicle.quarter_car import (
    QuarterCar,
    damping_ratio,
    fixed_point,
    optimum_damping,
    responses,
    undamped_modes,
)
from sojourn_analysis.vehicle.ride import comfort, weighted_acceleration
from sojourn_machine.params import FloatArray

FREQUENCIES = np.geomspace(0.1, 40.0, 800)
SLOW_FREQUENCIES = np.linspace(0.02, 4.0, 400)
PLANT_TEXT = (
    "Of base_link: the plant linearised while it drives, with springs, dampers, links, wheels and soil as they are, "
    "for waves longer than a wheel."
)


def riding(subject: Subject) -> Section:
    """Of the front wheels' quarter cars and of the body."""
    vehicle = subject.vehicle
    front = vehicle.axles[0]
    cruise = vehicle.cruise_speed
    bounce, pitch = first_nulls(vehicle.wheelbase, cruise)
    nulls = (
        Figure("bounce_null", "First frequency without bounce at cruise", bounce, "Hz", "from the wheelbase"),
        Figure("pitch_null", "First frequency without pitch at cruise", pitch, "Hz", "from the wheelbase"),
    )
    of_plant: tuple[Figure, ...] = ()
    curves_of_plant: tuple[Curve, ...] = ()
    if subject.driving is not None and subject.machine is not None and subject.machine.sprung:
        of_plant, curves_of_plant = _riding_of_plant(subject, subject.driving)
    if of_plant and (front.spring_rate is None or front.tyre_rate is None):
        return Section("Ride", (*nulls, *of_plant), curves_of_plant, PLANT_TEXT)
    if front.spring_rate is None or front.tyre_rate is None:
        figure = Figure(
            "natural_frequency", "Natural frequency", None, "Hz", "no springs: the suspension is rigid or equalises"
        )
        return Section("Ride", (figure, *nulls))
    sprung = vehicle.mass - 2.0 * sum(axle.unsprung_mass for axle in vehicle.axles)
    # the front axle's part of the sprung mass, by its static load
    share = abs(vehicle.axles[-1].x) / vehicle.wheelbase
    car = QuarterCar(0.5 * share * sprung, front.spring_rate, front.damping, front.tyre_rate, front.unsprung_mass)
    body, wheel = undamped_modes(car)
    axles = [
        ElasticAxle(axle.x, 2.0 * (axle.spring_rate or 0.0), 2.0 * axle.damping, axle.track) for axle in vehicle.axles
    ]
    modes = heave_and_pitch_modes(sprung, vehicle.pitch_inertia, axles)
    roll = roll_motion(sprung, vehicle.roll_inertia, 0.5 * vehicle.height, subject.gravity, axles)
    grounds = _grounds(subject)
    speeds = np.linspace(0.2, 1.6, 15) * cruise
    lines, figures = {}, []
    for name, ground in grounds.items():
        values = np.array([_weighted(car, ground, float(speed)) for speed in speeds])
        lines[name] = (3.6 * speeds, values)
        value = _weighted(car, ground, cruise)
        key = "ride_" + name.replace(" ", "_").lower()
        figures.append(Figure(key, f"Weighted vertical acceleration at cruise, {name}", value, "m/s²", comfort(value)))
    first = next(iter(grounds.values()))
    acceleration = np.abs(responses(car, FREQUENCIES).acceleration) ** 2 * first.at_speed(cruise, FREQUENCIES)
    motion = np.abs(response_to_ground(sprung, vehicle.pitch_inertia, axles, cruise, SLOW_FREQUENCIES))
    moved = {
        "bounce": (SLOW_FREQUENCIES, motion[:, 0]),
        "pitch, at half the wheelbase": (SLOW_FREQUENCIES, 0.5 * vehicle.wheelbase * motion[:, 1]),
    }
    curves = (
        Curve("Body on its axles over the ground, at cruise", "frequency [Hz]", "ratio", moved),
        Curve("Weighted vertical acceleration (ISO 2631-1)", "speed [km/h]", "RMS [m/s²]", lines),
        Curve(
            f"Spectrum of the body's acceleration at cruise, {next(iter(grounds))}",
            "frequency [Hz]",
            "power spectral density [(m/s²)²/Hz]",
            {"front quarter": (FREQUENCIES, acceleration)},
            logarithmic=True,
        ),
    )
    head = (
        Figure("natural_frequency", "Natural frequency, body on front springs", float(body), "Hz"),
        Figure("wheel_hop", "Natural frequency, front wheel", float(wheel), "Hz"),
        Figure("damping_ratio", "Damping ratio, front", damping_ratio(car), ""),
        Figure("optimum_damping", "Optimum damping, front", optimum_damping(car.sprung, car.spring, car.tyre), "N s/m"),
        Figure(
            "fixed_point",
            "Frequency whose answer no damping changes, front",
            (still := fixed_point(car.sprung, car.spring, car.tyre))[0],
            "Hz",
            f"body over ground {still[1]:.2f}",
        ),
        *(
            Figure(
                f"mode_{number}",
                f"{'Pitch' if abs(mode.centre) < 0.5 * vehicle.wheelbase else 'Bounce'} of the body",
                mode.frequency,
                "Hz",
                f"damping ratio {mode.damping:.2f}",
            )
            for number, mode in enumerate(modes, 1)
        ),
        Figure("roll_frequency", "Roll of the body", roll.frequency, "Hz", f"damping ratio {roll.damping:.2f}"),
        Figure("roll_angle", "Roll angle at a lateral acceleration of 0.3 g", _roll(subject, roll.flexibility), "°"),
    )
    text = "Linear quarter car, wheels in contact. The ISO words of comfort are for people on Earth. Lunar spectra are "
    text += "extrapolated from slopes at 17 m: craters and rocks come on top."
    if of_plant:
        text += " " + PLANT_TEXT
    return Section("Ride", (*head, *nulls, *figures, *of_plant), (*curves, *curves_of_plant), text)


def _riding_of_plant(subject: Subject, plant: LinearPlant) -> tuple[tuple[Figure, ...], tuple[Curve, ...]]:
    """Of the whole machine, driving at cruise speed, both tracks alike; its modes are with the suspension."""
    longest = plant.speed / (2.0 * subject.vehicle.axles[0].wheel_radius)
    frequencies = FREQUENCIES[longest > FREQUENCIES]
    heave = np.abs(ground_response(plant, "z", frequencies))
    figures, lines = [], {}
    for name, ground in _grounds(subject).items():
        spectrum = ground.at_speed(plant.speed, frequencies)
        value = weighted_acceleration(frequencies, heave, spectrum)
        lines[name] = (frequencies, heave**2 * spectrum)
        key = "ride_plant_" + name.replace(" ", "_").lower()
        figures.append(Figure(key, f"Weighted acceleration of base_link, {name}", value, "m/s²", comfort(value)))
    title = "Spectrum of base_link's vertical acceleration at cruise, plant"
    label = "power spectral density [(m/s²)²/Hz]"
    return tuple(figures), (Curve(title, "frequency [Hz]", label, lines, logarithmic=True),)


def _grounds(subject: Subject) -> dict[str, Roughness]:
    if subject.body.name == "moon":
        return {"lunar maria": lunar("maria"), "lunar highlands": lunar("highlands"), "ISO 8608 class E": iso_8608("E")}
    return {f"ISO 8608 class {name}": iso_8608(name) for name in "DEF"}


def _weighted(car: QuarterCar, ground: Roughness, speed: float) -> float:
    spectrum: FloatArray = ground.at_speed(speed, FREQUENCIES)
    return weighted_acceleration(FREQUENCIES, responses(car, FREQUENCIES).acceleration, spectrum)


def _roll(subject: Subject, flexibility: float) -> float:
    return math.degrees(flexibility * 0.3 * subject.gravity)
