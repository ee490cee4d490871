"""Picture of a place: the Sun, its light and the ground's warmth over a day, gravity by latitude, the air over it."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sojourn_config.command_errors import UsageError
from sojourn_physics.environment.site import site_frame
from sojourn_studies.site_figures import SheetPlace, on_level

LATITUDES = np.linspace(-90.0, 90.0, 73)
HIGHEST = 100e3
"""Of the air that is drawn [m]."""


def draw(path: Path, place: SheetPlace) -> None:
    """Draw a place.

    Raises:
        UsageError: the file cannot be written.
    """
    figure = Figure(figsize=(15.0, 7.5), layout="constrained")
    FigureCanvasAgg(figure)
    (sun, light, warmth), (weight, air, unused) = figure.subplots(2, 3)
    unused.set_axis_off()
    site = place.site
    figure.suptitle(f"{place.body.name}, {site.latitude_deg:g}° N, {site.longitude_deg:g}° E, {site.altitude_m:g} m")
    _sun(sun, light, place)
    _warmth(warmth, place)
    _weight(weight, place)
    _air(air, place)
    try:
        figure.savefig(path, dpi=110)
    except (OSError, ValueError) as error:
        raise UsageError(f"--plot {path}: {error}") from error


def _sun(sun: Axes, light: Axes, place: SheetPlace) -> None:
    sun.set(title="the Sun over the horizon", xlabel="hours from the date", ylabel="elevation [deg]")
    light.set(title="sunlight", xlabel="hours from the date", ylabel="W/m²")
    if not place.lights:
        for axis in (sun, light):
            axis.text(0.5, 0.5, "with --time", transform=axis.transAxes, ha="center", color="0.5")
        return
    hours = place.hours
    sun.plot(hours, [math.degrees(one.elevation) for one in place.lights], color="tab:orange")
    sun.axhline(0.0, color="0.4", linewidth=0.8)
    light.plot(hours, [one.direct for one in place.lights], color="tab:orange", label="beam, on a surface square to it")
    light.plot(hours, [one.diffuse for one in place.lights], color="tab:blue", label="sky, on the level")
    light.plot(hours, [on_level(one) for one in place.lights], color="0.2", linestyle="--", label="both, on the level")
    light.legend(fontsize=8)
    for axis in (sun, light):
        axis.set_xlim(0.0, float(hours[-1]))


def _warmth(axis: Axes, place: SheetPlace) -> None:
    axis.set(title="the ground's surface", xlabel="hours from the date", ylabel="temperature [K]")
    if place.ground is None:
        why = "with --time" if place.body.regolith is not None else "not known"
        axis.text(0.5, 0.5, why, transform=axis.transAxes, ha="center", color="0.5")
        return
    axis.plot(place.hours, place.ground, color="tab:red")
    axis.set_xlim(0.0, float(place.hours[-1]))


def _weight(axis: Axes, place: SheetPlace) -> None:
    axis.set(title="gravity along the meridian", xlabel="latitude [deg]", ylabel="m/s²", xlim=(-90.0, 90.0))
    sites = [place.site.model_copy(update={"latitude_deg": float(latitude)}) for latitude in LATITUDES]
    fields = [replace(place.field, frame=site_frame(site, place.body.semi_axes)) for site in sites]
    axis.plot(LATITUDES, [field.gravity for field in fields], color="tab:green")
    axis.axhline(place.body.surface_gravity, color="0.6", linestyle=":", label="mean of the body, GM/R²")
    axis.plot([place.site.latitude_deg], [place.field.gravity], "o", color="tab:red", label="here")
    axis.legend(fontsize=8)


def _air(axis: Axes, place: SheetPlace) -> None:
    axis.set(title="air", xlabel="temperature [K]", ylabel="altitude [km]")
    atmosphere = place.body.atmosphere
    if atmosphere is None:
        axis.text(0.5, 0.5, "none", transform=axis.transAxes, ha="center", color="0.5")
        return
    low, high = atmosphere.altitudes
    heights = np.linspace(low, min(high, HIGHEST), 200)
    states = [atmosphere.at(float(height)) for height in heights]
    axis.plot([state.temperature for state in states], heights / 1e3, color="tab:red")
    axis.tick_params(axis="x", labelcolor="tab:red")
    other = axis.twiny()
    other.semilogx([state.pressure for state in states], heights / 1e3, color="tab:blue")
    other.set_xlabel("pressure [Pa]", color="tab:blue")
    other.tick_params(axis="x", labelcolor="tab:blue")
    axis.axhline(place.site.altitude_m / 1e3, color="0.5", linestyle=":")
