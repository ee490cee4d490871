"""A machine whose folder has machine.yaml and wheels alone: everything else follows from it, and says from what."""

import math
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml

from sojourn_config.errors import ConfigError
from sojourn_config.paths import config_folder
from sojourn_config.resolved import resolved_text
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_flight.mobility.rolling import RollingMobility
from sojourn_flight.mobility.rolling_params import RollingParams
from sojourn_physics.sensors.hazcam import HazcamParams
from sojourn_physics.sensors.imu import ImuParams
from sojourn_physics.sensors.sun_sensor import SunSensorParams

ROVERS = ("skid", "micro", "lunokhod", "lrv", "omni", "articulated", "explorer", "tracked")
CREWED = ("lrv",)


def bare(name: str, folder: Path) -> Path:
    """A copy of a machine of ours with nothing but what no default can know."""
    folder.mkdir()
    own = config_folder() / "machines" / name
    for file in own.glob("*.yaml"):
        if file.name not in ("flight.yaml", "power.yaml", "sensors.yaml", "measured.yaml"):
            shutil.copy(file, folder)
    machine = yaml.safe_load((folder / "machine.yaml").read_text("utf-8"))
    machine = {key: value for key, value in machine.items() if key not in ("arm", "tool", "arm_mount")}
    for drive in machine["drives"]:
        drive["load"] = "steer" if drive["load"] == "steer" else "drive"
    machine["drives"] = [drive for drive in machine["drives"] if not any("arm" in joint for joint in drive["joints"])]
    (folder / "machine.yaml").write_text(yaml.safe_dump(machine), "utf-8")
    return folder


def loaded(folder: Path, *overrides: str) -> LoadedScenario:
    return load_scenario("flat_drive", [f"machine={folder}", *overrides])


@pytest.mark.parametrize("name", [name for name in ROVERS if name != "explorer"])
def test_every_rover_drives_by_defaults(name: str, tmp_path: Path) -> None:
    scenario = loaded(bare(name, tmp_path / name))
    drive, mobility = scenario.drive, scenario.mobility()
    assert isinstance(mobility, RollingMobility) and isinstance(drive.mobility, RollingParams)
    fastest = drive.mobility.max_wheel_rate * min(wheel.radius for wheel in scenario.steering.wheels)
    assert 0.0 < drive.limits.max_speed <= fastest
    reach = max(math.hypot(wheel.x, wheel.y) for wheel in scenario.steering.wheels)
    assert drive.limits.max_yaw_rate * reach <= 1.1 * drive.limits.max_speed
    assert drive.energy is None and drive.obstacles is None and drive.heading_fix is None
    measured = {joint for group in scenario.sensors.joint_groups.values() for joint in group.joints}
    assert set(mobility.joints) <= measured
    law, battery = scenario.power_manager.law, scenario.power.battery
    volts = battery.cells_series * np.array(battery.ocv_points)
    assert volts[0] < law.derate_stop_voltage < law.shed_voltage < law.derate_start_voltage < volts[-1]


def test_what_follows_says_from_what(tmp_path: Path) -> None:
    text = resolved_text(loaded(bare("skid", tmp_path / "skid")).documents)
    for key, why in (
        ("max_wheel_rate", "velocity of the drive joints in the URDF"),
        ("mean_slip", "a guess: scripts/tune measures it"),
        ("shed_voltage", "in proportion to battery, 22.8 V empty and 33.4 V full"),
        ("corner_cut", "in proportion to the wheelbase, 0.60 m"),
    ):
        line = next(line for line in text.splitlines() if line.strip().startswith(f"{key}:"))
        assert line.endswith(f"# {why}"), line


def test_what_a_file_says_stays_and_the_rest_is_filled_in(tmp_path: Path) -> None:
    folder = bare("skid", tmp_path / "skid")
    (folder / "flight.yaml").write_text("drive: {limits: {max_speed: 0.07}, follower: {corner_cut: 0.5}}\n", "utf-8")
    (folder / "measured.yaml").write_text("odometry: {mean_slip: 0.2}\nmobility: {track_ratio: 1.7}\n", "utf-8")
    scenario = loaded(folder, "drive.mobility.track_ratio=1.5")
    drive, by_default = scenario.drive, loaded(bare("skid", tmp_path / "other")).drive
    assert (drive.limits.max_speed, drive.follower.corner_cut) == (0.07, 0.5)
    assert (drive.odometry.mean_slip, drive.mobility.track_ratio) == (0.2, 1.5)
    assert drive.limits.max_yaw_rate == by_default.limits.max_yaw_rate
    assert drive.follower.lateral_length == by_default.follower.lateral_length
    with pytest.raises(ConfigError, match=r"corner_cut = -1"):
        loaded(folder, "drive.follower.corner_cut=-1")


