"""Visual odometry on rendered pairs of rough ground, against the motion by which they were made."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_contract.stereo_pair import pair_place_of
from sojourn_contract.values import Odometry
from sojourn_flight.odometry.image_features import grain_of
from sojourn_flight.odometry.odometry import OdometryState, initial_odometry
from sojourn_flight.odometry.stereo_geometry import PinholePair
from sojourn_flight.odometry.stereo_motion import FoundMotion
from sojourn_flight.odometry.visual_odometry import VisualOdometer, motion_between, motion_since, way_of
from sojourn_flight.odometry.visual_state import (
    PairView,
    SeenPose,
    StereoImages,
    VisualOdometryState,
    rolled_on,
    visual_status,
)
from sojourn_machine.errors import InvalidValueError
from sojourn_sensors.app import SensorsApp
from sojourn_sensors.kinds.camera import CameraPair
from sojourn_sensors.sensor import Truth

SMALL = "sensors.navcam.lens={columns: 288, rows: 288, horizontal_view_deg: 45.4}"
STEP = 0.18
DT = 0.02
GYRO_SIGMA = 1e-4
"""Of a turn between two looks [rad]."""


class Scene:
    """The explorer's navigation cameras, of fewer pixels, anywhere on the ground of lunar_route."""

    def __init__(self, *overrides: str) -> None:
        scenario = load_scenario("lunar_route", ["machine=explorer_cameras", SMALL, *overrides])
        app = SensorsApp(scenario)
        (self._camera,) = (
            sensor for sensor in app.sensors if isinstance(sensor, CameraPair) and sensor.name == "navcam"
        )
        self._rest = app._at_rest()
        lens, stereo = self._camera.params.lens, self._camera.params.stereo
        self.pair = PinholePair(lens.focal_length, lens.principal_point, stereo.baseline)
        visual, place = scenario.drive.visual_odometry, pair_place_of(scenario)
        assert visual is not None and place is not None
        self.odometer = VisualOdometer(visual.model_copy(update={"corners": 150}), place, 0)
        self.start = initial_odometry(scenario.drive.odometry, key_frames=1)

    def images(self, pose: SeenPose, number: int) -> StereoImages:
        """What is seen from a pose."""
        half = 0.5 * pose.yaw
        turn = np.array([0.0, 0.0, math.sin(half), math.cos(half)])
        stamp = number * 10**9
        truth = replace(
            self._rest,
            stamp=stamp,
            odometry=Odometry(stamp, "map", "base_link", np.array(pose[:3]), turn, np.zeros(3), np.zeros(3)),
        )
        return self.seen(truth)

    def seen(self, truth: Truth) -> StereoImages:
        left, right, _ = self._camera.read(self._camera.initial_state(truth), truth).finished()
        return StereoImages(left, right, self.pair)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene()


def found_by(
    scene: Scene, odometry: OdometryState, view: PairView, there: SeenPose, number: int
) -> tuple[FoundMotion | None, int]:
    """The motion since a key frame to a pose, and how many points agree on it."""
    images = scene.images(there, 2 * number + 2)
    images = replace(images, left=grain_of(images.left), right=grain_of(images.right))
    found, points, _ = motion_since(scene.odometer, odometry, view, images, number)
    return found, points


def on(scene: Scene, odometry: OdometryState, pose: SeenPose) -> OdometryState:
    """The odometry as if it believed in a pose."""
    return replace(odometry, x=pose.x, y=pose.y, z=pose.z, roll=pose.roll, pitch=pose.pitch, yaw=pose.yaw)


def pose(x: float, y: float = 0.5, yaw: float = 0.1) -> SeenPose:
    return SeenPose(x, y, 0.45, 0.0, 0.0, yaw)


def gone(state: VisualOdometryState, way: float = STEP) -> VisualOdometryState:
    return rolled_on(state, way / DT, 0.0, DT)


