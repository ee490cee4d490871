"""Every scenario of the repository loads, and every kind of mistake in one is refused with its place."""

import math
import shutil
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.load import load_params
from sojourn_config.paths import available, config_folder, repository_root
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_config.steps import STEPS
from sojourn_machine.machine import MachineParams
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.soil.params import SoilParams
from sojourn_physics.terrain.height_field import HeightField

SCENARIOS = available("scenarios")


@cache
def ground_of(name: str) -> HeightField:
    return load_scenario(name).height_field()


@pytest.fixture(scope="module")
def flat() -> LoadedScenario:
    return load_scenario("flat_drive")


# --- what is in the repository ---


def test_the_agreed_scenarios_are_there() -> None:
    assert {"lunar_sample", "flat_drive", "parked_slope"} <= set(SCENARIOS)


@pytest.mark.parametrize("name", SCENARIOS)
def test_every_scenario_loads_and_its_ground_can_be_made(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.name == name
    ground = ground_of(name)
    assert set(ground.soil_names) <= set(scenario.soils)
    assert math.isfinite(ground.height(scenario.config.start.x, scenario.config.start.y))
    assert (scenario.gravity > 0.0) != scenario.body.free_fall
    for step in scenario.config.steps:
        assert step.kind in STEPS.names()


@pytest.mark.parametrize("name", available("scenarios"))
def test_what_a_bag_says_of_a_scenario_is_read_again(name: str) -> None:
    """With all defaults in it, as a bag has them."""
    config = load_scenario(name).config
    assert type(config).model_validate_json(config.model_dump_json()) == config


@pytest.mark.parametrize("name", available("soils"))
def test_every_soil_loads_under_its_own_name(name: str) -> None:
    assert load_params("soils", name, SoilParams).name == name


@pytest.mark.parametrize("name", available("bodies"))
def test_every_body_loads_under_its_own_name(name: str) -> None:
    assert load_params("bodies", name, BodyParams).name == name


def test_bundle_holds_what_a_run_needs(flat: LoadedScenario) -> None:
    assert isinstance(flat.machine, MachineParams)
    assert flat.urdf_xml.startswith('<robot name="explorer">')
    assert flat.soil_names == ("lunar_nominal", "rigid_rock")
    assert flat.body.name == "moon"
    assert flat.simulation.substeps == 20
    assert flat.power_manager.loads == flat.power.loads
    assert flat.power_manager.power == flat.power
    assert [wheel.name for wheel in flat.machine.wheels] == [
        "front_left", "front_right", "middle_left", "middle_right", "rear_left", "rear_right",
    ]  # fmt: skip
    names = list(flat.files)
    assert names[0] == "config/scenarios/flat_drive.yaml"
    assert "urdf/explorer.urdf" in names
    for name, text in flat.files.items():
        assert (repository_root() / name).read_text(encoding="utf-8") == text


def test_wheels_of_the_drive_node_are_those_of_the_urdf(flat: LoadedScenario) -> None:
    wheels = {wheel.name: wheel for wheel in flat.steering.wheels}
    assert wheels["front_left"].x - wheels["rear_left"].x == pytest.approx(1.41)
    assert wheels["front_left"].y - wheels["front_right"].y == pytest.approx(1.06)
    assert not wheels["middle_left"].steered
    assert wheels["rear_right"].steered
    assert wheels["rear_right"].steer_max > math.pi / 2
    assert wheels["front_left"].radius == pytest.approx(0.125 + 0.006), "they roll on their grousers"


def test_a_blind_drive_uses_no_camera(flat: LoadedScenario) -> None:
    seeing = {"obstacles": flat.drive.obstacles, "terrain_match": flat.drive.terrain_match}
    assert None not in seeing.values()
    blind = load_scenario("flat_drive", ["blind_drive=true"])
    assert blind.drive.obstacles is None and blind.drive.terrain_match is None
    assert blind.drive.model_copy(update=seeing) == flat.drive


def test_arm_gets_rotor_inertia_and_friction_of_its_drives(flat: LoadedScenario) -> None:
    drives = {joint: drive for drive in flat.machine.drives for joint in drive.joints}
    for index, joint in enumerate(flat.arm.joint_names):
        drive = drives[joint]
        wanted = drive.motor.rotor_inertia * drive.gear.ratio**2
        assert flat.arm.reflected_inertia[index] == pytest.approx(wanted)
        assert flat.arm.coulomb_friction[index] >= drive.gear.friction_torque


def test_straight_way_of_the_main_job_is_blocked_and_the_route_is_long_enough() -> None:
    scenario = load_scenario("lunar_sample")
    ground = ground_of("lunar_sample")
    start = scenario.config.start
    routes = [step.action for step in scenario.config.steps if step.kind == "drive_route"]
    assert len(routes) == 1
    points = [(start.x, start.y), *((point.x, point.y) for point in routes[0].points)]
    length = sum(math.dist(a, b) for a, b in pairwise(points))
    assert length > 8.0

    def steepest(way: list[tuple[float, float]]) -> float:
        found = 0.0
        for a, b in pairwise(way):
            for part in np.linspace(0.0, 1.0, 60):
                for side in (-0.53, 0.0, 0.53):
                    x = a[0] + part * (b[0] - a[0])
                    y = a[1] + part * (b[1] - a[1]) + side
                    found = max(found, math.hypot(*ground.gradient(x, y)))
        return math.degrees(math.atan(found))

    assert steepest([points[0], points[-1]]) > 30.0, "beyond the slope that the machine may take"
    assert steepest(points) < 20.0
    assert [step.kind for step in scenario.config.steps if step.kind != "wait_s"] == [
        "drive_route", "arm_joints", "arm_to_ground", "arm_joints",
    ]  # fmt: skip


# --- mistakes ---


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of config/ and urdf/ to make mistakes in."""
    shutil.copytree(config_folder(), tmp_path / "config")
    shutil.copytree(repository_root() / "urdf", tmp_path / "urdf")
    monkeypatch.setenv("SOJOURN_CONFIG_DIR", str(tmp_path / "config"))
    return tmp_path


@pytest.fixture
def refused(workspace: Path) -> Callable[[str, str, str], str]:
    """Change one thing in a file of the copy, load flat_drive, and give the text of the refusal."""

    def change(file: str, old: str, new: str) -> str:
        path = workspace / file
        text = path.read_text(encoding="utf-8")
        assert old in text, f"{old!r} is not in {file}"
        path.write_text(text.replace(old, new, 1), encoding="utf-8")
        with pytest.raises(ConfigError) as caught:
            load_scenario("flat_drive")
        return str(caught.value)

    return change


SCENARIO = "config/scenarios/flat_drive.yaml"
ROVER = "config/machines/explorer/machine.yaml"
WHEEL = "config/machines/explorer/wheel.yaml"
ARM = "config/arms/explorer_arm.yaml"
ARM_URDF = "urdf/explorer_arm.urdf"
SOIL = "config/soils/lunar_nominal.yaml"
BODY = "config/bodies/moon.yaml"


@pytest.mark.parametrize(
    ("file", "old", "new", "words"),
    [
        (SCENARIO, "seed: 1", "sead: 1", [SCENARIO, "sead = 1", "unknown key", "did you mean seed?"]),
        (SCENARIO, "seed: 1", "seed: -1", ["seed = -1", "at least 0"]),
        (SCENARIO, "seed: 1", "seed: 1.5", ["seed = 1.5", "whole number"]),
        (SCENARIO, "battery_soc: 0.8", "battery_soc: 80", ["battery_soc = 80", "at most 1"]),
        (SCENARIO, "battery_soc: 0.8", "battery_soc: 80 %", ["'80 %'", "number", "no unit"]),
        (SCENARIO, "machine: explorer", "machine: explorr", ["machine = 'explorr'", "did you mean explorer?"]),
        (SCENARIO, "body: moon", "body: mun", [f"{SCENARIO}:5", "mars", "did you mean moon?"]),
        (
            SCENARIO, "body: moon", "body: moon\nsite: {latitude_deg: 91}",
            [f"{SCENARIO}:6", "site.latitude_deg = 91", "at most 90"],
        ),
        (SCENARIO, "body: moon", "body: moon\nsite: {altitude_m: 3}", ["site.latitude_deg", "missing"]),
        (
            SCENARIO, "body: moon", "body: low_earth_orbit\nsite: {latitude_deg: 9}",
            ["site = 'low_earth_orbit'", "free fall"],
        ),
        (
            SCENARIO, "body: moon", "body: moon\nwind: {speed: 3, towards_deg: 0, drag_area: 1}",
            ["wind = 'moon'", "a body whose file has a table `atmosphere`"],
        ),
        (SCENARIO, "body: moon", "body: jupiter", ["body = 'jupiter'", "no ground"]),
        (BODY, "{kind: oblate,", "{kind: oblat,", ["attraction.kind = 'oblat'", "did you mean oblate?"]),
        (SCENARIO, "soil: lunar_nominal", "soil: lunar", ["config/soils", "did you mean lunar_nominal?"]),
        (SCENARIO, "kind: flat", "kind: flet", ["terrain.kind = 'flet'", "did you mean flat?"]),
        (SCENARIO, "kind: flat", "kind: slope", ["terrain.slope_deg", "more than 0"]),
        (SCENARIO, "resolution: 0.1", "resolution: 0.001", ["terrain.resolution", "at least 0.005", "[m]"]),
        (SCENARIO, "x: -1.0", "x: -11.0", ["start.x = -11.0", "off the terrain", "-8 to 8 m"]),
        (SCENARIO, "{x: 1.0", "{x: 9.5", ["steps[0].drive_to.x = 9.5", "off the terrain"]),
        (SCENARIO, "drive_to:", "drive_too:", ["steps[0].drive_too", "did you mean drive_to?", "arm_joints"]),
        (SCENARIO, "y: 0.0}\n    time", "y: 0.0, yaw: 90}\n    time", ["drive_to.yaw = 90", "[rad]"]),
        (SCENARIO, "timeout_s", "wait_s", ["steps[0]", "drive_to and wait_s", "one action"]),
        (SCENARIO, "drive_to: {x: 1.0, y: 0.0}", "arm_joints: {name: stoww}", ["did you mean stow?"]),
        (SCENARIO, "drive_to: {x: 1.0, y: 0.0}", "arm_joints: {positions: [0, 0]}", ["has 2 values", "is 5"]),
        (
            SCENARIO, "drive_to: {x: 1.0, y: 0.0}", "arm_joints: {positions: [0, 0, 0, 0, 9]}",
            ["positions[4] = 9", "arm_turret_joint"],
        ),
        (SCENARIO, "drive_to: {x: 1.0, y: 0.0}", "arm_joints: {}", ["either name or positions"]),
        (SCENARIO, "drive_to: {x: 1.0, y: 0.0}", "arm_path: {points: []}", ["arm_path.points"]),
        (
            SCENARIO, "drive_to: {x: 1.0, y: 0.0}", "arm_path: {points: [{x: 1, y: 0, z: 0, on_arc: true}]}",
            ["points[0] is on an arc", "then the arc's end"],
        ),
        (SCENARIO, "drive_to: {x: 1.0, y: 0.0}", "arm_task: {name: wave}", ["unknown task 'wave'", "guarded_move"]),
        (
            SCENARIO, "drive_to: {x: 1.0, y: 0.0}", "arm_task: {name: guarded_move, values: {forse: 5}}",
            ["unknown key 'forse'", "force, distance"],
        ),
        (
            SCENARIO, "drive_to: {x: 1.0, y: 0.0}", "arm_to: {frame: odom, x: 1, y: 0, z: 0}",
            ["arm_to.frame = 'odom'", "base_link", "map"],
        ),
        (
            SCENARIO, "drive_to: {x: 1.0, y: 0.0}", "arm_to: {x: 1, y: 0, z: 0, orientation: [0, 0, 0, 2]}",
            ["orientation", "length 2"],
        ),
        (ROVER, "urdf: explorer.urdf", "urdf: explore.urdf", [f"{ROVER}:", "did you mean explorer.urdf?"]),
        (WHEEL, "radius: 0.125", "radius: 0.13", [f"{WHEEL}:2: wheels[0].radius = 0.13", "0.125 m", "urdf/"]),
        (WHEEL, "width: 0.16", "width: 160", [f"{WHEEL}:3: wheels[0].width = 160", "at most 3", "[m]"]),
        (
            ROVER, "name: front_left,", "name: front_left, contact: {model: brushh},",
            ["wheels[0].contact.model = 'brushh'", "did you mean brush?", "rigid_wheel_on_soil"],
        ),
        (
            ROVER, "name: front_left,", "name: front_left, contact: {model: brush, stiffness: 1.0e+4},",
            ["wheels[0].contact.cornering_stiffness", "missing", "[N/rad]"],
        ),
        (
            ROVER, "name: front_left,", "name: front_left, contact: {model: roller_wheel, roller_angle_deg: 100},",
            ["wheels[0].contact.roller_angle_deg = 100", "at most 90", "[degree]"],
        ),
        (
            ROVER, "name: front_left,", "name: front_left, contact: {model: roller_wheel, roller_angle_deg: 2},",
            ["wheels[0].contact", "roller_angle_deg", "5 to 90"],
        ),
        (
            ROVER, "name: front_left,", "name: front_left, contact: {stiffness: 1.0e+4},",
            ["wheels[0].contact.model", "the key is missing"],
        ),
        (
            SOIL, "shear_modulus: 0.0178", "# shear_modulus: 0.0178",
            [SOIL, "kind = 'soil'", "missing: shear_modulus"],
        ),
        (
            ROVER, "joint: wheel_front_left_joint", "joint: wheel_front_lef_joint",
            ["wheels[0].joint", "not a joint", "did you mean wheel_front_left_joint?"],
        ),
        (
            ROVER, "joint: wheel_front_left_joint", "joint: rocker_left_joint",
            ["wheels[0].joint = 'rocker_left_joint'", "allowed is continuous"],
        ),
        (ROVER, "ratio: 1000.0", "ratio: 0.5", ["drives[0].gear.ratio = 0.5", "at least 1"]),
        (ROVER, "efficiency: 0.70", "efficiency: 70", ["drives[0].gear.efficiency = 70", "at most 1"]),
        (ROVER, "load: drive", "load: driv", ["drives[0].load", "did you mean drive?"]),
        (ROVER, "load: drive", "load: computer", ["no commanded load", "arm, drive, steer"]),
        (ROVER, "max_torque: 40.0", "max_torque: 400.0", ["servo.max_torque = 400.0", "60 N m", "effort"]),
        (ROVER, "first: rocker_left_joint", "first: rocker_joint", ["[0].first", "rocker_left_joint"]),
        (
            ROVER, "couplings:", "suspensions: [{joints: [bogie_left], stiffness: 50.0, damping: 1.0}]\ncouplings:",
            ["suspensions[0].joints[0] = 'bogie_left'", "not a joint", "did you mean bogie_left_joint?"],
        ),
        (
            ROVER, "couplings:", "suspensions: [{joints: [mast_joint], stiffness: 50.0, damping: 1.0}]\ncouplings:",
            ["suspensions[0].joints[0] = 'mast_joint'", "is fixed", "urdf/explorer.urdf"],
        ),
        (
            ROVER, "couplings:",
            "suspensions: [{joints: [arm_elbow_joint], stiffness: 50.0, damping: 1.0}]\ncouplings:",
            ["joint arm_elbow_joint has a drive", "without one"],
        ),
        (
            ROVER, "couplings:",
            "suspensions: [{joints: [bogie_left_joint], stiffness: 0, damping: 1.0, rest: 9.0}]\ncouplings:",
            ["suspensions[0].stiffness = 0", "above 0", "[N m/rad]"],
        ),
        (ROVER, "motor: {extends", "motor: {kind: seris, extends", ["drives[0].motor", "seris"]),
        (
            ROVER, "motor: {extends", "motor: {kind: series, extends",
            ["drives[0].motor.field_constant", "missing"],
        ),
        (
            ROVER, "front_left, link: base_link", "front_left, link: base",
            ["pads[0].link = 'base'", "did you mean base_link?"],
        ),
        (ROVER, "arm: explorer_arm", "arm: explorer", ["allowed is one of", "did you mean explorer_arm?"]),
        (ROVER, "kind: rover", "kind: rovr", [f"{ROVER}:", "= 'rovr'", "rover, spacecraft, stand", "mean rover?"]),
        (ROVER, "kind: rover\n", "", [f"{ROVER}: kind: the key is missing", "rover, spacecraft, stand"]),
        (ROVER, "kind: rover", "kind: stand", ["wheels = ", "a stand has none"]),
        (
            "config/parts/nca_cell.yaml", "coulombic_efficiency: 0.99", "coulombic_efficiency: 9",
            ["config/parts/nca_cell.yaml:", "battery.coulombic_efficiency = 9"],
        ),
        (
            "config/parts/rover_flight.yaml", "yaw_gain: 0.8 ", "yaw_gain: -0.8 ",
            ["config/parts/rover_flight.yaml:", "drive.follower.yaw_gain = -0.8"],
        ),
        (ROVER, "load: steer", "load: steer\n    load: steer", ["drives[1].load", "twice"]),
        (SOIL, "k_phi:", "kphi:", ["kphi", "did you mean k_phi?"]),
        (SOIL, "name: lunar_nominal", "name: other", ["name = 'other'", "lunar_nominal"]),
        (BODY, "\nradius: ", "\nradius: -", [BODY, "radius = -", "[m]"]),
        (
            ARM, "tip_link: arm_tip_link", "tip_link: arm_tip",
            ["tip_link = 'arm_tip'", "did you mean arm_tip_link?"],
        ),
        (
            "config/machines/explorer/sensors.yaml", "rocker_left_joint", "roker_left_joint",
            ["joint_groups.suspension.joints[0]", "did you mean rocker_left_joint?"],
        ),
        (
            ARM, "side: motor, gear_ratio: 1500.0", "side: output",
            ["joint_groups.wrist.encoder.side = 'output'", "arm_wrist_joint is closed on its motor", "has play"],
        ),
        (
            "config/machines/explorer/flight.yaml", "max_wheel_rate: 1.0", "max_wheel_rate: 2.0",
            ["drive.mobility.max_wheel_rate = 2.0", "at most 1 rad/s", "urdf/explorer.urdf"],
        ),
        ("urdf/explorer.urdf", "</robot>", "", ["urdf/explorer.urdf", "not an XML document"]),
        (ARM_URDF, '<link name="arm_tip_link"/>', "", ["arm_tip_link", "not a link"]),
        ("urdf/explorer.urdf", 'lower="-0.45"', "", ["rocker_left_joint", "lower and upper"]),
        ("urdf/explorer.urdf", 'lower="-0.45"', 'lower="low"', ["rocker_left_joint", "'low'", "number"]),
        ("urdf/explorer.urdf", 'name="mast_link"', 'name="base_link"', ["link base_link", "2 times"]),
        ("urdf/explorer.urdf", 'xyz="0 0.3 -0.07"', 'xyz="0 0.3"', ["three numbers"]),
        ("urdf/explorer.urdf", '<mass value="40"/>', '<mass value="4"/>', ["mass = 173.0", "sum up to 137 kg"]),
        ("urdf/explorer.urdf", '<mass value="40"/>', '<mass value="-40"/>', ["avionics_link, mass = -40"]),
        ("urdf/explorer.urdf", '<mass value="40"/>', "", ["avionics_link", "needs mass and inertia"]),
        ("urdf/explorer.urdf", 'ixx="0.7493333"', 'ixx="7.5"', ["avionics_link, inertia", "sum of the other two"]),
        ("urdf/explorer.urdf", 'ixx="0.7493333"', 'ixx="-0.7"', ["avionics_link, inertia", "more than 0 kg m2"]),
        ("urdf/explorer.urdf", 'ixx="0.7493333"', 'ixx="?"', ["avionics_link", "'?'", "number"]),
        ("urdf/explorer.urdf", 'ixx="0.7493333" ', "", ["avionics_link", "ixx", "needed"]),
        (
            "urdf/explorer.urdf", '<parent link="base_link"/><child link="mast_link"/>',
            '<parent link="base_link"/><child link="imu_link"/>', ["link imu_link", "several joints", "mast_joint"],
        ),
        (
            "urdf/explorer.urdf", '<parent link="base_link"/><child link="mast_link"/>',
            '<parent link="camera_head_link"/><child link="mast_link"/>', ["link mast_link", "ring", "base_link"],
        ),
        (
            ROVER, "ratio: 1.0} # the differential",
            "ratio: 1.0}\n  - {first: rocker_right_joint, second: rocker_left_joint, ratio: 1.0}",
            [f"{ROVER}:", "couplings[1]", "follows from the couplings above"],
        ),
        (
            ROVER, "second: rocker_right_joint, ratio", "second: rocker_left_joint, ratio",
            ["couplings[0].second = 'rocker_left_joint'", "another joint"],
        ),
        (ROVER, "mass: 173.0", "mass: 0", ["mass = 0", "above 0"]),
    ],
)  # fmt: skip
def test_a_mistake_is_refused_with_its_place(
    refused: Callable[[str, str, str], str], file: str, old: str, new: str, words: list[str]
) -> None:
    text = refused(file, old, new)
    for word in words:
        assert word in text, text


def test_problems_of_several_files_are_told_together(workspace: Path) -> None:
    for file, old, new in (
        (SOIL, "cohesion: ", "cohesion: -"),
        (BODY, "solar_day_hours: ", "solar_day_hours: -"),
        (ROVER, "ratio: 1000.0", "ratio: 0"),
    ):
        path = workspace / file
        path.write_text(path.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        load_scenario("flat_drive")
    files = {problem.file for problem in caught.value.problems}
    assert files == {SOIL, BODY, ROVER}
    assert all(problem.line is not None for problem in caught.value.problems)


def test_all_that_does_not_fit_the_urdf_is_told_together(workspace: Path) -> None:
    """Mass, inertia, wheel's axis, radius, joint name and coupling, each wrong in its own way: six problems at once."""
    urdf, rover = workspace / "urdf/explorer.urdf", workspace / ROVER
    text = urdf.read_text(encoding="utf-8").replace('ixx="0.7493333"', 'ixx="7.5"', 1)
    wheel = text.index('<joint name="wheel_middle_left_joint"')
    text = text[:wheel] + text[wheel:].replace('<axis xyz="0 1 0"/>', '<axis xyz="1 0 0"/>', 1)
    urdf.write_text(text, encoding="utf-8")
    config = rover.read_text(encoding="utf-8")
    for old, new in (
        ("mass: 173.0", "mass: 200.0"),
        ("name: front_left,", "name: front_left, radius: 0.2,"),
        ("joint: wheel_rear_left_joint", "joint: wheel_rear_lift_joint"),
        ("second: rocker_right_joint", "second: rocker_wrong_joint"),
    ):
        assert old in config
        config = config.replace(old, new, 1)
    rover.write_text(config, encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        load_scenario("flat_drive")
    told = str(caught.value)
    for words in (
        "avionics_link, inertia",
        "wheel_middle_left_joint, axis = 1 0 0: allowed is 0 1 0",
        "mass = 200.0",
        "wheels[0].radius = 0.2",
        "wheel_rear_lift_joint",
        "did you mean wheel_rear_left_joint?",
        "rocker_wrong_joint",
    ):
        assert words in told, told


def test_a_wheel_that_would_drive_backwards_is_refused(refused: Callable[[str, str, str], str]) -> None:
    """Its joint is turned half round about z: the axle points to the right."""
    old = '<origin xyz="0.335 0.17 -0.175"/>\n    <axis'
    text = refused("urdf/explorer.urdf", old, old.replace('"/>', '" rpy="0 0 3.14159265"/>'))
    assert "wheel_middle_left_joint, axis" in text and "backwards" in text


def test_unknown_scenario_lists_those_that_exist() -> None:
    with pytest.raises(ConfigError, match=r"lunar_sample.*did you mean lunar_sample\?"):
        load_scenario("lunar_sampel")


def test_scenario_from_a_path(tmp_path: Path) -> None:
    text = (config_folder() / "scenarios" / "flat_drive.yaml").read_text(encoding="utf-8")
    (tmp_path / "mine.yaml").write_text(text.replace("seed: 1", "seed: 7"), encoding="utf-8")
    scenario = load_scenario(str(tmp_path / "mine.yaml"))
    assert (scenario.name, scenario.config.seed) == ("mine", 7)


def test_a_site_has_the_gravity_of_its_place() -> None:
    anywhere, pole = (load_scenario("flat_drive", told) for told in ([], ["site={latitude_deg: 90}"]))
    assert anywhere.site is None and anywhere.gravity == anywhere.body.surface_gravity
    assert pole.config.site is not None and pole.site == pole.config.site
    assert pole.gravity == pytest.approx(1.62323, rel=1e-5)
    assert pole.machine_body().gravity == pole.gravity


# --- overrides ---


def test_overrides_reach_every_file() -> None:
    scenario = load_scenario(
        "flat_drive",
        [
            "seed=9",
            "terrain.size_x=30",
            "steps[0].drive_to.x=1.5",
            "body=mars",
            "soil=jsc_1a",
            "soil.cohesion=900",
            "machine.drives[0].gear.ratio=900",
            "battery.capacity_ah=9",
            "drive.limits.max_speed=0.05",
            "arm.settle_time=0.3",
        ],
    )
    assert scenario.config.seed == 9
    assert scenario.terrain.size_x == 30.0
    assert scenario.config.steps[0].action.x == 1.5
    assert scenario.body.name == "mars"
    assert (scenario.soil.name, scenario.soil.cohesion) == ("jsc_1a", 900.0)
    assert scenario.machine.drives[0].gear.ratio == 900.0
    assert scenario.power.battery.capacity_ah == 9.0
    assert scenario.drive.limits.max_speed == 0.05
    assert scenario.arm.settle_time == 0.3
    assert scenario.overrides[0] == "seed=9"


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("soil.k_fi=1", ["--set k_fi=1", "config/soils/lunar_nominal.yaml", "did you mean k_phi?"]),
        ("steps[3].wait_s=1", ["--set steps[3].wait_s=1", "no index of a list of 1"]),
        ("battery_soc=full", ["--set battery_soc=full", "is text", "number"]),
        ("machine.wheels[0].radius=0.2", ["wheels[0].radius = 0.2", "0.125 m"]),
        ("terain.kind=flat", ["unknown key", "did you mean terrain?"]),
    ],
)
def test_wrong_override_is_refused(override: str, words: list[str]) -> None:
    with pytest.raises(ConfigError) as caught:
        load_scenario("flat_drive", [override])
    for word in words:
        assert word in str(caught.value)


