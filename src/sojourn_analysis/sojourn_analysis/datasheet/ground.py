"""Footing: how hard the wheels press at rest, how deep they stand, and how far the soil is from failing under them."""

import math

from sojourn_analysis.datasheet.figures import Figure, Section
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.soil.footing import mean_ground_pressure, static_wheel_sinkage, ultimate_pressure
from sojourn_analysis.vehicle.longitudinal import loads
from sojourn_machine.errors import InvalidValueError


def footing(subject: Subject) -> Section | None:
    """Of every axle's wheels, taken as rigid; None on rock."""
    if subject.soil.kind == "rigid":
        return None
    figures: list[Figure] = []
    for axle, load in zip(subject.vehicle.axles, loads(subject.course(), 0.0), strict=True):
        radius, width, name = axle.rim_radius, axle.wheel_width, axle.name
        try:
            sinkage = static_wheel_sinkage(subject.soil, float(load), radius, width)
        except InvalidValueError as error:
            figures.append(Figure(f"static_sinkage_{name}", f"Sinkage at rest, {name} axle", None, "mm", str(error)))
            continue
        pressure = mean_ground_pressure(0.5 * float(load), radius, width, sinkage)
        length = 2.0 * math.sqrt(sinkage * (2.0 * radius - sinkage))
        surcharge = subject.soil.unit_weight(subject.gravity) * sinkage
        fails = ultimate_pressure(subject.soil, min(width, length), subject.gravity, "strip", surcharge)
        figures += [
            Figure(f"static_sinkage_{name}", f"Sinkage at rest, {name} axle", 1000.0 * sinkage, "mm"),
            Figure(f"ground_pressure_{name}", f"Mean ground pressure, {name} axle", pressure / 1000.0, "kPa"),
            Figure(f"bearing_safety_{name}", f"Soil's strength over it, {name} axle", fails / pressure, "", "Terzaghi"),
        ]
    text = f"Rigid wheels at rest on {subject.soil.name}, level. The soil fails under a strip as wide as the smaller "
    return Section("Footing", tuple(figures), (), text + "side of the contact. More of the soil itself: soil_test.")
