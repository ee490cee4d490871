"""Inclinometer and star tracker on a machine that names them, in whole runs; the IMU's temperature."""

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sojourn_bags.contract_version import check_contract
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag
from sojourn_config.errors import ConfigError
from sojourn_config.paths import config_folder
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract.app import Period
from sojourn_contract.codecs.ros_library import message_of
from sojourn_contract.heartbeat import status_message
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_machine.mounting import mounting
from sojourn_machine.params import FloatArray, IntArray
from sojourn_plant.app import PlantApp
from sojourn_sensors.app import SensorsApp
from sojourn_stack import run as direct

ROLES = ("plant", "sensors", "drive", "arm", "power", "operator", "recorder")
STEPS = "steps=[{wait_s: 3.0}, {drive_to: {x: -0.8, y: 0.0}}]"
SENSORS = """
extends: {explorer}/sensors.yaml
deck_tilt: {{extends: tsd_inclinometer, link: solar_deck_link}}
stars: {{extends: nst_star_tracker, link: solar_deck_link}}
powered_by: {{stars: cameras}}
"""


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The explorer with both."""
    folder, explorer = tmp_path_factory.mktemp("machines") / "levelled", config_folder() / "machines" / "explorer"
    shutil.copytree(explorer, folder)
    (folder / "sensors.yaml").write_text(SENSORS.format(explorer=explorer), encoding="utf-8")
    return folder


def run(folder: Path, *overrides: str) -> Bag:
    direct.run(direct.RunSpec("flat_drive", ROLES, (STEPS, *overrides), bag=folder))
    return read_bag(folder)


@pytest.fixture(scope="module")
def bag(machine: Path, tmp_path_factory: pytest.TempPathFactory) -> Bag:
    return run(tmp_path_factory.mktemp("run") / "bag", f"machine={machine}")


def attitudes(bag: Bag, topic: str, field: str) -> Rotation:
    return Rotation.from_quat(np.column_stack([bag[topic].column(f"{field}.{axis}") for axis in "xyzw"]))


def at_the_same_time(one: FloatArray, other: FloatArray) -> tuple[IntArray, IntArray]:
    """Places of the stamps that both have."""
    _, first, second = np.intersect1d(np.round(one * 1e3), np.round(other * 1e3), return_indices=True)
    return first, second


def test_each_says_what_is_true_within_its_data_sheet(bag: Bag) -> None:
    base_to_link = Rotation.from_matrix(mounting(load_scenario("flat_drive").urdf_xml, "solar_deck_link")[0])
    stars, tilts, seen = bag["/attitude/stars"], bag["/inclination/deck_tilt"], bag["/truth/odom"].times
    link = attitudes(bag, "/truth/odom", "pose.pose.orientation") * base_to_link

    then, place = at_the_same_time(seen, stars.times)
    turns = link[then].inv() * attitudes(bag, "/attitude/stars", "quaternion")[place]
    errors = np.degrees(turns.as_rotvec()) * 3600.0
    assert len(errors) > 20 and np.abs(errors.mean(axis=0)).max() < 100.0
    assert errors.std(axis=0) == pytest.approx([6.0, 6.0, 40.0], rel=0.5)

    standing = tilts.times < 3.0  # driving off is taken for tilt
    then, place = at_the_same_time(seen, tilts.times[standing])
    true = np.arcsin(link[then].as_matrix()[:, 2, :2])
    measured = np.column_stack([tilts.column(f"vector.{axis}") for axis in "xy"])[place]
    assert np.abs(np.median(measured - true, axis=0)).max() < 4.0 * np.radians(0.03)
    assert (tilts.column("vector.z") == 0.0).all()


def test_the_contract_is_kept(bag: Bag) -> None:
    check_contract(bag)
    report, _ = judge_bag(bag)
    assert not list(report.lines()) and {"/inclination/deck_tilt", "/attitude/stars"} <= set(report.messages)


def test_they_change_no_number_of_another_sensor(bag: Bag, tmp_path: Path) -> None:
    bare = run(tmp_path / "bag")
    fields = {"/imu/data": "linear_acceleration.x", "/bus/state": "voltage", "/odom": "pose.pose.position.x"}
    for name, field in fields.items():
        np.testing.assert_array_equal(bag[name].column(field), bare[name].column(field), name)


@pytest.mark.parametrize(
    ("overrides", "told"),
    [
        ((), True),  # on the Moon by day
        (("sun.elevation_deg=80.0",), False),
        (("body=mars",), False),
        (("body=mars", "sun.elevation_deg=-30.0"), True),
    ],
)
def test_the_tracker_needs_a_dark_sky(machine: Path, overrides: tuple[str, ...], told: bool) -> None:
    said, tilt = first_messages(load_scenario("flat_drive", [f"machine={machine}", *overrides]), 20.0)
    assert np.isfinite(said.quaternion.w) == told
    assert np.isfinite(tilt.vector).all()


def test_without_power_the_tracker_says_nothing(machine: Path) -> None:
    said, tilt = first_messages(load_scenario("flat_drive", [f"machine={machine}"]), 0.0)
    assert np.isnan([said.quaternion.x, said.quaternion.y, said.quaternion.z, said.quaternion.w]).all()
    assert np.isfinite(tilt.vector).all(), "it has no load"


def first_messages(scenario: LoadedScenario, power: float) -> tuple[Any, Any]:
    """Of tracker and inclinometer, where the machine stands at the start, with so much power at the cameras [W]."""
    app, plant = SensorsApp.of(scenario), PlantApp.of(scenario)
    stamp = 50 * CONTROL_PERIOD_NS
    truth = dict(plant.first_messages(plant.initial_state(), stamp))
    truth["/truth/loads"] = status_message(stamp, "loads", {"power cameras": f"{power}"})
    _, answer = app.step(app.initial_state(), Period(stamp, truth))
    assert not answer.refusals
    said = dict(answer.messages)
    return message_of(said["/attitude/stars"]), said["/inclination/deck_tilt"]


@pytest.mark.parametrize(
    ("kind", "rest"),
    [
        ("inclinometer", "range_deg: 30.0, resolution_deg: 0.001, noise_deg: 0.0, bias_deg: 0.0"),
        (
            "star_tracker",
            "cross_boresight_arcsec: 6.0, about_boresight_arcsec: 40.0, sun_exclusion_deg: 45.0, "
            "horizon_exclusion_deg: 25.0, slew_limit_deg_per_second: 2.0",
        ),
    ],
)
def test_a_link_that_is_not_there_is_refused_before_the_run(kind: str, rest: str) -> None:
    load_scenario("flat_drive", [f"sensors.one={{kind: {kind}, link: solar_deck_link, {rest}}}"])
    with pytest.raises(ConfigError, match="decklink"):
        load_scenario("flat_drive", [f"sensors.one={{kind: {kind}, link: decklink, {rest}}}"])
    with pytest.raises(ConfigError, match=rest.split(":")[0]):
        load_scenario("flat_drive", [f"sensors.one={{kind: {kind}, link: solar_deck_link}}"])


def test_the_imu_is_as_warm_as_the_box_that_its_load_warms() -> None:
    """A gyro whose bias goes with the temperature alone: it turns by the change of the box, and not without heat."""
    errors = ("sensors.imu.gyro_bias_deg_per_hour_per_kelvin=100.0", "sensors.imu.gyro_angle_quantum=0.0")
    quiet = ("sensors.imu.gyro_arw_deg_per_sqrt_hour=0.0", "sensors.imu.gyro_bias_instability_deg_per_hour=0.0")
    change = {}
    for name in ("lunar_night", "flat_drive"):
        scenario = load_scenario(name, [*errors, *quiet])
        app, plant = SensorsApp.of(scenario), PlantApp.of(scenario)
        state, rates = app.initial_state(), []
        truth = dict(plant.first_messages(plant.initial_state(), CONTROL_PERIOD_NS))
        for second, box in enumerate([290.0, 300.0], start=1):
            stamp = second * 50 * CONTROL_PERIOD_NS
            truth["/truth/loads"] = status_message(stamp, "loads", {"temperature box": f"{box}", "power imu": "20.0"})
            state, answer = app.step(state, Period(stamp, truth))
            rates.append(dict(answer.messages)["/imu/data"].angular_velocity)
        change[name] = float(np.abs(rates[1] - rates[0]).max()) * 3600.0 * 180.0 / np.pi
    assert 100.0 < change["lunar_night"] < 5000.0 and change["flat_drive"] < 1.0
