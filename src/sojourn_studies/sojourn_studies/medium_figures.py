"""What is to be said of the space between the planets and between the stars: the work of scripts/site space."""

import argparse
import json
import math
from collections.abc import Iterator

from sojourn_config.command_errors import UsageError
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.environment.space_medium import DOSE_A_DAY, HELIOPAUSE, medium_at
from sojourn_studies.site_figures import SheetRow


def rows_of_medium(distance: float, days: float) -> Iterator[SheetRow]:
    """At a distance from the Sun [AU], for a stay of days. Raises InvalidValueError as `medium_at` does."""
    medium = medium_at(distance)
    between_stars = distance > HELIOPAUSE
    yield SheetRow("sunlight", medium.light, "W/m2")
    yield SheetRow("pressure of light on a mirror", medium.light_pressure, "Pa")
    yield SheetRow("temperature of a grey ball", medium.grey_temperature, "K")
    yield SheetRow(
        "hydrogen between the stars" if between_stars else "protons of the solar wind", medium.particles, "1/m3"
    )
    yield SheetRow("their speed past a machine at rest", medium.speed, "m/s")
    yield SheetRow("their pressure", medium.wind_pressure, "Pa")
    yield SheetRow("magnetic field", medium.magnetic_field * 1e9, "nT")
    if not between_stars:
        yield SheetRow("its angle to the direction from the Sun", math.degrees(medium.spiral), "deg")
        yield SheetRow("cosmic rays behind a spacecraft's walls", DOSE_A_DAY * 1e3, "mSv/d")
        yield SheetRow(f"in {days:g} days", DOSE_A_DAY * 1e3 * days, "mSv")


def run(given: argparse.Namespace) -> int:
    """Print the sheet of the distance that the options name.

    Raises:
        UsageError: a distance out of range; a place, an orbit or a date of it.
    """
    if given.orbit or given.lat or given.lon or given.altitude or given.time is not None or given.plot is not None:
        raise UsageError("site: space has no place, orbit, date or plot: allowed are --distance, --days and --json")
    try:
        rows = list(rows_of_medium(given.distance, given.days))
    except InvalidValueError as error:
        raise UsageError(f"site: --distance: {error}") from error
    if given.json:
        print(json.dumps({"space": {row.name: row.value for row in rows}}, indent=1))
        return 0
    where = "between the stars" if given.distance > HELIOPAUSE else "between the planets"
    print(f"space {where}, {given.distance:g} astronomical units from the Sun; means, which the Sun changes by factors")
    width = max(len(row.name) for row in rows)
    for row in rows:
        print(f"  {row.name.ljust(width)}  {row.value:.4g} {row.unit}")
    return 0
