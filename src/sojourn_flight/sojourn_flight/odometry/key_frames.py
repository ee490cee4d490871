"""Terrain-relative odometry: each cloud is matched with the ground of a key frame, and the odometry corrected by it.

Key frames. The last few clouds, placed by the odometry, make the surface of a key frame: that of the newest of them.
Later clouds are matched with it (`terrain_match`), until the rover has gone or turned too far from it, or its ground is
hardly in view any more; then the last clouds make the next. Clouds that come while the rover stands are not matched:
they would tell the same again.

What a match tells goes into the odometry's filter by `relative_fix`. A match with few points, with too many off the
surface or with residuals above their deviations is not used, nor one that does not fit there.

Source: Maimone, Cheng & Matthies (2007), J. Field Robotics 24:169 (visual odometry of the Mars Exploration Rovers, with
which they drove on slopes and in loose soil). Assumptions: a gyro carries the heading from one cloud to the next; the
ground does not change.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from sojourn_flight.hazards.stereo_camera import StereoCamera, along_rays
from sojourn_flight.odometry.attitude import rotation_of, turned_in_plane
from sojourn_flight.odometry.ground_surface import GroundSurface, surface_through
from sojourn_flight.odometry.odometry import OdometryState, wrap_angle
from sojourn_flight.odometry.odometry_kernels import widened
from sojourn_flight.odometry.relative_fix import Seen, fix_way, informative, key_frame, key_place, with_key_frame
from sojourn_flight.odometry.terrain_match import Match, match
from sojourn_flight.odometry.terrain_match_params import TerrainMatchParams
from sojourn_machine.params import FloatArray

FRAME = 0
"""Its key frame among those of the odometry."""
LEAST_STEEPNESS = 0.05
"""Added to the share of a ray's error that is height: the slope of the ground that it meets is not known yet [-]."""
LEAST_VARIANCE = 1e-6
"""Of a point's height: points are rounded to a millimetre [m^2]."""
ALMOST_NONE, LEAST_SHARE = 0.3, 0.003
"""Part of the way told that is left by the believed slip: below the first it is not trusted [-]."""
MOST_OUTLIERS = 0.25
"""Part of the points beyond which a match is not used [-]."""
LEAST_OVERLAP = 0.5
"""Part of a cloud on the key frame's surface below which there is a new one [-]."""


@dataclass(frozen=True, eq=False, slots=True)
class KeyFrame:
    """A cloud with its place; arrays in level axes along the heading it was seen with, shape (n, 3) [m]."""

    points: FloatArray
    """About base_link."""
    errors: FloatArray
    """By which a point is off for one standard deviation of its match."""
    place: tuple[float, float, float, float]
    """base_link: x, y in odom, height in the chain of the matches [m]; yaw [rad]."""


@dataclass(frozen=True, slots=True)
class TerrainMatchState:
    """The key frame, the last clouds, and what became of the matches."""

    surface: GroundSurface | None = None
    """Of the key frame, in its axes; None before there is one."""
    level: float = 0.0
    """Height of base_link at the key frame [m]."""
    observations: tuple[KeyFrame, ...] = ()
    """The last clouds, the newest at the end."""
    at: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    """x, y, height of the odometry and yaw at the last cloud that was taken."""
    matched_at: tuple[float, float] = (0.0, 0.0)
    """x, y at the last match that was used, or at the key frame [m]."""
    key_frames: int = 0
    matches: int = 0
    """That were used."""
    rejected: int = 0
    """That were not."""
    text: str = "no cloud yet"
    """What became of the last cloud, in words."""
    points: int = 0
    """Of the last match."""
    deviation: float = 0.0
    """Of the last innovation, in standard deviations [-]."""
    doubted: bool = False
    """The last match that fitted asked for another slip, and was not used."""


@dataclass(frozen=True, eq=False, slots=True)
class TerrainMatcher:
    """What matching needs to know of a machine."""

    params: TerrainMatchParams
    camera: StereoCamera


