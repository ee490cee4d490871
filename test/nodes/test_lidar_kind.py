"""A lidar as a sensor of a machine: its cloud, power, night, ruts, faults, timing, and what is refused."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ros_messages import ros_message
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.clouds import ECHO_FIELDS, columns_of
from sojourn_contract.conformance.clouds import CloudRule
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.ground import GROUND, ground_cloud
from sojourn_contract.run_table import table_of
from sojourn_contract.values import Odometry, PointCloud2
from sojourn_machine.mounting import mounting
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_physics.terrain.memory_tiles import CHANNELS, DUG, TILE
from sojourn_sensors.app import SensorsApp
from sojourn_sensors.kinds.lidar import CLOUD, Lidar
from sojourn_sensors.sensor import Truth
from sojourn_stack.apps import make_apps
from sojourn_stack.stack import Stack

LIDAR = (
    "sensors.scanner={{kind: lidar, link: hazcam_link, columns: 120, rows: 24, horizontal_view_deg: 120.0, "
    "vertical_view_deg: 60.0, nearest: 0.2, range: 60.0, noise: 0.005{more}}}"
)
NOTHING = GroundMemory(0.025, -10.0, -10.0)


def told(more: str = "") -> str:
    return LIDAR.format(more=f", {more}" if more else "")


def lidar(*overrides: str, more: str = "") -> tuple[Lidar, Truth]:
    """On the explorer, and a truth of it on flat ground."""
    app = SensorsApp(load_scenario("flat_drive", [told(more), *overrides]))
    (one,) = (sensor for sensor in app.sensors if isinstance(sensor, Lidar))
    pose = np.array([0.0, 0.0, 0.45]), np.array([0.0, 0.0, 0.0, 1.0])
    odometry = Odometry(0, "map", "base_link", *pose, np.zeros(3), np.zeros(3))
    return one, replace(app._at_rest(), odometry=odometry, stamp=10**9)


def read(one: Lidar, truth: Truth) -> Any:
    return one.step(one.initial_state(truth), truth, 0.02)[1]


def in_map(one: Lidar, points: Any) -> Any:
    rotation, place = mounting(one.site.scenario.urdf_xml, one.params.link)
    return points[:, :3] @ rotation.T + place + (0.0, 0.0, 0.45)


def test_its_points_are_on_the_level_ground_or_on_the_machine_by_day_and_by_night() -> None:
    for overrides in ((), ("sun.elevation_deg=-30",)):
        one, truth = lidar(*overrides)
        points = read(one, truth)
        heights = in_map(one, points)[:, 2]
        on_ground = np.abs(heights) < 0.03
        assert on_ground.sum() > 600
        assert heights.min() > -0.03 and (heights > 0.3).sum() > 3, "nothing lies deeper, and the arm is in its view"
        assert ((points[:, 3] > 0.0) & (points[:, 3] < 1.0)).all()


def test_readings_are_the_same_for_the_same_seed_and_no_others() -> None:
    first, again, other = read(*lidar()), read(*lidar()), read(*lidar("seed=5"))
    assert np.array_equal(first, again)
    assert first.shape != other.shape or not np.array_equal(first, other)


def test_without_power_there_are_no_points() -> None:
    one, truth = lidar()
    _, reading = one.step_without_power(one.initial_state(truth), truth, 0.02)
    ((name, cloud),) = one.messages(truth.stamp, reading)
    assert (name, cloud.width, cloud.data) == ("/scanner/points", 0, b"")
    assert tuple(field.name for field in cloud.fields) == ECHO_FIELDS


def test_its_cloud_is_what_its_row_says() -> None:
    one, truth = lidar()
    points = read(one, truth)
    ((_, cloud),) = one.messages(truth.stamp, points)
    assert isinstance(cloud, PointCloud2) and cloud.frame == "hazcam_link" and cloud.width == len(points)
    columns = columns_of("/scanner/points", cloud, ECHO_FIELDS)
    assert np.array_equal(np.column_stack([columns[name] for name in ECHO_FIELDS]), points)
    assert not CloudRule(CLOUD, None).judge(
        Observation(CLOUD, ros_message(cloud), truth.stamp, truth.stamp, truth.stamp)
    )


def test_a_trench_is_seen_after_it_was_dug() -> None:
    one, truth = lidar(more="noise_per_metre: 0.0")
    before = one.initial_state(truth)
    tile = np.zeros((TILE, TILE, CHANNELS), dtype=np.float32)
    tile[:, :, DUG] = 0.15
    side = TILE * before.cell
    first = int((2.0 - before.origin_x) / side), int((-0.5 - before.origin_y) / side)
    tiles = {(first[0] + i, first[1] + j): tile for i in range(2) for j in range(2)}
    after = GroundMemory(before.cell, before.origin_x, before.origin_y, tiles)
    dug = replace(truth, inputs={**truth.inputs, GROUND.name: ground_cloud(truth.stamp, before, after)})
    state, points = one.step(before, dug, 0.02)
    assert state.tiles.keys() == after.tiles.keys()
    assert (in_map(one, points)[:, 2] < -0.12).sum() > 10 > (in_map(one, read(one, truth))[:, 2] < -0.12).sum()


def clouds_of(more: str, periods: int = 130) -> dict[int, PointCloud2]:
    """What is said in a run of a standing machine, by stamp [periods]."""
    scenario, roles = load_scenario("flat_drive", [told(more)]), ("plant", "sensors")
    stack = Stack(make_apps(scenario, roles), roles, table_of(scenario))
    state, _ = stack.begin()
    heard = {}
    for _ in range(periods):
        state, said = stack.step(state)
        heard |= {message.stamp // 20_000_000: message for row, message in said if row.name == "/scanner/points"}
    return heard


def test_ten_clouds_a_second_or_as_many_as_it_is_told() -> None:
    assert list(clouds_of("")) == list(range(5, 131, 5))
    assert list(clouds_of("timing: {rate: 2.0, latency: 0.1}")) == [25, 50, 75, 100, 125]
    assert not clouds_of("faults: {broken: {dead: true}}")


def test_faults_are_on_its_points() -> None:
    whole = clouds_of("noise_per_metre: 0.0")
    stuck = clouds_of("faults: {held: {stuck: true, after: 1.0}}")
    assert stuck[60].data == stuck[125].data and whole[60].data != whole[125].data
    dusty = clouds_of("faults: {window: {dust: 0.4}}")
    assert 0.4 < dusty[50].width / whole[50].width < 0.8
    biased = clouds_of("faults: {off: {bias: 0.5}}")
    heights = [columns_of("/scanner/points", clouds[50], ("z",))["z"] for clouds in (biased, whole)]
    assert np.median(heights[0] - heights[1]) == pytest.approx(0.5, abs=1e-3)


def test_a_machine_with_a_lidar_hears_of_its_ruts_and_others_do_not() -> None:
    assert GROUND.name in table_of(load_scenario("flat_drive", [told()]))
    assert GROUND.name not in table_of(load_scenario("flat_drive"))


@pytest.mark.parametrize(
    ("override", "words"),
    [
        (told().replace("hazcam_link", "tail_link"), "tail_link"),
        (told("timing: {rate: 7.0}"), "a divisor of the control rate"),
        (told().replace("columns: 120, rows: 24", "columns: 4096, rows: 512"), "MB of images a second"),
        (told().replace("nearest: 0.2", "nearest: 60.0"), "less than range"),
    ],
)
def test_what_cannot_be_is_said_before_the_run(override: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        load_scenario("flat_drive", [override])
