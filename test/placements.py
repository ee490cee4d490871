"""Geometry of a machine from where its wheels are."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams, WheelGeometry


def geometry_from_placements(
    names: Sequence[str],
    positions: ArrayLike,
    radii: Sequence[float],
    steer_limits: Sequence[tuple[float, float] | None],
) -> SteeringGeometryParams:
    """Geometry from where a machine description puts its wheels.

    Args:
        names: names of the wheels.
        positions: wheel centres in base_link [m], shape (wheels, 2) or (wheels, 3); z is not used.
        radii: rolling radii [m].
        steer_limits: (smallest, largest) steer angle [rad] of each wheel, None where it is fixed.
    """
    places = np.asarray(positions, dtype=np.float64)
    wheels = tuple(
        WheelGeometry(
            name=name,
            x=float(place[0]),
            y=float(place[1]),
            radius=float(radius),
            steered=limits is not None,
            steer_min=0.0 if limits is None else limits[0],
            steer_max=0.0 if limits is None else limits[1],
        )
        for name, place, radius, limits in zip(names, places, radii, steer_limits, strict=True)
    )
    return SteeringGeometryParams(wheels=wheels)
