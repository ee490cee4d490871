"""Visual odometry: how the machine has moved, from the images of a stereo pair, and the odometry corrected by it.

Key frames. Corners of the left image that are found in the right one, too, make a key frame: points of the ground with
their depths. When the odometry says that the machine has gone or turned far enough, they are followed into the images
of that moment, begun where the odometry expects them; by where both cameras see them then the motion follows
(`stereo_motion`): way and turn in the level axes of the key frame go into the odometry's filter by `relative_fix`.
That look is the next key frame, whatever became of it, so that no two matches share the errors of one.

Errors. Besides those of the places of the points, which points beside each other share in part, all ways are off by one
part of them where focal length or baseline are not as told: scale_sigma. Level axes are off by the tilt of the key
frame.

What it cannot tell it says: it is dark, nothing is to be seen in the images, few corners were found again (dust, ground
that looks otherwise from nearby), the points do not agree on a motion (shadows and parts of the machine move with it),
an image comes again (its camera hangs), the motion fits neither what was believed nor another slip.

Sources: Moravec (1980), Ph.D. thesis, Stanford; Maimone, Cheng & Matthies (2007), J. Field Robotics 24:169 (of the Mars
Exploration Rovers); Scaramuzza & Fraundorfer (2011), IEEE Robotics & Automation Magazine 18(4):80. Assumptions: most of
what is in view is ground that does not move.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from sojourn_flight.odometry.attitude import rotation_of
from sojourn_flight.odometry.disparity_plane import DisparityPlane, into_later, into_right, mapped, plane_of
from sojourn_flight.odometry.image_features import corners, follow, grain_of, redrawn, searched
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_flight.odometry.relative_fix import Seen, fix_way, with_key_frame
from sojourn_flight.odometry.stereo_geometry import (
    CameraPlace,
    Motion,
    PinholePair,
    projected,
    seen_after,
    triangulated,
)
from sojourn_flight.odometry.stereo_motion import FoundMotion, Looks, found_motion
from sojourn_flight.odometry.visual_params import VisualOdometryParams
from sojourn_flight.odometry.visual_state import Pose, StereoImages, View, VisualOdometryState
from sojourn_machine.params import FloatArray

COARSE = 11
"""Width of the windows by which a place is found to the whole pixel, on ground whose slant is not known yet [px]."""
SEARCHED, COARSE_OUTLIER, COARSE_SHARE = 60, 3.0, 0.3
"""Points that are searched for; distance from its predicted place of one that does not agree [px]; part that must."""
OFF_ROW = 0.7
"""By how much a place may leave its row in the other image of a pair [px]."""
LEAST_DISPARITY = 0.5
"""What is farther has no depth [px]."""
DARK = 12.0
"""Mean of an image below which it is said to be dark, of 255 [-]."""
LEAST_SIGMA = 2e-4
"""Of way [m] and turn [rad]: nothing is seen better than so."""


@dataclass(frozen=True, eq=False, slots=True)
class VisualOdometer:
    """What visual odometry needs to know of a machine."""

    params: VisualOdometryParams
    camera: CameraPlace
    frame: int
    """Which of the odometry's key frames is its."""

    def look(
        self, odometry: OdometryState, state: VisualOdometryState, images: StereoImages
    ) -> tuple[OdometryState, VisualOdometryState]:
        """Both states after a pair of images of this period."""
        params, view = self.params, state.view
        if images.left.size == 0:
            return odometry, replace(state, text="no image: the camera is off")
        is_dark = float(images.left.mean()) < DARK
        images = replace(images, left=grain_of(images.left), right=grain_of(images.right))
        if view is None:
            return _begun(self, odometry, state, images, is_dark)
        if state.rolled < params.step and state.turned < params.turn:
            return odometry, replace(state, text="standing, no match") if state.rolled == 0.0 else state
        if np.array_equal(images.left, view.images.left) or np.array_equal(images.right, view.images.right):
            return odometry, _rejected(state, "the same image again")
        state = replace(state, looks=state.looks + 1)
        found, tracked, why = motion_since(self, odometry, view, images, state.looks)
        state = replace(state, points=tracked)
        if found is None:
            return _begun(self, odometry, _rejected(state, why), images, is_dark)
        odometry, state = _fixed(self, odometry, state, view, found)
        return _begun(self, odometry, state, images, is_dark)

    def warm_up(self, odometry: OdometryState) -> None:
        """Have all libraries loaded: two looks at noise; `odometry` is left as it is."""
        noise = np.random.default_rng(0).integers(0, 256, (3, 96, 128), dtype=np.uint8)
        pair = PinholePair(100.0, (63.5, 47.5), 0.2)
        _, state = self.look(odometry, VisualOdometryState(), StereoImages(noise[0], np.roll(noise[0], -8, 1), pair))
        state = replace(state, rolled=self.params.step)
        self.look(odometry, state, StereoImages(noise[1], np.roll(noise[1], -8, 1), pair))


