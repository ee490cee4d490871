"""Ramps, steps, trenches, side slopes and soil patches on the nodes of a ground.

All of them are products of trapezoids in the feature's own frame, s along its heading and t across, to the left:

    T(s; a, b, p, q) = 0 before a - p, rising to 1 at a, 1 to b, falling to 0 at b + q

with flanks p, q of 0 for an upright wall, which a bilinear ground then has one cell wide.
"""

import math

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.terrain.feature_params import (
    FeatureParams,
    PlacedParams,
    RampParams,
    SideSlopeParams,
    SoilPatchParams,
    StepParams,
    TrenchParams,
)
from sojourn_physics.terrain.height_field import SoilArray

ROUNDING = 1e-9
"""An edge holds the nodes that lie on it up to the rounding of their positions [m]."""


def trapezoid(s: FloatArray, first: float, last: float, before: float = 0.0, after: float = 0.0) -> FloatArray:
    """T(s; first, last, before, after) [-]."""
    rise = (s - first + before) / before if before > 0.0 else np.where(s >= first - ROUNDING, 1.0, 0.0)
    fall = (last + after - s) / after if after > 0.0 else np.where(s <= last + ROUNDING, 1.0, 0.0)
    return np.clip(np.minimum(rise, fall), 0.0, 1.0)


def feature_height(feature: FeatureParams, s: FloatArray, t: FloatArray) -> FloatArray:
    """What a feature adds to the ground [m] at s along its heading from (x, y) and t to the left of it [m]."""
    half = 0.5 * feature.width
    if isinstance(feature, RampParams):
        top = feature.length + feature.plateau
        descent = feature.length if feature.descent is None else feature.descent
        along = trapezoid(s, feature.length, top, feature.length, descent)
        return np.asarray(feature.height * along * trapezoid(t, -half, half))
    if isinstance(feature, StepParams):
        return np.asarray(feature.height * trapezoid(s, 0.0, feature.length) * trapezoid(t, -half, half))
    if isinstance(feature, TrenchParams):
        flank = feature.depth / math.tan(math.radians(feature.wall_deg)) if feature.wall_deg < 90.0 else 0.0
        end = 0.5 * feature.length
        along, across = trapezoid(s, -end, end, flank, flank), trapezoid(t, -half, half, flank, flank)
        return np.asarray(-feature.depth * along * across)
    top_height = feature.width * math.tan(math.radians(abs(feature.slope_deg)))
    blend = feature.blend
    along = trapezoid(s, blend, feature.length - blend, blend, blend)
    uphill = t if feature.slope_deg > 0.0 else -t
    return np.asarray(top_height * along * trapezoid(uphill, half, half, feature.width, feature.width))


def _reach(feature: PlacedParams) -> float:
    """Radius about (x, y) beyond which a feature changes nothing [m]."""
    along, across = feature.length, feature.width
    if isinstance(feature, RampParams):
        along += feature.plateau + (feature.length if feature.descent is None else feature.descent)
    elif isinstance(feature, TrenchParams):
        flank = feature.depth / math.tan(math.radians(feature.wall_deg))
        along, across = along + flank, across + flank
    elif isinstance(feature, SideSlopeParams):
        across *= 2.0
    return math.hypot(along, across)


def _window(
    feature: PlacedParams, shape: tuple[int, int], origin: tuple[float, float], resolution: float
) -> tuple[tuple[slice, slice], FloatArray, FloatArray]:
    """Part of a grid that a feature can reach, with s and t of its nodes [m]."""
    reach = _reach(feature) + resolution
    slices, offsets = [], []
    for centre, start, count in ((feature.y, origin[1], shape[0]), (feature.x, origin[0], shape[1])):
        first = min(max(0, math.floor((centre - reach - start) / resolution)), count)
        last = max(min(count, math.ceil((centre + reach - start) / resolution) + 1), first)
        slices.append(slice(first, last))
        offsets.append(start + resolution * np.arange(first, last) - centre)
    dy, dx = offsets[0][:, np.newaxis], offsets[1][np.newaxis, :]
    cosine, sine = math.cos(math.radians(feature.heading_deg)), math.sin(math.radians(feature.heading_deg))
    return (slices[0], slices[1]), cosine * dx + sine * dy, cosine * dy - sine * dx


def add_features(
    heights: FloatArray, origin: tuple[float, float], resolution: float, features: tuple[FeatureParams, ...]
) -> None:
    """Add the features to heights, shape (ny, nx) [m], in place."""
    for feature in features:
        window, s, t = _window(feature, heights.shape, origin, resolution)
        heights[window] += feature_height(feature, s, t)


def lay_patches(
    soil_index: SoilArray,
    origin: tuple[float, float],
    resolution: float,
    patches: tuple[SoilPatchParams, ...],
    soil_names: tuple[str, ...],
) -> None:
    """Write the indices of the patches' soils into soil_index, shape (ny, nx), in place."""
    for patch in patches:
        window, s, t = _window(patch, soil_index.shape, origin, resolution)
        along, across = s / (0.5 * patch.length), t / (0.5 * patch.width)
        if patch.shape == "ellipse":
            covered = along * along + across * across <= 1.0
        else:
            covered = (abs(along) <= 1.0 + ROUNDING) & (abs(across) <= 1.0 + ROUNDING)
        soil_index[window][covered] = soil_names.index(patch.soil)