@dataclass
class Rover:
    """Drives straight on, while its odometry believes that it goes with no slip."""

    scene: Scene
    slip: float

    def drive(self, looks: int) -> tuple[OdometryState, VisualOdometryState, SeenPose]:
        """After so many looks, and where it then is."""
        start = pose(1.0)
        odometry = on(self.scene, self.scene.start, start)
        covariance = odometry.covariance.copy()
        covariance[3, 3] = covariance[4, 4] = 0.1**2
        odometry, state = replace(odometry, covariance=covariance), VisualOdometryState()
        true = start
        for number in range(looks):
            odometry, state = self.scene.odometer.look(odometry, state, self.scene.images(true, number + 1))
            if number + 1 < looks:
                ahead = np.array((math.cos(start.yaw), math.sin(start.yaw)))
                way = (1.0 - odometry.slip_error) * STEP * ahead
                odometry = replace(odometry, x=odometry.x + way[0], y=odometry.y + way[1])
                # e_x += -D_x e_slip - D_y e_side, likewise y: see `odometry`
                grow = np.eye(len(odometry.covariance))
                grow[0, 3:5], grow[1, 3:5] = (-way[0], -way[1]), (-way[1], way[0])
                covariance = grow @ odometry.covariance @ grow.T
                covariance[2, 2] += GYRO_SIGMA**2
                odometry = replace(odometry, covariance=covariance)
                state = gone(state)
                true = pose(*(np.array(true[:2]) + (1.0 - self.slip) * STEP * ahead), start.yaw)
        return odometry, state, true


def test_motions_are_found_to_their_stated_errors(scene: Scene) -> None:
    """Eighteen motions at places all over: way and turn, squared errors over their variances, and what is believed of
    them beforehand is a fifth too long.
    """
    random, squares, errors = np.random.default_rng(5), [], []
    for number in range(18):
        here = pose(random.uniform(0.0, 15.0), random.uniform(0.0, 6.0), random.uniform(-3.0, 3.0))
        forward = STEP * np.array((math.cos(here.yaw), math.sin(here.yaw)))
        there = here._replace(
            x=here.x + forward[0], y=here.y + forward[1], yaw=here.yaw + 0.04 * random.standard_normal()
        )
        believed = there._replace(x=there.x + 0.2 * forward[0], y=there.y + 0.2 * forward[1])
        odometry, state = scene.odometer.look(
            on(scene, scene.start, here), VisualOdometryState(), scene.images(here, 2 * number + 1)
        )
        assert state.view is not None and state.text == "key frame"
        found, points = found_by(scene, on(scene, odometry, believed), state.view, there, number)
        assert found is not None and points >= 20
        way, covariance = way_of(scene.odometer.params, here, found)
        true, _ = way_of(scene.odometer.params, here, found._replace(motion=motion_between(here, there)))
        squares.append(float((way - true) @ np.linalg.solve(covariance, way - true)))
        errors.append(way - true)
    assert np.sqrt(np.mean(np.square(errors), axis=0)) == pytest.approx([0.0, 0.0, 0.0], abs=2e-3)
    assert abs(np.mean(errors, axis=0)[0]) < 5e-4  # lens and Sun held it back by 0.3 % before grain_of
    assert 0.7 < np.mean(squares) < 6.0 and np.mean(np.array(squares) < 7.815) > 0.8


@pytest.mark.parametrize("slip", [0.0, 0.3, 0.95])
def test_the_slip_of_the_ground_is_found_and_the_odometry_corrected(scene: Scene, slip: float) -> None:
    odometry, state, true = Rover(scene, slip).drive(5)
    status = visual_status(state, odometry.slip_error)
    assert state.matches == 4 and state.rejected == 0 and str(status["visual_odometry"]).startswith("matched")
    assert math.hypot(odometry.x - true.x, odometry.y - true.y) < 0.02
    assert status["visual_slip"] == pytest.approx(slip, abs=0.03)
    assert odometry.slip_error == pytest.approx(slip, abs=0.1)
    off = np.array((odometry.x - true.x, odometry.y - true.y))
    # ways of a few millimetres are seen too short: the grain of the ground is as fine as pixels
    assert slip > 0.9 or off @ np.linalg.solve(odometry.covariance[:2, :2], off) < 13.8


def test_the_same_images_give_the_same_odometry(scene: Scene) -> None:
    (one, seen, _), (other, again, _) = Rover(scene, 0.2).drive(3), Rover(scene, 0.2).drive(3)
    assert (one.x, one.y, one.yaw, seen.points) == (other.x, other.y, other.yaw, again.points)
    assert np.array_equal(one.covariance, other.covariance)