def match_ground(
    matcher: TerrainMatcher, odometry: OdometryState, state: TerrainMatchState, cloud: FloatArray
) -> tuple[OdometryState, TerrainMatchState]:
    """Both states after a cloud in base_link, shape (n, 3) [m].

    Args:
        odometry: of this period, made for key frames, see `initial_odometry`.

    Raises:
        InvalidValueError: the odometry is not made for key frames.
    """
    key = key_frame(odometry, FRAME)
    params = matcher.params
    observation = _observation_of(matcher, odometry, state, cloud)
    if len(observation.points) < params.least_points:
        return odometry, replace(state, text=f"only {len(observation.points)} points of the ground in view", points=0)
    moved = math.hypot(*_told(odometry, state.at[:2]))
    turned = abs(wrap_angle(odometry.yaw - state.at[3]))
    if state.surface is not None and max(moved, turned) < params.least_step:
        if len(state.observations) >= params.clouds or state.matches:
            return odometry, replace(state, text="standing, no match")
        return _with_key_frame(matcher, odometry, _taken(params, state, observation, odometry))
    if state.surface is None:
        return _with_key_frame(matcher, odometry, _taken(params, state, observation, odometry))

    turn = wrap_angle(odometry.yaw - key[2])
    ahead, left = turned_in_plane(odometry.x - key[0], odometry.y - key[1], -key[2])
    to_key = rotation_of(0.0, 0.0, turn)
    guess = np.array((ahead, left, observation.place[2] - state.level))
    heading = math.sqrt(max(_relative_heading_variance(odometry), 1e-10))
    found = match(
        state.surface,
        observation.points @ to_key.T,
        observation.errors @ to_key.T,
        guess,
        params.sharing,
        (params.tilt_sigma, heading),
    )
    overlap = found.points / len(observation.points)
    flaw = _flaw(params, found)
    if not flaw and not _is_informative(found):
        state = replace(state, text="the ground is too even to tell", points=found.points)
    elif flaw:
        state = replace(state, rejected=state.rejected + 1, text=f"rejected: {flaw}", points=found.points)
    else:
        observation = replace(
            observation,
            place=(*observation.place[:2], state.level + float(guess[2] + found.shift[2]), observation.place[3]),
        )
        odometry, state = _updated(params, odometry, state, found, guess[:2])
        observation = replace(observation, place=(odometry.x, odometry.y, observation.place[2], odometry.yaw))
    state = _taken(params, state, observation, odometry)
    gone = math.hypot(float(guess[0] + found.shift[0]), float(guess[1] + found.shift[1]))
    if gone > params.spacing or abs(turn) > params.turn or overlap < LEAST_OVERLAP:
        return _with_key_frame(matcher, odometry, state)
    return odometry, state


def warm_up(matcher: TerrainMatcher, odometry: OdometryState) -> None:
    """Have every kernel compiled: a wavy ground seen from two places; `odometry` is left as it is."""
    params, camera = matcher.params, matcher.camera
    ahead, left = np.meshgrid(np.linspace(0.5, 2.0, 31), np.linspace(-0.8, 0.8, 33))
    ground = np.stack(
        [ahead, left, 0.05 * np.sin(4.0 * ahead) * np.cos(4.0 * left) - camera.position[2] - 0.5], axis=-1
    )
    first, state = match_ground(matcher, odometry, TerrainMatchState(), ground.reshape(-1, 3))
    second = replace(first, x=first.x + params.least_step, y=first.y + params.least_step)
    match_ground(matcher, second, state, ground.reshape(-1, 3))
    widened(first.covariance, 0.1, 0.1, params.lost_slip)


def match_status(state: TerrainMatchState | None, odometry: OdometryState) -> dict[str, str | float]:
    """Fields of /drive/status; none without a camera."""
    if state is None:
        return {}
    return {
        "terrain_match": state.text,
        "terrain_matches": float(state.matches),
        "terrain_rejected": float(state.rejected),
        "terrain_key_frames": float(state.key_frames),
        "terrain_points": float(state.points),
        "terrain_deviation_sigma": state.deviation,
        "terrain_slip_correction": odometry.slip_error,
    }


def _observation_of(
    matcher: TerrainMatcher, odometry: OdometryState, state: TerrainMatchState, cloud: FloatArray
) -> KeyFrame:
    """The near points of a cloud in level axes."""
    rays = cloud - matcher.camera.position
    near = (rays * rays).sum(axis=1) <= matcher.params.range**2
    level = rotation_of(odometry.roll, odometry.pitch)
    height = odometry.z
    if state.observations:
        height = state.observations[-1].place[2] + odometry.z - state.at[2]
    return KeyFrame(
        np.ascontiguousarray(cloud[near] @ level.T),
        np.ascontiguousarray(along_rays(matcher.camera, cloud[near]) @ level.T),
        (odometry.x, odometry.y, height, odometry.yaw),
    )


