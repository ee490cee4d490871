"""Shock: what a bump that both tracks meet at cruise speed does to the body, and to equipment on it."""

import math

import numpy as np

from sojourn_analysis.datasheet.figures import Curve, Figure, Section
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.modal.linear_modes import ground_response
from sojourn_analysis.vehicle.ride import acceleration_over, shock_spectrum
from sojourn_machine.params import FloatArray

LENGTH = 8.0
"""Of the bump, over the radius of a wheel: the shortest that counts as longer than its contact."""
HEIGHT = 0.2
"""Of the bump, over the same."""
LINES = 128
"""Frequencies up to the one whose wave is as long as a wheel's diameter."""
FINER = 4
"""Samples within the shortest half period."""
DAMPING = 0.05
"""Of equipment, usual for a shock response spectrum (amplification of 10 at resonance)."""


def shock(subject: Subject) -> Section | None:
    """Of a machine of the plant that drives."""
    plant = subject.driving
    if plant is None:
        return None
    radius = max(axle.wheel_radius for axle in subject.vehicle.axles)
    length, height = LENGTH * radius, HEIGHT * radius
    highest = plant.speed / (2.0 * radius)
    spacing = highest / LINES
    dt = 0.5 / (highest * FINER)
    times = np.arange(round(1.0 / (spacing * dt))) * dt
    inside = times * plant.speed < length
    profile = np.where(inside, 0.5 * height * (1.0 - np.cos(2.0 * math.pi * plant.speed * times / length)), 0.0)
    frequencies: FloatArray = np.arange(1, LINES + 1, dtype=np.float64) * spacing
    base = acceleration_over(profile, ground_response(plant, "z", frequencies))
    natural = np.geomspace(2.0 * spacing, 10.0 * highest, 40)
    spectrum = shock_spectrum(base, dt, natural, DAMPING)
    worst = int(np.argmax(spectrum))
    figures = (
        Figure("bump_height", "Height of the bump", height, "m", "a fifth of a wheel's radius"),
        Figure("bump_length", "Length of it", length, "m", "1 - cos, both tracks"),
        Figure("bump_acceleration", "Greatest acceleration of base_link", float(np.abs(base).max()), "m/s²"),
        Figure("shock", "Greatest acceleration of equipment on it", float(spectrum[worst]), "m/s²"),
        Figure("shock_frequency", "Natural frequency of that equipment", float(natural[worst]), "Hz"),
    )
    line = {f"damping ratio {DAMPING:g}": (natural, spectrum)}
    curve = Curve("Shock response", "natural frequency [Hz]", "greatest acceleration [m/s²]", line, logarithmic=True)
    text = "The plant linearised at cruise speed: wheels keep contact, and waves shorter than a wheel are left out."
    return Section("Shock", figures, (curve,), text)