def _begun(
    odometer: VisualOdometer,
    odometry: OdometryState,
    state: VisualOdometryState,
    images: StereoImages,
    is_dark: bool,
) -> tuple[OdometryState, VisualOdometryState]:
    """With a key frame of these images; without one where there is too little in them."""
    params = odometer.params
    seen, plane = depths(params, images)
    if len(seen) < params.least_points:
        why = "it is dark" if is_dark else f"only {len(seen)} points in view"
        return odometry, replace(state, view=None, rolled=0.0, turned=0.0, text=why)
    odometry = with_key_frame(odometry, odometer.frame)
    text = state.text if state.view is not None else "key frame"
    view = View(images, seen, plane, pose_of(odometry))
    return odometry, replace(state, view=view, rolled=0.0, turned=0.0, text=text)


def depths(params: VisualOdometryParams, images: StereoImages) -> tuple[FloatArray, DisparityPlane]:
    """u, v in the left image and u in the right one of corners that both see, shape (n, 3) [px], and the ground."""
    left, right, pair = images.left, images.right, images.pair
    places = corners(left, params.corners)
    reach = math.ceil(pair.focal_length * pair.baseline / params.nearest)
    across, found = searched(left, right, places, COARSE, (reach, 0, 0))
    if found.sum() < params.least_points:
        return np.zeros((0, 3)), DisparityPlane(0.0, 0.0, 0.0)
    plane = plane_of(np.column_stack([places, across[:, 0]])[found])
    there, found = follow(left, right, places, into_right(plane), params.window)
    found &= (np.abs(there[:, 1] - places[:, 1]) < OFF_ROW) & (there[:, 0] < places[:, 0] - LEAST_DISPARITY)
    seen = np.column_stack([places, there[:, 0]])[found]
    return seen, plane


def motion_since(
    odometer: VisualOdometer, odometry: OdometryState, view: View, images: StereoImages, number: int
) -> tuple[FoundMotion | None, int, str]:
    """The motion since the key frame, the points that agree on it, and why there is none."""
    params, random = odometer.params, np.random.default_rng(number)
    guess = _coarse(odometer, view, images, motion_between(view.pose, pose_of(odometry)), random)
    onto = into_later(view.plane, images.pair, odometer.camera, guess, images.left.shape)
    if onto is None:
        return None, 0, "the ground is out of view"
    places = view.seen[:, :2]
    left, in_left = follow(view.images.left, images.left, places, onto[0], params.window)
    right, in_right = follow(view.images.left, images.right, places, onto[1], params.window)
    kept = in_left & in_right & (np.abs(left[:, 1] - right[:, 1]) < OFF_ROW)
    again = int(kept.sum())
    if again < params.least_points:
        return None, again, f"only {again} of {len(places)} points found again"
    looks = Looks(odometer.camera, images.pair, view.seen[kept], np.column_stack([left, right[:, 0]])[kept])
    found = found_motion(looks, guess, random, params.outlier, params.tracking_sigma)
    agree = 0 if found is None else int(found.agree.sum())
    if agree < max(params.least_points, params.least_share * again):
        return None, agree, f"only {agree} of {again} points agree on a motion"
    return found, agree, ""


