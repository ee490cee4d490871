"""Turning on two tracks: the moment that the ground resists with, and steady turns with slip of both tracks.

Ground that slides under all of both flat runs, evenly pressed, resists a turn on the spot with (Steeds 1950,
Tracked vehicles, Automobile Engineer 40:143)

    M = μ W l/4,   μ = (c A + W tan φ)/W

Where the shear grows from where the links come down it is less (Wong & Chiang 2001, Proc. IMechE D 215:343; Wong 2008,
Theory of Ground Vehicles, sec. 6.4). A track at y, belt speed V, on a hull that moves by (u, v) and turns by r:

    s = (V - u + r y)/|V|,   s_y = -v/|V|,   ψ = -r/|V|      forces and moment of `track_shear`
    steady: Σ(F - R sign(u - r y)) = 0,  Σ F_y = 0,  Σ(M - y (F - R sign(u - r y))) = 0   in V_left, V_right, v
    power of the sprockets Σ F V

about the middle of the runs, R compaction and bulldozing of one track. A track that runs backwards is one that runs
ahead, turned about.

Assumptions: low speed, no centrifugal force; both tracks loaded alike and evenly over their length; no soil pushed
aside by their flanks.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import root

from sojourn_analysis.vehicle.track_traction import TrackGround, footing
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import WHEEL_COLUMNS, WheelColumn
from sojourn_physics.contact.track import LevelTrackColumn, track_shear
from sojourn_physics.soil.params import SoilColumn

LEAST_BELT = 1e-6
"""Belt speed over the fastest motion of the hull, below which a track is dragged [-]."""


class TrackTurn(NamedTuple):
    """A steady turn; of the two tracks, left and right, shape (2,)."""

    belts: FloatArray
    """[m/s]"""
    side: float
    """v, of the middle of the runs [m/s]."""
    thrusts: FloatArray
    """[N]"""
    moments: FloatArray
    """About the middle of each run [N m]."""
    resistance: float
    """R, of one track [N]."""

    @property
    def moment(self) -> float:
        """With which the ground under the runs resists the turn [N m]."""
        return float(abs(self.moments.sum()))

    @property
    def power(self) -> float:
        """Of the sprockets [W]."""
        return float(self.belts @ self.thrusts)


def friction(ground: TrackGround) -> float:
    """μ, of ground that slides under the tracks [-]."""
    strength = ground.soil[SoilColumn.COHESION] * ground.vehicle.area
    return float(strength / ground.weight + ground.soil[SoilColumn.TAN_PHI])


def sliding_moment(ground: TrackGround) -> float:
    """μ W l/4 [N m]."""
    return friction(ground) * ground.weight * ground.vehicle.track.length / 4.0


def track_row(ground: TrackGround) -> FloatArray:
    """Of one track, as the law in one piece takes it: (WHEEL_COLUMNS,)."""
    track = ground.vehicle.track
    row = np.zeros(WHEEL_COLUMNS)
    row[WheelColumn.RADIUS], row[WheelColumn.WIDTH] = track.radius, track.width
    row[WheelColumn.GRAVITY] = ground.gravity
    row[LevelTrackColumn.LENGTH], row[LevelTrackColumn.ROAD_WHEELS] = track.length, track.road_wheels
    row[LevelTrackColumn.PEAKEDNESS] = track.peakedness
    return row


def steady_turn(ground: TrackGround, yaw_rate: float, radius: float) -> TrackTurn:
    """With which belts the machine turns so.

    Args:
        yaw_rate: to the left, more than 0 [rad/s]. radius: of the path of the middle of the runs, at least 0 [m].

    Raises:
        InvalidValueError: no such turn: the ground does not bear it, or values out of their range.
    """
    if not (math.isfinite(radius) and radius >= 0.0 < yaw_rate):
        raise InvalidValueError("yaw_rate, radius", (yaw_rate, radius), "more than 0 rad/s and at least 0 m")
    row, gauge = track_row(ground), ground.vehicle.gauge
    pressure = ground.weight / ground.vehicle.area
    places = np.array([0.5, -0.5]) * gauge
    hull = yaw_rate * (radius - places)
    level = footing(ground._replace(vehicle=ground.vehicle.centred()))
    resistance = 0.5 * (level.compaction + level.bulldozing)
    scale = yaw_rate * (radius + gauge)

    def forces(belts: FloatArray, side: float) -> FloatArray:
        """Thrust, side force and moment of each track, (2, 3)."""
        found = np.zeros((2, 3))
        for i, belt in enumerate(belts):
            speed, sense = max(abs(belt), LEAST_BELT * scale), 1.0 if belt >= 0.0 else -1.0
            slip, turn = (belt - hull[i]) / speed, -yaw_rate / speed
            along, across, moment = track_shear(
                row, ground.soil, pressure, sense * slip, -side / speed, sense * turn, 1.0
            )
            found[i] = sense * along, across, sense * moment
        return found

    def balance(unknown: FloatArray) -> FloatArray:
        found = forces(unknown[:2] * scale, unknown[2] * scale)
        pulls = found[:, 0] - resistance * np.sign(hull)
        moment = found[:, 2].sum() - places @ pulls
        return np.array([pulls.sum(), found[:, 1].sum(), moment / gauge]) / ground.weight

    for slip in (0.05, 0.2, 0.5, 0.01):
        start = hull / scale + slip * np.array([-1.0, 1.0])
        solved = root(balance, [*start, 0.0], tol=1e-12)
        if np.abs(balance(solved.x)).max() < 1e-8:
            break
    else:
        raise InvalidValueError("yaw_rate, radius", (yaw_rate, radius), "a turn that the ground bears")
    belts = solved.x[:2] * scale
    found = forces(belts, float(solved.x[2] * scale))
    return TrackTurn(belts, float(solved.x[2] * scale), found[:, 0], found[:, 2], resistance)
