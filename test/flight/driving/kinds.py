"""Machines of every kind, as seen from above: what the laws of steering are tested with."""

import math

from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams, WheelGeometry

RADIUS = 0.2


def wheel(name: str, x: float, y: float, **more: object) -> WheelGeometry:
    """Fixed unless limits are given."""
    return WheelGeometry.model_validate({"name": name, "x": x, "y": y, "radius": RADIUS, "steered": False} | more)


def steered(name: str, x: float, y: float, limit: float, **more: object) -> WheelGeometry:
    """Turns to both sides as far as the limit [rad]."""
    return wheel(name, x, y, steered=True, steer_min=-limit, steer_max=limit, **more)


def pairs(places: list[float], half_track: float) -> list[tuple[str, float, float]]:
    """Wheels left and right at each place along the body."""
    return [(f"{side}_{i}", x, y) for i, x in enumerate(places) for side, y in (("l", half_track), ("r", -half_track))]


def explorer() -> SteeringGeometryParams:
    """Six wheels, corners steered."""
    places = pairs([0.705, 0.0, -0.705], 0.53)
    return SteeringGeometryParams(wheels=tuple(steered(*place, 1.6) if place[1] else wheel(*place) for place in places))


def rover_of_the_moon() -> SteeringGeometryParams:
    """Both axles steered, each wheel about a kingpin that stands inside of it."""
    return SteeringGeometryParams(
        wheels=tuple(
            steered(name, x, y, 0.9, pivot_x=x, pivot_y=y - math.copysign(0.15, y))
            for name, x, y in pairs([1.143, -1.143], 0.914)
        )
    )


def skid(places: list[float]) -> SteeringGeometryParams:
    """Fixed wheels only."""
    return SteeringGeometryParams(wheels=tuple(wheel(*place) for place in pairs(places, 0.4)))


def articulated(rear_axles: tuple[float, ...] = (-1.6,)) -> SteeringGeometryParams:
    """base_link over the front axle, the joint 0.7 m behind it, the second body's axles behind that."""
    front = [wheel(*place) for place in pairs([0.0], 0.5)]
    body = {"pivot_x": -0.7, "pivot_y": 0.0, "steer_joint": "articulation"}
    rear = [steered(f"rear_{name}", x, y, 0.8, **body) for name, x, y in pairs(list(rear_axles), 0.5)]
    return SteeringGeometryParams(wheels=(*front, *rear))


def mecanum() -> SteeringGeometryParams:
    """Rollers at 45 degrees, the axes of those on the ground meeting as seen from above (an O)."""
    return SteeringGeometryParams(
        wheels=tuple(
            wheel(name, x, y, roller_angle=math.copysign(math.pi / 4, -x * y))
            for name, x, y in pairs([0.35, -0.35], 0.3)
        )
    )


def odd() -> SteeringGeometryParams:
    """Five wheels: two fixed, one steered in front off the middle, an omni wheel, a castor's arm behind."""
    return SteeringGeometryParams(
        wheels=(
            wheel("left", 0.0, 0.5),
            wheel("right", 0.0, -0.4),
            steered("front", 0.9, 0.1, 1.7),
            wheel("omni", -0.5, -0.2, roller_angle=math.pi / 2),
            steered("trailing", -0.9, 0.2, 3.2, pivot_x=-0.75, pivot_y=0.2),
        )
    )


MACHINES = {
    "explorer": (explorer(), 1.0),
    "lunar roving vehicle": (rover_of_the_moon(), 1.0),
    "4 skid": (skid([0.4, -0.5]), 1.6),
    "8 skid": (skid([0.9, 0.3, -0.3, -0.9]), 1.8),
    "articulated": (articulated(), 1.0),
    "articulated, tandem behind": (articulated((-1.3, -1.9)), 1.3),
    "mecanum": (mecanum(), 1.0),
    "odd": (odd(), 1.0),
}
"""Geometry and track ratio."""