def _taken(
    params: TerrainMatchParams, state: TerrainMatchState, observation: KeyFrame, odometry: OdometryState
) -> TerrainMatchState:
    at = (odometry.x, odometry.y, odometry.z, odometry.yaw)
    return replace(state, observations=(*state.observations, observation)[-params.clouds :], at=at)


def _flaw(params: TerrainMatchParams, found: Match) -> str:
    """Why a match cannot be used; empty where it can."""
    if found.points < params.least_points:
        return f"only {found.points} points on known ground"
    if not found.converged and _is_informative(found):
        return "no place fits"
    if found.outliers > MOST_OUTLIERS * found.points:
        return f"{found.outliers} of {found.points} points off the ground"
    if found.misfit > params.misfit:
        return f"points off the ground by {math.sqrt(found.misfit):.1f} sigma"
    return ""


def _is_informative(found: Match) -> bool:
    """Whether the ground has relief enough for a direction."""
    return bool(informative(np.linalg.eigh(found.information)[0]).any())


def _updated(
    params: TerrainMatchParams, odometry: OdometryState, state: TerrainMatchState, found: Match, guess: FloatArray
) -> tuple[OdometryState, TerrainMatchState]:
    """The filter's update with a match."""
    since = _told(odometry, state.matched_at)
    fix = fix_way(params, odometry, Seen(FRAME, guess + found.shift[:2], found.information), since)
    state = replace(state, points=found.points, deviation=fix.deviation)
    if fix.odometry is None:
        off = f"off by {1e3 * fix.off:.0f} mm, {fix.deviation:.1f} sigma"
        return odometry, replace(state, rejected=state.rejected + 1, text=f"rejected: {off}")
    if fix.widened and not state.doubted:  # one edge on even ground fits in more than one place
        return odometry, replace(state, doubted=True, text="doubted: does the ground slip otherwise?")
    odometry = fix.odometry
    text = "matched: the ground slips otherwise" if fix.widened else "matched"
    matched = replace(state, matches=state.matches + 1, matched_at=(odometry.x, odometry.y), doubted=False, text=text)
    return odometry, matched


def _with_key_frame(
    matcher: TerrainMatcher, odometry: OdometryState, state: TerrainMatchState
) -> tuple[OdometryState, TerrainMatchState]:
    """A key frame at the newest observation, through the last ones."""
    params, camera = matcher.params, matcher.camera
    x, y, level, yaw = state.observations[-1].place
    points, variances = [], []
    for observation in state.observations:
        ahead, left = turned_in_plane(observation.place[0] - x, observation.place[1] - y, -yaw)
        turned = rotation_of(0.0, 0.0, wrap_angle(observation.place[3] - yaw))
        points.append(observation.points @ turned.T + np.array((ahead, left, observation.place[2] - level)))
        length = np.sqrt((observation.errors * observation.errors).sum(axis=1))
        variances.append((np.abs(observation.errors[:, 2]) + LEAST_STEEPNESS * length) ** 2 + LEAST_VARIANCE)
    reach = params.range + math.hypot(camera.position[0], camera.position[1])
    surface = surface_through(np.concatenate(points), np.concatenate(variances), params.cell, params.radius, reach)
    odometry = with_key_frame(odometry, FRAME, params.reference_sigma)
    return odometry, replace(
        state, surface=surface, level=level, matched_at=(odometry.x, odometry.y), key_frames=state.key_frames + 1
    )


def _told(odometry: OdometryState, place: tuple[float, float]) -> tuple[float, float]:
    """The way from a place as the wheels tell it [m]: where almost all of it is believed to be slip, the odometry
    stands whatever they do, and only the camera can tell that it does not.
    """
    share = 1.0 - odometry.slip_error
    scale = 1.0 if share > ALMOST_NONE else 1.0 / max(share, LEAST_SHARE)
    return scale * (odometry.x - place[0]), scale * (odometry.y - place[1])


def _relative_heading_variance(odometry: OdometryState) -> float:
    covariance, key = odometry.covariance, key_place(odometry, FRAME) + 2
    return float(covariance[2, 2] + covariance[key, key] - 2.0 * covariance[2, key])
