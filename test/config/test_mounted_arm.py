"""An arm with a URDF of its own on a machine: what it brings along, its names there, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from sojourn_config.arm_config import ArmConfig
from sojourn_config.arms import load_arm
from sojourn_config.errors import ConfigError
from sojourn_config.load import load_params
from sojourn_config.paths import available
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_config.still_machine import StillMachine
from sojourn_flight.arm.dynamics import rigid_effort
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import build_arm_model

ALONE = [name for name in available("arms") if load_params("arms", name, ArmConfig).urdf is not None]
MOUNT = "machine.arm_mount={link: base_link, xyz: [0.1, 0, 0.2], rpy: [0, 0, 0.5]}"
SLOW = "arm.max_velocity=[0.8, 0.7, 1.2, 2.0, 2.0, 2.0]"
"""As far as the bus of that rover can drive it, of 20 V when its battery is empty."""
ON_SKID = ["machine=skid", "machine.arm=puma560", MOUNT, SLOW]
CYLINDRICAL = ["machine=skid", "machine.arm=cylindrical"]


@pytest.fixture(scope="module")
def carried() -> LoadedScenario:
    return load_scenario("flat_drive", ON_SKID)


def test_it_brings_its_drives_encoders_and_load_along(carried: LoadedScenario) -> None:
    alone = load_scenario("flat_drive", ["machine=skid"])
    params = load_params("arms", "puma560", ArmConfig)
    assert carried.arm_joints == tuple(f"arm_{name}" for name in params.joint_names)
    assert carried.urdf.moving_joints == (*alone.urdf.moving_joints, *carried.arm_joints)
    driven = [joint for drive in carried.machine.drives for joint in drive.joints]
    assert driven[-6:] == list(carried.arm_joints) and len(driven) == 10
    measured = [joint for group in carried.sensors.joint_groups.values() for joint in group.joints]
    assert measured == driven
    assert [load.name for load in carried.power.loads] == [*(load.name for load in alone.power.loads), "arm"]
    assert carried.power.loads[-1] == params.load
    assert carried.carried_arm().reflected_inertia[1] == pytest.approx(200e-6 * 107.815**2)


def test_its_masses_and_its_reach_are_added_where_it_is_bolted_on(carried: LoadedScenario) -> None:
    skid = load_scenario("flat_drive", ["machine=skid"])
    total = sum(inertial.mass for inertial in carried.urdf.inertials.values())
    assert total == pytest.approx(sum(i.mass for i in skid.urdf.inertials.values()) + 17.4 + 4.8 + 0.82 + 0.34 + 0.09)
    arm, own = build_arm_model(carried.urdf_xml, carried.carried_arm()), load_arm("puma560")
    turn = np.array([[np.cos(0.5), -np.sin(0.5), 0.0], [np.sin(0.5), np.cos(0.5), 0.0], [0.0, 0.0, 1.0]])
    for positions in np.random.default_rng(1).uniform(own.lower, own.upper, (5, 6)):
        there, alone = forward_kinematics(arm, positions), forward_kinematics(own, positions)
        np.testing.assert_allclose(there.position, turn @ alone.position + [0.1, 0.0, 0.2], atol=1e-12)
        np.testing.assert_allclose(there.rotation, turn @ alone.rotation, atol=1e-12)


@pytest.mark.parametrize("name", ALONE)
def test_drives_and_encoders_fit_motors_and_gears_of_the_urdf(name: str) -> None:
    params, arm = load_params("arms", name, ArmConfig), load_arm(name)
    drives = {joint: drive for drive in params.drives for joint in drive.joints}
    encoders = {joint: group.encoder for group in params.joint_groups.values() for joint in group.joints}
    assert params.joint_names == arm.joint_names and set(drives) == set(encoders) == set(arm.joint_names)
    for index, joint in enumerate(arm.joint_names):
        drive = drives[joint]
        assert drive.servo.max_torque <= arm.max_effort[index]
        assert drive.motor_effort > 0.97 * drive.servo.max_torque, f"{joint}: the current stops it before the servo"
        if encoders[joint].side == "motor":
            assert encoders[joint].gear_ratio == pytest.approx(drive.transmission.ratio, rel=1e-9)
        if arm.motor_inertia[index] > 0.0:  # the URDF has a motor
            assert drive.reflected_inertia == pytest.approx(arm.motor_inertia[index], rel=1e-3)
            mean = 0.5 * (arm.friction.forward[index] + arm.friction.backward[index])
            assert drive.friction_torque == pytest.approx(mean, rel=0.01)
            assert drive.viscous_friction == pytest.approx(arm.friction.viscous[index], rel=0.01)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (
            ["machine=skid", "machine.arm=puma560", 'machine.arm_mount={link: base_link, prefix: ""}'],
            ["link base_link", "is in urdf/puma560.urdf too", "another arm_mount.prefix"],
        ),
        (
            [*ON_SKID, "machine.arm_mount.link=deck"],
            ["arm_mount.link = 'deck'", "is no link of urdf/skid.urdf", "base_link"],
        ),
        (
            ["machine=skid", "machine.arm=puma560"],
            ["config/machines/skid/machine.yaml: arm_mount", "where puma560 stands"],
        ),
        (
            ["machine=explorer_arm", "arm.urdf=null"],
            ["config/machines/explorer_arm/machine.yaml:", "arm_mount", "explorer_arm has no URDF of its own"],
        ),
        (
            ["machine=explorer_arm", "arm.urdf=explorr_arm.urdf"],
            ["urdf = 'explorr_arm.urdf'", "mean explorer_arm.ur"],
        ),
        (
            ["machine=explorer_arm", "arm.urdf_root=arm_link"],
            ["urdf_root = 'arm_link'", "is no link of urdf/explorer_arm.urdf"],
        ),
        (["machine=puma560", "arm.joint_groups={}"], ["joint_names[0] = 'arm_waist_joint'", "has no encoder"]),
        (["machine=puma560", "arm.drives=[]"], ["joint_names[5] = 'arm_flange_joint'", "has no drive"]),
        (
            ["machine=puma560", "arm.tip_link=waist_link"],
            ["joint_names", "towards arm_waist_link, which hangs on"],
        ),
        ([*ON_SKID, "machine.arm_mount.prefix=Arm"], ["arm_mount.prefix = 'Arm'", "lower case, ends with _"]),
        ([*ON_SKID, "machine.arm_mount.xyz=[0, 0]"], ["arm_mount.xyz", "[m]"]),
        (
            [*ON_SKID, "arm.drives[0].load=drill"],
            ["drives[0].load = 'drill'", "config/arms/puma560.yaml", "no load of the bus"],
        ),
        (
            [*ON_SKID, "arm.drives[1].servo.max_torque=200"],
            ["max_torque = 200", "at most 186.4 N m", "arm_shoulder_joint"],
        ),
        ([*ON_SKID, "arm.joint_groups.waist.joints=[hip_joint]"], ["joint_groups.waist.joints[0]", "arm_hip_joint"]),
        (["machine=puma560", "drive.goal_tolerance=1"], ["drive.goal_tolerance=1", "a stand does not drive"]),
        (["machine=puma560"], ["steps[0].drive_to", "puma560 stands fast: it has no wheels"]),
        (["machine=puma560", "machine.fixed_base=false"], ["fixed_base = false", "allowed is one of True"]),
        (["machine=skid", "machine.fixed_base=true"], ["fixed_base = true", "allowed is one of False"]),
        (["machine=skid", "machine.wheels=[]"], ["wheels", "fixed_base = true"]),
        (["machine=skid", "drive=null"], ["drive = null", "allowed is a table with the keys"]),
        (["machine=puma560", "machine.arm=null"], ["arm", "nothing moves on a fixed base"]),
        (
            ["machine=skid", "machine.arm=puma560", MOUNT],
            ["max_velocity[1] = 1.0", "empty stores give 19.9 V", "allowed is some 0.7"],
        ),
        (
            [*CYLINDRICAL, "machine.arm_mount={link: base_link, xyz: [1.2, 0, 0]}"],
            ["arm_mount = 'cylindrical'", "tips the machine over in pose 'stow'", "0.21 m outside the wheels"],
        ),
        (
            ["machine=lrv", "machine.arm=srms", "machine.arm_mount={}"],
            ["named_poses.stow", "arm_shoulder_pitch_joint would hold 38", "allowed is 1570 N m"],
        ),
        (["body=low_earth_orbit"], ["body = 'low_earth_orbit'", "free fall", "explorer does not press"]),
    ],
)
def test_what_does_not_fit_is_refused(overrides: list[str], words: list[str]) -> None:
    with pytest.raises(ConfigError) as caught:
        load_scenario("flat_drive", overrides)
    for word in words:
        assert word in str(caught.value)


def test_the_explorers_arm_comes_with_what_the_explorer_has_of_it() -> None:
    stand, explorer = load_scenario("explorer_arm_course"), load_scenario("flat_drive")
    assert stand.arm_joints == stand.urdf.moving_joints == explorer.arm_joints  # its mount has no prefix
    own = {joint: drive for drive in explorer.machine.drives for joint in drive.joints}
    assert {joint: drive for drive in stand.machine.drives for joint in drive.joints} == {
        joint: own[joint] for joint in stand.arm_joints
    }
    for group in ("arm", "wrist"):
        assert stand.sensors.joint_groups[group] == explorer.sensors.joint_groups[group]
    assert stand.sensors.named["wrist"] == explorer.sensors.named["wrist"]
    assert stand.machine.wrench_sensor_link == explorer.machine.wrench_sensor_link
    assert [pad.name for pad in stand.machine.pads] == ["arm_tip"] and stand.tool == explorer.tool
    mass = sum(inertial.mass for name, inertial in stand.urdf.inertials.items() if name != "base_link")
    links = explorer.urdf.below("arm_mount_link")
    assert mass == pytest.approx(sum(i.mass for name, i in explorer.urdf.inertials.items() if name in links))


def test_a_denavit_hartenberg_table_stands_for_its_urdf() -> None:
    drawn, tabled = load_scenario("puma560_course"), load_scenario("puma560_course", ["arm.urdf=dh/puma560.yaml"])
    assert "config/arms/dh/puma560.yaml" in tabled.files and "urdf/puma560.urdf" not in tabled.files
    one, other = (build_arm_model(each.urdf_xml, each.carried_arm()) for each in (drawn, tabled))
    for positions in np.random.default_rng(4).uniform(one.lower, one.upper, (5, 6)):
        here, there = forward_kinematics(one, positions), forward_kinematics(other, positions)
        np.testing.assert_allclose(here.position, there.position, atol=1e-12)
    with pytest.raises(ConfigError, match=r"config/arms/dh/explorer\.yaml|not in urdf/"):
        load_scenario("puma560_course", ["arm.urdf=dh/explorer.yaml"])


def test_who_carries_it_well_is_let_be() -> None:
    load_scenario("flat_drive", [*CYLINDRICAL, "machine.arm_mount={link: base_link, xyz: [0.1, 0, 0]}"])


def test_what_a_joint_would_hold_is_what_rigid_body_dynamics_says(carried: LoadedScenario) -> None:
    params = carried.carried_arm()
    model = build_arm_model(carried.urdf_xml, params)
    down = np.array([0.0, 0.0, -carried.gravity])
    for positions in np.random.default_rng(2).uniform(model.lower, model.upper, (5, 6)):
        still = StillMachine(carried.urdf, dict(zip(params.joint_names, positions, strict=True)))
        wanted = rigid_effort(model, positions, np.zeros(6), np.zeros(6), down)
        found = [still.held_by(name, carried.gravity) for name in params.joint_names]
        np.testing.assert_allclose(found, wanted, atol=1e-9)


def test_a_sliding_joint_holds_the_weight_on_it() -> None:
    gantry = load_scenario("cartesian_course")
    still = StillMachine(gantry.urdf, gantry.arm_pose("unfold"))
    assert still.held_by("arm_z_joint", 9.81) == pytest.approx(-3.0 * 9.81)  # it slides down: it holds back
    assert still.held_by("arm_x_joint", 9.81) == pytest.approx(0.0, abs=1e-9)


def test_a_broken_urdf_of_the_arm_is_told_with_its_file(tmp_path: Path) -> None:
    urdf = tmp_path / "half.urdf"
    urdf.write_text("<robot name='half'><link name='a'/>", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"half\.urdf.*not an XML document"):
        load_scenario("flat_drive", [*ON_SKID, f"arm.urdf={urdf}"])
