"""URDFs that no machine can have: each is refused with its element and what is allowed."""

from pathlib import Path

import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.paths import config_folder, urdf_folder
from sojourn_config.scenario import load_scenario
from sojourn_config.urdf import parse_urdf, read_urdf
from sojourn_config.urdf_checks import MOST_BYTES

URDF = """<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <link name="base_link"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
  <link name="tip"><collision><geometry><cylinder radius="0.1" length="0.2"/></geometry></collision></link>
  <joint name="turn" type="revolute">
    <parent link="base_link"/><child link="tip"/>
    <limit lower="-1" upper="1" velocity="2" effort="3"/>
  </joint>
</robot>
"""


def test_the_example_is_good() -> None:
    assert parse_urdf(URDF, "a.urdf").joints["turn"].upper == 1.0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('lower="-1" upper="1"', 'lower="9" upper="-9"', "joint turn, limit lower = 9: allowed is at most upper"),
        ('velocity="2"', 'velocity="-2"', "joint turn, limit velocity = -2: allowed is 0 or more"),
        ('effort="3"', 'effort="-3"', "joint turn, limit effort = -3: allowed is 0 or more"),
        ('radius="0.1"', 'radius="-0.1"', "link tip, cylinder radius = '-0.1': allowed is a number above 0 m"),
        ('length="0.2"', 'length="nan"', "link tip, cylinder length"),
        ('size="1 1 1"', 'size="1 0 1"', "link base_link, box size = '1 0 1': allowed is three numbers above 0 m"),
        ("</robot>", '<xacro:include filename="more.xacro"/></robot>', "xacro:include: is xacro"),
        ('<box size="1 1 1"/>', '<xacro:box/>', "xacro:box: is xacro"),
    ],
)  # fmt: skip
def test_what_no_machine_has_is_refused(old: str, new: str, words: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_urdf(URDF.replace(old, new), "a.urdf")
    assert words in str(caught.value) and "a.urdf" in str(caught.value)


@pytest.mark.parametrize("where", ["tip.stl", "package://mine/meshes/tip.stl", "file:///nowhere/tip.stl", ""])
def test_a_mesh_that_is_not_there_is_refused(tmp_path: Path, where: str) -> None:
    path = tmp_path / "mine" / "urdf" / "a.urdf"
    path.parent.mkdir(parents=True)
    path.write_text(URDF.replace('<box size="1 1 1"/>', f'<mesh filename="{where}"/>'), encoding="utf-8")
    with pytest.raises(ConfigError, match=r"link base_link, mesh.*there is no such file"):
        read_urdf(path)


@pytest.mark.parametrize("where", ["tip.stl", "package://mine/meshes/tip.stl"])
def test_a_mesh_that_is_there_is_accepted(tmp_path: Path, where: str) -> None:
    path = tmp_path / "mine" / "urdf" / "a.urdf"
    for folder in ("urdf", "meshes"):
        (tmp_path / "mine" / folder).mkdir(parents=True)
        (tmp_path / "mine" / folder / "tip.stl").write_text("solid", encoding="utf-8")
    path.write_text(URDF.replace('<box size="1 1 1"/>', f'<mesh filename="{where}"/>'), encoding="utf-8")
    assert read_urdf(path).links == ("base_link", "tip")


def test_a_file_that_is_too_large_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "a.urdf"
    path.write_text(URDF + " " * MOST_BYTES, encoding="utf-8")
    with pytest.raises(ConfigError, match="allowed are at most"):
        read_urdf(path)


@pytest.mark.parametrize("path", sorted(urdf_folder().glob("*.urdf")), ids=lambda path: path.stem)
def test_all_of_ours_are_good(path: Path) -> None:
    read_urdf(path)


def test_a_soil_without_stiffness_under_the_wheels_is_refused() -> None:
    """k_c may be negative, as some fits have it, for plates wider than -k_c / k_phi."""
    assert load_scenario("flat_drive", ["soil=kls_1"]).config.soil == "kls_1"
    with pytest.raises(ConfigError, match=r"k_c = -400000.*the ground pulls at"):
        load_scenario("flat_drive", ["soil.k_c=-400000.0", "soil.k_phi=1e6"])
    with pytest.raises(ConfigError, match=r"below it the soil carries no wheel"):
        load_scenario("flat_drive", ["soil.k_c=-1e9"])
    assert (config_folder() / "soils" / "kls_1.yaml").exists()