def after_one_look(scene: Scene, second: StereoImages, way: float = STEP) -> tuple[OdometryState, VisualOdometryState]:
    """Of a rover that has a key frame at 1 m, believes that it has gone on, and gets a second pair."""
    odometry = on(scene, scene.start, pose(1.0))
    odometry, state = scene.odometer.look(odometry, VisualOdometryState(), scene.images(pose(1.0), 1))
    assert state.view is not None
    return scene.odometer.look(on(scene, odometry, pose(1.0 + way)), gone(state, way), second)


def unchanged(odometry: OdometryState) -> bool:
    return (odometry.x, odometry.slip_error) == (1.0 + STEP, 0.0)


def test_a_camera_that_hangs_is_not_believed(scene: Scene) -> None:
    """One of them or both: wheels that go on while nothing moves in view would be taken for slip."""
    first, second = scene.images(pose(1.0), 1), scene.images(pose(1.0 + STEP), 2)
    for images in (first, replace(second, left=first.left), replace(second, right=first.right)):
        odometry, state = after_one_look(scene, images)
        assert unchanged(odometry) and state.rejected == 1 and state.text == "rejected: the same image again"


def test_it_says_that_it_is_dark(scene: Scene) -> None:
    night = Scene("sun.elevation_deg=-30")
    odometry, state = after_one_look(scene, night.images(pose(1.0 + STEP), 2))
    assert unchanged(odometry) and state.rejected == 1 and state.view is None and state.text == "it is dark"


def test_it_says_that_there_is_nothing_to_be_seen(scene: Scene) -> None:
    noise = np.random.default_rng(3).normal(130.0, 2.0, (2, 288, 288)).astype(np.uint8)
    odometry, state = after_one_look(scene, StereoImages(noise[0], noise[1], scene.pair))
    assert unchanged(odometry) and state.rejected == 1 and state.view is None
    assert state.text.startswith("only ") and state.text.endswith("points in view")


def test_a_camera_without_power_is_told(scene: Scene) -> None:
    nothing = np.zeros((0, 0), dtype=np.uint8)
    odometry, state = after_one_look(scene, StereoImages(nothing, nothing, scene.pair))
    assert unchanged(odometry) and state.text == "no image: the camera is off" and state.view is not None


@pytest.mark.parametrize(("part", "used"), [(0.02, True), (0.5, False)])
def test_dust_on_the_lens_makes_it_worse_and_not_wrong(scene: Scene, part: float, used: bool) -> None:
    """Specks of ten pixels that stay where they are, others on each lens."""
    random = np.random.default_rng(9)
    specks = [np.kron(random.random((36, 36)) < part, np.ones((8, 8), dtype=bool)) for _ in range(2)]

    clean = scene.images(pose(1.0), 1)
    odometry, state = scene.odometer.look(
        on(scene, scene.start, pose(1.0)), VisualOdometryState(), dusty_pair(clean, specks)
    )
    moved = scene.images(pose(1.0 + STEP), 2)
    odometry, state = scene.odometer.look(
        on(scene, odometry, pose(1.0 + 1.2 * STEP)), gone(state, 1.2 * STEP), dusty_pair(moved, specks)
    )
    if used:
        assert state.matches == 1 and state.slip == pytest.approx(1.0 - 1.0 / 1.2, abs=0.03)
    else:
        assert state.matches == 0 and odometry.slip_error == 0.0


def dusty_pair(images: StereoImages, specks: Sequence[np.ndarray]) -> StereoImages:
    left, right = (
        np.where(speck, np.uint8(60), image) for speck, image in zip(specks, (images.left, images.right), strict=True)
    )
    return replace(images, left=left, right=right)


def test_a_place_that_fits_nothing_is_rejected_and_it_begins_anew(scene: Scene) -> None:
    odometry, state = after_one_look(scene, scene.images(pose(9.0, 4.0, 2.0), 2))
    assert unchanged(odometry) and state.rejected == 1 and state.view is not None
    assert state.text.startswith("rejected: only")


def test_a_standing_rover_does_not_look(scene: Scene) -> None:
    _, state = after_one_look(scene, scene.images(pose(1.0), 2), way=0.0)
    assert (state.matches, state.rejected, state.text) == (0, 0, "standing, no match")


def test_an_odometry_without_its_key_frame_is_refused(scene: Scene) -> None:
    images = scene.images(pose(1.0), 1)
    with pytest.raises(InvalidValueError, match="key_frames"):
        replace(scene.odometer, frame=1).look(scene.start, VisualOdometryState(), images)
