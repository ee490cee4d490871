"""Points on the surfaces of collision shapes, evenly spread: what is held against ground that is not flat."""

import math
from typing import Any, NamedTuple

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, IntArray

SPACING = 0.025
"""Between neighbours, at most [m]."""


class SurfacePoints(NamedTuple):
    """Points of the shapes that an arm moves."""

    points: FloatArray  # (p, 3) in the frames of their joints [m]
    shapes: IntArray  # (p,) number of the shape among those that move
    parents: IntArray  # (p,) joint that moves it, counted from 1


def surface_points(objects: Any, moving: tuple[int, ...]) -> SurfacePoints:
    """Points of the `moving` ones among Pinocchio's geometry objects.

    Raises:
        InvalidValueError: a shape that is no box, sphere, cylinder or capsule.
    """
    rows, shapes, parents = [np.zeros((0, 3))], [], []
    for number, index in enumerate(moving):
        shape = objects[index]
        points = _points(shape.geometry) @ np.array(shape.placement.rotation).T + shape.placement.translation
        rows.append(points)
        shapes += [number] * len(points)
        parents += [int(shape.parentJoint)] * len(points)
    return SurfacePoints(
        np.ascontiguousarray(np.vstack(rows)), np.array(shapes, dtype=np.int64), np.array(parents, dtype=np.int64)
    )


def _points(geometry: Any) -> FloatArray:
    kind = type(geometry).__name__
    if kind == "Box":
        return _of_box(np.array(geometry.halfSide))
    if kind == "Sphere":
        return _of_ball(geometry.radius, 0.0)
    if kind == "Capsule":
        return np.vstack(
            [_of_tube(geometry.radius, geometry.halfLength), _of_ball(geometry.radius, geometry.halfLength)]
        )
    if kind == "Cylinder":
        return _of_cylinder(geometry.radius, geometry.halfLength)
    raise InvalidValueError("collision shape", kind, "Box, Sphere, Capsule or Cylinder")


def _line(half: float) -> FloatArray:
    return np.linspace(-half, half, max(2, math.ceil(2.0 * half / SPACING) + 1))


def _ring(radius: float) -> FloatArray:
    angles = np.linspace(0.0, 2.0 * math.pi, max(8, math.ceil(2.0 * math.pi * radius / SPACING)), endpoint=False)
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _of_box(half: FloatArray) -> FloatArray:
    lines = [_line(float(side)) for side in half]
    grid = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)
    return np.asarray(grid[np.any(np.abs(np.abs(grid) - half) < 1e-12, axis=1)])


def _of_tube(radius: float, half: float) -> FloatArray:
    ring = _ring(radius)
    return np.vstack([np.column_stack([ring, np.full(len(ring), z)]) for z in _line(half)])


def _of_cylinder(radius: float, half: float) -> FloatArray:
    inner = np.arange(SPACING, radius, SPACING)
    rings = [np.zeros((1, 2)), *(_ring(float(r)) for r in inner)]
    flat = np.vstack(rings)
    ends = [np.column_stack([flat, np.full(len(flat), z)]) for z in (-half, half)]
    return np.vstack([_of_tube(radius, half), *ends])


def _of_ball(radius: float, apart: float) -> FloatArray:
    """A ball cut in two halves, that are moved `apart` along z both ways."""
    rows = []
    for polar in np.linspace(0.0, math.pi, max(5, math.ceil(math.pi * radius / SPACING) + 1)):
        ring = _ring(max(radius * math.sin(polar), 1e-9))
        z = radius * math.cos(polar)
        rows.append(np.column_stack([ring, np.full(len(ring), z + math.copysign(apart, z))]))
    return np.vstack(rows)
