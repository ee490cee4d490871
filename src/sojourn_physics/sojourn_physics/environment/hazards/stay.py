"""What a machine has to bear in a stay on a body: dose, upsets, hits and dust, as rows of a sheet."""

from typing import NamedTuple

from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.hazards.array_dust import PATHFINDER, light_through_dust
from sojourn_physics.environment.hazards.meteoroids import (
    FARTHEST,
    NEAREST,
    chance_of_none,
    flux_at,
    stopped_by_air,
)
from sojourn_physics.environment.hazards.radiation import dose_rate, share_behind
from sojourn_physics.environment.hazards.upsets import MemoryPart, upsets_per_day
from sojourn_physics.environment.sun.moons import RADII

_YEAR = 365.25


class Stay(NamedTuple):
    """How long, and with what."""

    days: float
    """Of the Earth [d]."""
    area: float = 4.0
    """Of the machine's whole surface [m2]."""
    shield: float = 0.0
    """Mass over what is shielded from cosmic rays [g/cm2]."""
    memory: MemoryPart = MemoryPart()
    least_mass: float = 1e-6
    """Of a meteoroid that does harm [g]: 1e-6 is a tenth of a millimetre, and goes through 0.5 mm of aluminium."""


class Row(NamedTuple):
    """One line of a sheet."""

    what: str
    value: str
    source: str


def rows_of_stay(body: BodyParams, stay: Stay) -> list[Row]:
    """Dose, upset rate, hits and dust on arrays expected in a stay on the surface of a body, or in its orbit."""
    return [*_radiation(body, stay), *_hits(body, stay), *_dust(body, stay)]


def _radiation(body: BodyParams, stay: Stay) -> list[Row]:
    rate = dose_rate(body.name, body.surface_pressure)
    if rate is None:
        return [Row("dose", "little under dense air, no figure", "")]
    share = share_behind(stay.shield) if rate.shieldable else 1.0
    behind = f" behind {stay.shield:g} g/cm2" if stay.shield > 0.0 and rate.shieldable else ""
    absorbed, equivalent = rate.absorbed * share, rate.equivalent * share
    upsets = upsets_per_day(stay.memory, absorbed)
    return [
        Row("absorbed dose", f"{1e-3 * absorbed * stay.days:.4g} mGy in {stay.days:g} d{behind}", rate.source),
        Row("dose equivalent", f"{1e-3 * equivalent:.4g} mSv/d, {1e-3 * equivalent * stay.days:.4g} mSv", rate.source),
        Row(
            "upsets of memory",
            f"{upsets:.3g} a day, {upsets * stay.days:.3g} in {stay.memory.bits:.2g} bits",
            "Petersen 1998, by the dose" if rate.shieldable else "Petersen 1998: of ions, here an upper bound",
        ),
    ]


def _hits(body: BodyParams, stay: Stay) -> list[Row]:
    what = f"meteoroids of {stay.least_mass:g} g or more"
    if stopped_by_air(body.surface_pressure):
        return [Row(what, "none: the air stops them", "")]
    if not NEAREST <= body.semi_major_axis_au <= FARTHEST:
        return [Row(what, f"no figure beyond {NEAREST:g} to {FARTHEST:g} au", "")]
    radius = RADII["earth"] if body.free_fall else body.radius
    flux = flux_at(stay.least_mass, body.gravitational_parameter, radius, body.radius, body.semi_major_axis_au)
    hits = flux * stay.area * stay.days / _YEAR
    value = f"{hits:.3g} hits on {stay.area:g} m2, none with a chance of {chance_of_none(hits):.3f}"
    return [Row(what, value, "Gruen et al. 1985")]


def _dust(body: BodyParams, stay: Stay) -> list[Row]:
    if body.name != "mars":
        return []
    left = light_through_dust(stay.days * 86400.0 / body.solar_day)
    return [Row("light through dust on arrays", f"{100.0 * left:.1f} % at {100.0 * PATHFINDER:g} %/sol", "Landis 2000")]
