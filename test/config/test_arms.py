"""Arms by name and by file: every one loads; the URDFs made from tables are those in urdf/; errors are sentences."""

from pathlib import Path

import numpy as np
import pytest

from dh_chain import tip_transform
from sojourn_config.arms import arm_names, dh_file, generated_urdf, load_arm, read_dh
from sojourn_config.dh_to_urdf import GENERATED
from sojourn_config.errors import ConfigError
from sojourn_config.paths import urdf_folder
from sojourn_flight.arm.dh import geometry_of
from sojourn_flight.arm.dh_urdf import urdf_from_dh
from sojourn_flight.arm.kinematics import forward_kinematics

JOINTS = {"cartesian": 3, "cylindrical": 4, "explorer_arm": 5, "puma560": 6, "scara": 4, "srms": 6, "ssrms": 7}


@pytest.mark.parametrize("name", GENERATED)
def test_the_urdf_in_the_folder_is_that_of_the_table(name: str) -> None:
    assert (urdf_folder() / f"{name}.urdf").read_text(encoding="utf-8") == generated_urdf(dh_file(name))


def test_every_arm_is_known_and_has_its_joints() -> None:
    assert set(JOINTS) <= set(arm_names())
    assert "explorer" not in arm_names()  # a rover; its arm is explorer_arm
    for name, count in JOINTS.items():
        arm = load_arm(name)
        assert arm.joint_count == count
        assert np.all(arm.lower < arm.upper) and np.all(arm.max_velocity > 0.0) and np.all(arm.max_effort > 0.0)


@pytest.mark.parametrize("name", [*GENERATED, "ssrms"])
def test_a_table_and_its_urdf_put_the_tip_in_the_same_place(name: str) -> None:
    # The ssrms is written by hand from the frames of its source; its table was not made from that file.
    arm, geometry = load_arm(name), geometry_of(read_dh(dh_file(name)))
    generator = np.random.default_rng(3)
    for _ in range(20):
        positions = generator.uniform(arm.lower, arm.upper)
        tip, expected = forward_kinematics(arm, positions), tip_transform(geometry, positions)
        np.testing.assert_allclose(tip.position, expected[:3, 3], atol=1e-12 * max(arm.reach, 1.0))
        np.testing.assert_allclose(tip.rotation, expected[:3, :3], atol=1e-12)


def test_a_table_or_a_urdf_from_anywhere_is_an_arm(tmp_path: Path) -> None:
    table = tmp_path / "mine.yaml"
    table.write_text(
        dh_file("scara").read_text(encoding="utf-8").replace("name: scara", "name: mine"), encoding="utf-8"
    )
    urdf = tmp_path / "mine.urdf"
    urdf.write_text(urdf_from_dh(read_dh(table), "test"), encoding="utf-8")
    for path in (table, urdf):
        arm = load_arm(str(path))
        assert arm.name == "mine" and arm.joint_count == 4
        assert arm.motor_inertia == pytest.approx(load_arm("scara").motor_inertia)


def test_the_explorers_arm_has_the_motors_of_the_rover() -> None:
    arm = load_arm("explorer_arm")
    assert arm.motor_inertia[0] == pytest.approx(1.08e-6 * 2000.0**2)
    # the gear's own friction, and what the motor draws at no load
    assert arm.friction.forward[0] == pytest.approx(1.0 + 0.0369 * 0.0234 * 2000.0, rel=1e-4)
    assert arm.friction.viscous[0] == pytest.approx(2.0)


def test_a_rover_stands_for_its_arm_and_its_urdf_for_the_longest_line_of_joints() -> None:
    arm = load_arm("explorer")
    assert arm.name == "explorer_arm"
    assert load_arm(str(urdf_folder() / "explorer_arm.urdf")).joint_names == arm.joint_names


def test_an_unknown_arm_is_answered_with_the_list(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"allowed is one of cartesian, .*puma560.*; did you mean puma560\?"):
        load_arm("puma")
    with pytest.raises(ConfigError, match="there is no such file"):
        load_arm(str(tmp_path / "nothing.urdf"))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<robot name='a'><link name='b'/></robot>", "no joint moves"),
        ("<robot name='a'><link name='b'/><link name='c'/></robot>", "2 outermost links"),
        ("<machine/>", "outermost element is 'machine'"),
        ("robot", "not an XML document"),
    ],
)
def test_a_urdf_without_an_arm_is_refused(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "bad.urdf"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError, match=words):
        load_arm(str(path))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("convention: modified", "convention: craig", "convention"),
        ("lower: 0\n", "lower: 0.2\n", "allowed is lower below upper"),
        ("gear_ratio: 314.16", "gear_ratio: 0", "gear_ratio other than 0"),
        ("name: elbow_joint", "name: shoulder_joint", "twice"),
        ("mass: 22.0", "mass: -1", "mass"),
    ],
)
def test_a_wrong_table_is_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    text = dh_file("scara").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "bad.yaml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ConfigError, match=words):
        load_arm(str(path))