def _coarse(
    odometer: VisualOdometer, view: View, images: StereoImages, guess: Motion, random: np.random.Generator
) -> Motion:
    """The motion to some pixels, by searching around the places where a guess has some of the points: a slip that was
    not believed leads farther astray than can be followed. The guess itself where too few are found.
    """
    onto = into_later(view.plane, images.pair, odometer.camera, guess, images.left.shape)
    if onto is None:
        return guess
    seen = view.seen[:: max(len(view.seen) // SEARCHED, 1)]
    reach = odometer.params.search
    drawn = redrawn(images.left, onto[0])
    there, found = searched(view.images.left, drawn, seen[:, :2], COARSE, (reach, reach, reach))
    seen, there = seen[found], mapped(onto[0], there[found])
    points = triangulated(images.pair, seen)
    expected = projected(images.pair, seen_after(odometer.camera, guess, points))
    second = np.column_stack([there, there[:, 0] + expected[:, 2] - expected[:, 0]])
    coarse = found_motion(Looks(odometer.camera, images.pair, seen, second), guess, random, COARSE_OUTLIER, 1.0)
    return guess if coarse is None or coarse.agree.sum() < COARSE_SHARE * len(view.seen[:SEARCHED]) else coarse.motion


def _fixed(
    odometer: VisualOdometer, odometry: OdometryState, state: VisualOdometryState, view: View, found: FoundMotion
) -> tuple[OdometryState, VisualOdometryState]:
    """The filter's update with a motion."""
    seen, covariance = way_of(odometer.params, view.pose, found)
    since = odometry.x - view.pose.x, odometry.y - view.pose.y
    told = Seen(odometer.frame, seen, np.asarray(np.linalg.inv(covariance)))
    fix = fix_way(odometer.params, odometry, told, since)
    state = replace(state, error_px=found.deviation, deviation=fix.deviation)
    if fix.odometry is None:
        return odometry, _rejected(state, f"off by {1e3 * fix.off:.0f} mm, {fix.deviation:.1f} sigma")
    slip = 1.0 - math.hypot(seen[0], seen[1]) / state.rolled if state.rolled >= odometer.params.step else state.slip
    text = "matched: the ground slips otherwise" if fix.widened else "matched"
    return fix.odometry, replace(state, matches=state.matches + 1, slip=slip, text=text)


def way_of(params: VisualOdometryParams, before: Pose, found: FoundMotion) -> tuple[FloatArray, FloatArray]:
    """x, y [m] and turn [rad] in the level axes of a key frame, shape (3,), with their covariance, shape (3, 3)."""
    level = rotation_of(before.roll, before.pitch)
    turned, gone = level @ found.motion.turn, level @ found.motion.shift
    way = np.array((gone[0], gone[1], math.atan2(turned[1, 0], turned[0, 0])))
    onto = np.zeros((3, 6))
    onto[:2, :3], onto[2, 3:] = level[:2], level[2]
    covariance = params.sharing * onto @ found.covariance @ onto.T
    covariance[:2, :2] += (params.tilt_sigma * gone[2]) ** 2 * np.eye(2)
    covariance += params.scale_sigma**2 * np.outer(way, way) + LEAST_SIGMA**2 * np.eye(3)
    return way, covariance


def pose_of(odometry: OdometryState) -> Pose:
    """Where the odometry has base_link."""
    return Pose(odometry.x, odometry.y, odometry.z, odometry.roll, odometry.pitch, odometry.yaw)


def motion_between(before: Pose, after: Pose) -> Motion:
    """Of base_link from one pose to another, in the axes of the first."""
    was = rotation_of(before.roll, before.pitch, before.yaw)
    now = rotation_of(after.roll, after.pitch, after.yaw)
    gone = np.array((after.x - before.x, after.y - before.y, after.z - before.z))
    return Motion(was.T @ now, was.T @ gone)


def _rejected(state: VisualOdometryState, why: str) -> VisualOdometryState:
    return replace(state, rejected=state.rejected + 1, text=f"rejected: {why}")