def test_a_camera_and_a_sun_sensor_bring_what_uses_them(tmp_path: Path) -> None:
    folder = bare("skid", tmp_path / "skid")
    explorer = yaml.safe_load((config_folder() / "machines" / "explorer" / "sensors.yaml").read_text("utf-8"))
    sensors = {
        "hazcam": {**explorer["hazcam"], "link": "camera_head_link"},
        "sun": {**explorer["sun"], "link": "mast_link", "noise_deg": 0.5},
    }
    (folder / "sensors.yaml").write_text(yaml.safe_dump(sensors), "utf-8")
    drive = loaded(folder).drive
    assert drive.obstacles is not None and drive.terrain_match is not None and drive.heading_fix is not None
    assert drive.heading_fix.noise_sigma == pytest.approx(math.radians(0.5))
    outline, wheels = drive.obstacles.outline, loaded(folder).machine.wheels
    places = np.array([(wheel.x, wheel.y) for wheel in loaded(folder).steering.wheels])
    assert outline.front == pytest.approx(places[:, 0].max() + wheels[0].shear_radius, rel=0.05)
    assert outline.half_width == pytest.approx(places[:, 1].max() + 0.5 * wheels[0].width, rel=0.05)
    (folder / "flight.yaml").write_text("drive: {obstacles: null, terrain_match: null}\n", "utf-8")
    drive = loaded(folder).drive
    assert drive.obstacles is None and drive.terrain_match is None and drive.heading_fix is not None
    assert loaded(folder, "drive.heading_fix=null").drive.heading_fix is None


def test_the_explorer_without_its_camera_still_loads() -> None:
    """Its file goes on about obstacles; what it leaves to the camera's defaults is still there."""
    for sensor in ("hazcam", "sun"):
        drive, usual = load_scenario("flat_drive", [f"sensors.{sensor}=null"]).drive, load_scenario("flat_drive").drive
        assert (drive.obstacles, drive.heading_fix) == (usual.obstacles, usual.heading_fix)


def test_what_cannot_follow_is_asked_for_by_its_key(tmp_path: Path) -> None:
    """Wheels whose rate the URDF does not limit: how fast it may go nobody knows."""
    folder = bare("skid", tmp_path / "skid")
    urdf = (config_folder().parent / "urdf" / "skid.urdf").read_text("utf-8")
    (folder / "skid.urdf").write_text(re.sub(r' velocity="[^"]*"', "", urdf), "utf-8")
    machine = folder / "machine.yaml"
    machine.write_text(machine.read_text("utf-8").replace("urdf: skid.urdf", "urdf: ./skid.urdf"), "utf-8")
    with pytest.raises(ConfigError) as caught:
        loaded(folder)
    told = str(caught.value)
    assert "config/parts/rover_flight.yaml" in told
    assert "drive.limits: the key is missing" in told and "drive.mobility.max_wheel_rate: the key is missing" in told
    assert "corner_cut" not in told and "lateral_weight" not in told


@pytest.mark.parametrize("rover", [rover for rover in ROVERS if rover not in CREWED])
def test_every_rover_that_drives_itself_sees_and_uses_what_it_sees(rover: str) -> None:
    """The lunar roving vehicle is driven by its crew."""
    scenario = load_scenario("flat_drive", [f"machine={rover}", "steps=[]"])
    drive, sensors = scenario.drive, scenario.sensors
    assert sensors.first(HazcamParams) is not None and sensors.first(SunSensorParams) is not None
    assert drive.obstacles is not None and drive.terrain_match is not None and drive.heading_fix is not None
    assert 0.0 < drive.obstacles.passable.max_step < 0.2


def test_curves_of_torque_bring_the_estimate_of_slip(tmp_path: Path) -> None:
    folder = bare("skid", tmp_path / "skid")
    mobility = loaded(folder).drive.mobility
    assert isinstance(mobility, RollingParams) and mobility.slip is None
    curve = "{limit: 0.6, softness: 0.4, offset: 0.0}"
    (folder / "measured.yaml").write_text(f"mobility: {{slip: {{fresh: {curve}, rut: {curve}}}}}\n", "utf-8")
    scenario = loaded(folder)
    mobility = scenario.drive.mobility
    assert isinstance(mobility, RollingParams) and mobility.slip is not None
    drive, wheel = scenario.machine.drives[0], scenario.machine.wheels[0]
    assert mobility.slip.rotor_inertia == pytest.approx(drive.motor.rotor_inertia * drive.gear.ratio**2)
    assert mobility.slip.free_slip == pytest.approx(0.008 / 0.188) and mobility.slip.rut_width == 0.5 * wheel.width
    assert mobility.slip.force_noise == pytest.approx(35e-6 * 9.80665), "of the LN-200S"
    assert scenario.mobility().slip_model is not None


@pytest.mark.parametrize(
    ("rover", "least", "most"), [("micro", 0.045, 0.05), ("tracked", 0.1, 0.12), ("skid", 0.09, 0.1)]
)
def test_the_highest_step_is_that_of_its_wheels_or_of_its_incline(rover: str, least: float, most: float) -> None:
    """The tracked rover drives over a step of 0.1 m in its course."""
    obstacles = load_scenario("flat_drive", [f"machine={rover}"]).drive.obstacles
    assert obstacles is not None and least <= obstacles.passable.max_step <= most


@pytest.mark.parametrize("rover", ["explorer", "articulated"])
def test_the_drive_knows_how_the_accelerometers_flicker(rover: str) -> None:
    """A bias that flickers moves more within seconds than a walk of 1e-4 m/s^2 a root of a second. Where it was not
    known of, it drew the speed of slow wheels to zero, and a goal 0.1 m away ended as "spinning without headway".
    """
    scenario = load_scenario("flat_drive", [f"machine={rover}"])
    mobility, imu = scenario.drive.mobility, scenario.sensors.sensors["imu"]
    assert isinstance(mobility, RollingParams) and mobility.slip is not None and isinstance(imu, ImuParams)
    flicker = imu.accelerometer_bias_instability_micro_g * 9.80665e-6
    assert mobility.slip.accelerometer_flicker == pytest.approx(flicker, rel=1e-3) and flicker > 0.0
