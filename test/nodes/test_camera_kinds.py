"""Cameras as sensors of a machine, one reading at a time: power, night, noise, ruts, and what is refused."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.app import Period
from sojourn_contract.ground import GROUND, ground_cloud
from sojourn_contract.hazcam import own_body_of
from sojourn_contract.run_table import row_named, table_of
from sojourn_contract.unfinished_image import finished
from sojourn_contract.values import JointState, Odometry
from sojourn_machine.sensor_faults import SensorFaultParams
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_physics.terrain.memory_tiles import CHANNELS, DUG, TILE
from sojourn_sensors.app import SensorsApp
from sojourn_sensors.fault_hooks import FaultNow
from sojourn_sensors.kinds.camera import CameraPair
from sojourn_sensors.kinds.hazcam import HazcamSensor
from sojourn_sensors.sensor import Truth

SMALL = "sensors.navcam.lens={columns: 96, rows: 96, horizontal_view_deg: 45.4}"


def pair(*overrides: str) -> tuple[CameraPair, Truth]:
    """The navigation cameras of the explorer, and a truth of it on flat ground."""
    scenario = load_scenario("flat_drive", ["machine=explorer_cameras", SMALL, *overrides])
    app = SensorsApp(scenario)
    (camera,) = (sensor for sensor in app.sensors if sensor.name == "navcam")
    assert isinstance(camera, CameraPair)
    pose = np.array([0.0, 0.0, 0.45]), np.array([0.0, 0.0, 0.0, 1.0])
    odometry = Odometry(0, "map", "base_link", *pose, np.zeros(3), np.zeros(3))
    return camera, replace(app._at_rest(), odometry=odometry, stamp=10**9)


def read(camera: CameraPair, truth: Truth) -> tuple[np.ndarray, ...]:
    _, images = camera.step(camera.initial_state(truth), truth, 0.02)
    return finished(images)


def test_readings_are_the_same_for_the_same_seed_and_no_others() -> None:
    one, other = pair(), pair("seed=5")
    images, again, different = read(*one), read(*one), read(*other)
    assert all(np.array_equal(first, second) for first, second in zip(images, again, strict=True))
    assert not any(np.array_equal(first, second) for first, second in zip(images, different, strict=True))


def test_the_depth_of_level_ground_is_that_of_the_mast() -> None:
    """In the middle column: the optical axis points 0.35 rad down from 1.45 m."""
    camera, truth = pair()
    *_, depth = read(camera, truth)
    f, (_, middle) = camera.params.lens.focal_length, camera.params.lens.principal_point
    for row in (50, 70, 90):
        down = 0.35 + np.arctan((row - middle) / f)
        expected = 1.45 / np.sin(down) * np.cos(down - 0.35)
        assert np.median(depth[row, 30:66]) / 1000.0 == pytest.approx(expected, rel=0.03)


def test_nothing_is_seen_by_night() -> None:
    left, _, depth = read(*pair("sun.elevation_deg=-30"))
    assert left.max() < 20 and (depth == 0).mean() > 0.999


def test_without_power_an_image_has_no_size() -> None:
    camera, truth = pair()
    state, reading = camera.step_without_power(camera.initial_state(truth), truth, 0.02)
    said = dict(camera.messages(truth.stamp, reading))
    assert reading is None and isinstance(state, GroundMemory)
    assert (said["/navcam/left/image"].width, said["/navcam/depth"].data) == (0, b"")
    assert said["/navcam/left/camera_info"].width == 96


def test_a_trench_is_seen_after_it_was_dug() -> None:
    camera, truth = pair()
    before = camera.initial_state(truth)
    tile = np.zeros((TILE, TILE, CHANNELS), dtype=np.float32)
    tile[:, :, DUG] = 0.15
    side = TILE * before.cell
    first = int((2.6 - before.origin_x) / side), int((-0.5 - before.origin_y) / side)
    tiles = {(first[0] + i, first[1] + j): tile for i in range(2) for j in range(2)}
    after = GroundMemory(before.cell, before.origin_x, before.origin_y, tiles)
    level = camera.read(before, truth).finished()[2]
    dug = replace(truth, inputs={**truth.inputs, GROUND.name: ground_cloud(truth.stamp, before, after)})
    state, images = camera.step(before, dug, 0.02)
    _, _, depth = finished(images)
    assert state.tiles.keys() == after.tiles.keys()
    deeper = depth.astype(float) - level
    assert (deeper[(level > 0) & (depth > 0)] > 150).mean() > 0.02


def test_what_changes_between_two_images_is_not_missed() -> None:
    """A camera that takes an image every three seconds hears of the ground once a second."""
    scenario = load_scenario(
        "flat_drive", ["machine=explorer_cameras", SMALL, "sensors.navcam.timing.rate=0.3333333333"]
    )
    app = SensorsApp(scenario)
    truth = app._at_rest()
    inputs = {**truth.inputs, "/truth/odom": truth.odometry, "/truth/joint_states": truth.joints}
    before = ground = GroundMemory(0.025, -10.0, -10.0)
    state = app.initial_state()
    place = [sensor.name for sensor in app.sensors].index("navcam")
    for second in range(1, 5):
        tile = np.zeros((TILE, TILE, CHANNELS), dtype=np.float32)
        tile[second, second, DUG] = 0.1
        ground = GroundMemory(0.025, -10.0, -10.0, {**before.tiles, (second, 1): tile})
        told = {GROUND.name: ground_cloud(second * 10**9, before, ground)}
        state, _ = app.step(state, Period(second * 10**9, {**inputs, **told}))
        before = ground
    assert state.sensors is not None
    assert state.sensors[place].tiles.keys() == ground.tiles.keys()


def test_each_camera_has_its_topics_under_its_own_name() -> None:
    scenario = load_scenario("flat_drive", ["machine=explorer_cameras", REAR, "drive.visual_odometry=null"])
    table = table_of(scenario)
    for name in ("/navcam/left/image", "/navcam/depth", "/rear/image", "/rear/camera_info", "/truth/ground"):
        assert name in table and row_named(name) == table.topic(name)
    assert "/camera/image" not in table and "/rear/left/image" not in table
    assert row_named("/rear/nothing") is None


def test_a_machine_without_cameras_has_no_such_topics() -> None:
    assert GROUND.name not in table_of(load_scenario("flat_drive", ["sensors.hazcam=null"]))


def test_the_drive_leaves_out_what_the_hazard_camera_sees_of_the_machine() -> None:
    """On flat ground, with the arm folded before it: all that is left is ground."""
    scenario = load_scenario("flat_drive", ["sensors.hazcam.sees_body=true", "sensors.hazcam.disparity_noise_px=0"])
    app, body = SensorsApp(scenario), own_body_of(scenario)
    (camera,) = (sensor for sensor in app.sensors if isinstance(sensor, HazcamSensor))
    pose = np.array([0.0, 0.0, 0.47]), np.array([0.0, 0.0, 0.0, 1.0])
    odometry = Odometry(0, "map", "base_link", *pose, np.zeros(3), np.zeros(3))
    truth = replace(app._at_rest(), odometry=odometry, stamp=10**9)
    arm = scenario.arm
    assert body is not None and arm is not None
    angles = dict(zip(truth.joints.names, truth.joints.position, strict=True))
    angles |= dict(zip(arm.joint_names, arm.named_poses["stow"], strict=True))
    joints = JointState(0, tuple(angles), *(np.array(list(angles.values())) for _ in range(3)))
    truth = replace(truth, joints=joints)
    _, points = camera.step(camera.initial_state(truth), truth, 0.02)
    above = points[:, 2] > -0.46
    left = body.left_out(points.astype(float), joints.names, joints.position)
    assert above.sum() > 50 and len(left) > 400
    assert np.abs(left[:, 2] + 0.47).max() < 3e-3


def test_a_hazard_camera_that_does_not_see_the_machine_leaves_nothing_out() -> None:
    assert own_body_of(load_scenario("flat_drive")) is None


DUST = "sensors.navcam.faults={lens: {dust: 0.3}}"


def test_dust_on_the_lenses_hides_the_same_pixels_of_every_image() -> None:
    """About its share of them, on each lens others; nothing else changes but where a patch fades out."""
    camera, truth = pair()
    fault = FaultNow(SensorFaultParams(dust=0.3), 0.0, 77, 1)
    reading = read(camera, truth)
    left, right, depth = camera.faulted(reading, fault)
    cover = camera.cover(fault)
    assert (cover > 0.5).mean() == pytest.approx(0.3, abs=0.12) and (cover < 0.001).mean() > 0.1
    later = replace(fault, time=9.0, number=450)
    again = camera.faulted(reading, later)
    assert all(np.array_equal(one, two) for one, two in zip(again, (left, right, depth), strict=True))
    other = camera.faulted(reading, replace(fault, stream=78))
    assert not np.array_equal(other[0], left)
    assert np.array_equal(left[cover == 0.0], reading[0][cover == 0.0])
    behind = left[cover > 0.999]
    assert np.abs(behind - 0.5 * reading[0].mean()).max() <= 1.0
    changed = [now != before for now, before in zip((left, right), reading, strict=False)]
    assert not np.array_equal(*changed)


def test_a_pair_finds_no_depth_behind_dust_on_either_lens() -> None:
    camera, truth = pair()
    fault = FaultNow(SensorFaultParams(dust=0.3), 0.0, 77, 1)
    *_, before = reading = read(camera, truth)
    *_, depth = camera.faulted(reading, fault)
    hidden = camera.cover(fault) > 0.5
    assert (before[hidden] > 0).any() and (depth[hidden] == 0).all()
    assert ((depth == before) | (depth == 0)).all()
    lost = ((before > 0) & (depth == 0) & ~hidden).sum() / ((before > 0) & ~hidden).sum()
    assert 0.1 < lost < 0.5
    *_, nothing = camera.faulted(reading, replace(fault, params=SensorFaultParams(dust=1.0)))
    assert (nothing == 0).all()


def test_a_run_has_dust_on_the_lenses_of_its_cameras() -> None:
    camera, truth = pair(DUST)
    app = SensorsApp(camera.site.scenario)
    inputs = {**truth.inputs, "/truth/odom": truth.odometry, "/truth/joint_states": truth.joints}
    state, _ = app.step(app.initial_state(), Period(10**9, inputs))
    place = [sensor.name for sensor in app.sensors].index("navcam")
    sound, dusty = read(camera, truth), finished(state.readings[place])
    assert 0 < (dusty[2] > 0).sum() < 0.8 * (sound[2] > 0).sum()


def test_depth_ends_where_the_right_image_does() -> None:
    camera, truth = pair("sensors.navcam.stereo.disparity_noise_px=0.0")
    *_, depth = read(camera, truth)
    rows, columns = np.nonzero(depth)
    disparity = 1000.0 * camera.params.lens.focal_length * camera.params.stereo.baseline / depth[rows, columns]
    assert len(rows) > 1000 and (columns - disparity).min() > -0.05


REAR = "sensors.rear={kind: camera, link: hazcam_link, lens: {columns: 48, rows: 32, horizontal_view_deg: 90.0}}"
BAD: list[tuple[str, Any]] = [
    (REAR.replace("hazcam_link", "tail_link"), "tail_link"),
    (REAR.replace("90.0", "190.0"), "equidistant is for wider lenses"),
    ("sensors.navcam.lens={columns: 4096, rows: 4096, horizontal_view_deg: 45.0}", "MB of images a second"),
    ("sensors.navcam.timing.rate=50.0", "MB of images a second"),
    ("sensors.navcam.timing.rate=7.0", "a divisor of the control rate"),
    ("sensors.navcam.stereo.range=0.4", "less than range"),
    ("sensors.navcam.lens.distortion=[-9.0, 0.0, 0.0, 0.0, 0.0]", r"navcam\.lens.*gives each pixel one direction"),
    (
        REAR.replace("90.0", "350.0, model: equidistant"),
        r"rear\.lens.*horizontal_view_deg = 350: allowed is at most 30",
    ),
    ("sensors.navcam.faults={a: {bias: 3.0}}", r"navcam\.faults\.a\.of.*allowed are dust, stuck"),
]


@pytest.mark.parametrize(("override", "words"), BAD)
def test_what_cannot_be_is_said_before_the_run(override: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        load_scenario("flat_drive", ["machine=explorer_cameras", override])