ROCK = "config/soils/rigid_rock.yaml"
FIRM = "{model: wheel_and_ground_in_series, stiffness: 4.0e+4}"


def test_the_control_period_is_that_of_the_stamps() -> None:
    """Another one would be simulated, while all messages say 20 ms."""
    assert load_scenario("flat_drive", ["simulation.physics_step=0.002"]).simulation.substeps == 10
    with pytest.raises(ConfigError, match=r"simulation.control_period = 0.04: allowed is 0.02: the stamps"):
        load_scenario("flat_drive", ["simulation.control_period=0.04"])


def test_ground_that_lacks_what_a_contact_model_needs_is_refused_with_all_that_is_missing(workspace: Path) -> None:
    """Rock without the parameters of a soil will do for wheels of firm ground, and for no other."""
    rock = workspace / ROCK
    kept = [
        line for line in rock.read_text(encoding="utf-8").splitlines() if not line.startswith(("cohesion", "theta_m"))
    ]
    text = "\n".join(line for line in kept if not line.startswith(("  - cohesion", "  - theta_m")))
    rock.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        load_scenario("flat_drive")
    message = str(caught.value)
    for key in ("cohesion", "theta_m_c1", "theta_m_c2"):
        assert f"{ROCK}: {key}: the key is missing" in message
    assert "front_left (rigid_wheel_on_soil)" in message
    wheel = workspace / WHEEL
    wheel.write_text(f"{wheel.read_text(encoding='utf-8')}contact: {FIRM}\n", encoding="utf-8")
    loaded = load_scenario("flat_drive")
    assert {wheel.contact.model for wheel in loaded.machine.wheels} == {"wheel_and_ground_in_series"}


def test_the_soil_of_a_patch_is_asked_for_what_the_wheels_need_too(workspace: Path) -> None:
    text = (workspace / ROCK).read_text(encoding="utf-8").replace("name: rigid_rock", "name: bare_rock")
    text = text.replace("cohesion: 0.0", "# cohesion").replace("  - cohesion\n", "")
    (workspace / "config/soils/bare_rock.yaml").write_text(text, encoding="utf-8")
    patch = "{soil: bare_rock, shape: ellipse, x: 2.0, y: 0.0, length: 2.0, width: 1.0}"
    with pytest.raises(ConfigError, match=r"bare_rock.yaml: cohesion: the key is missing"):
        load_scenario("flat_drive", [f"terrain.soil_patches=[{patch}]"])
