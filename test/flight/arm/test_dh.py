"""Denavit-Hartenberg: both conventions, both ways, against products of transforms written out here."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from dh_chain import tip_transform
from sojourn_flight.arm.chain import Chain
from sojourn_flight.arm.dh import DhTable, geometry_of, in_convention, pose
from sojourn_flight.arm.dh_extract import dh_of_chain
from sojourn_flight.arm.dh_urdf import urdf_from_dh
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.serial_arm import build_serial_arm

SEEDS = st.integers(min_value=0, max_value=2**32 - 1)
Array = NDArray[np.float64]


def _transform(rotation: Rotation, translation: tuple[float, float, float]) -> Array:
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = rotation.as_matrix(), translation
    return transform


def _random_table(generator: np.random.Generator, convention: str, count: int) -> DhTable:
    """Angles and lengths of any size, with the special ones (0, right angles) mixed in."""

    def angle() -> float:
        return float(generator.choice([0.0, 90.0, -90.0, 180.0, generator.uniform(-170, 170)]))

    def length() -> float:
        return float(generator.choice([0.0, generator.uniform(-1.0, 1.0)]))

    joints = [
        {
            "name": f"j{i}", "kind": str(generator.choice(["revolute", "revolute", "prismatic"])), "theta_deg": angle(),
            "d": length(), "a": length(), "alpha_deg": angle(), "lower": -1.0, "upper": 1.0, "velocity": 1.0,
            "effort": 1.0,
        }
        for i in range(count)
    ]  # fmt: skip
    return DhTable.model_validate(
        {
            "name": "random", "convention": convention, "joints": joints, "base_xyz": (0.1, 0.2, 0.3),
            "base_rpy_deg": (angle(), angle(), 30.0), "tool_xyz": (0, -0.1, 0.2), "tool_rpy_deg": (10.0, angle(), 0.0),
        }
    )  # fmt: skip


def _written_out(table: DhTable, q: Array) -> Array:
    """The product of A_i as the two textbooks have it, with another library's rotations."""
    t = _transform(Rotation.from_euler("xyz", table.base_rpy_deg, degrees=True), table.base_xyz)
    for i, row in enumerate(table.joints):
        theta = math.radians(row.theta_deg) + (q[i] if row.kind == "revolute" else 0.0)
        d = row.d + (q[i] if row.kind == "prismatic" else 0.0)
        about_z = _transform(Rotation.from_euler("z", theta), (0, 0, d))
        about_x = _transform(Rotation.from_euler("x", row.alpha_deg, degrees=True), (row.a, 0, 0))
        t = t @ about_z @ about_x if table.convention == "standard" else t @ about_x @ about_z
    return t @ _transform(Rotation.from_euler("xyz", table.tool_rpy_deg, degrees=True), table.tool_xyz)


@pytest.mark.parametrize("convention", ["standard", "modified"])
@given(seed=SEEDS)
@settings(max_examples=25, deadline=None)
def test_table_urdf_and_chain_agree_with_the_product(convention: str, seed: int) -> None:
    generator = np.random.default_rng(seed)
    count = int(generator.integers(1, 8))
    table = _random_table(generator, convention, count)
    arm = build_serial_arm(urdf_from_dh(table, "test"))
    extracted = {kind: dh_of_chain(arm.chain, kind) for kind in ("standard", "modified")}
    for _ in range(3):
        q = generator.uniform(-1.0, 1.0, count)
        expected = _written_out(table, q)
        np.testing.assert_allclose(tip_transform(geometry_of(table), q), expected, atol=1e-12)
        tip = forward_kinematics(arm, q)
        np.testing.assert_allclose(tip.position, expected[:3, 3], atol=1e-11)
        np.testing.assert_allclose(tip.rotation, expected[:3, :3], atol=1e-11)
        for geometry in extracted.values():
            np.testing.assert_allclose(tip_transform(geometry, q), expected, atol=1e-7)
    # each convention has no column for one of its ends
    assert extracted["standard"].a[0] == extracted["standard"].alpha[0] == 0.0
    assert extracted["modified"].a[-1] == extracted["modified"].alpha[-1] == 0.0


@given(seed=SEEDS)
@settings(max_examples=20, deadline=None)
def test_axes_in_general_position_give_their_parameters_back(seed: int) -> None:
    """Where no axes are parallel or meet, the parameters are unique up to the sense of a normal."""
    generator = np.random.default_rng(seed)
    joints = [
        {
            "name": f"j{i}", "theta_deg": generator.uniform(-170, 170), "d": generator.uniform(0.1, 1.0),
            "a": generator.uniform(0.1, 1.0), "alpha_deg": generator.uniform(20, 160), "lower": -1, "upper": 1,
            "velocity": 1, "effort": 1,
        }
        for i in range(5)
    ]  # fmt: skip
    table = DhTable.model_validate({"name": "general", "convention": "standard", "joints": joints})
    found = dh_of_chain(build_serial_arm(urdf_from_dh(table, "test")).chain, "standard")
    expected = geometry_of(table)
    np.testing.assert_allclose(found.a[1:-1], expected.a[1:-1], atol=1e-9)
    np.testing.assert_allclose(found.alpha[1:-1], expected.alpha[1:-1], atol=1e-9)
    np.testing.assert_allclose(found.d[1:-1], expected.d[1:-1], atol=1e-9)
    np.testing.assert_allclose(np.cos(found.theta[1:-1]), np.cos(expected.theta[1:-1]), atol=1e-9)
    np.testing.assert_allclose(np.sin(found.theta[1:-1]), np.sin(expected.theta[1:-1]), atol=1e-9)


def test_changing_convention_changes_no_place() -> None:
    table = _random_table(np.random.default_rng(5), "standard", 6)
    geometry, q = geometry_of(table), np.linspace(-1.0, 1.0, 6)
    there = in_convention(geometry, "modified")
    np.testing.assert_allclose(tip_transform(there, q), tip_transform(geometry, q), atol=1e-12)
    np.testing.assert_allclose(
        tip_transform(in_convention(there, "standard"), q), tip_transform(geometry, q), atol=1e-12
    )


def test_roll_pitch_yaw_is_that_of_urdf() -> None:
    angles = np.array([0.3, -0.7, 1.9])
    np.testing.assert_allclose(
        pose((0, 0, 0), angles)[:3, :3], Rotation.from_euler("xyz", angles).as_matrix(), atol=1e-15
    )


def test_masses_of_a_standard_table_stay_where_they_are() -> None:
    """The centre of mass of a body given in frame i of the standard convention, placed by the table alone."""
    row = {"name": "j", "d": 0.3, "a": 0.5, "alpha_deg": 40.0, "lower": -1, "upper": 1, "velocity": 1, "effort": 1}
    link = {"mass": 2.0, "com": (0.1, -0.2, 0.05), "inertia": (0.03, 0.02, 0.04, 0.001, 0.002, -0.001)}
    table = DhTable.model_validate({"name": "one", "convention": "standard", "joints": [{**row, "link": link}]})
    arm = build_serial_arm(urdf_from_dh(table, "test"))
    frame = _written_out(table, np.zeros(1))
    body = arm.pinocchio_model.jointPlacements[1].act(arm.pinocchio_model.inertias[1])
    np.testing.assert_allclose(body.lever, frame[:3, :3] @ link["com"] + frame[:3, 3], atol=1e-12)
    xx, yy, zz, xy, yz, xz = link["inertia"]
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    np.testing.assert_allclose(body.inertia, frame[:3, :3] @ tensor @ frame[:3, :3].T, atol=1e-12)


def test_one_axis_twice_and_axes_that_meet() -> None:
    """Degenerate neighbours: collinear, crossing, and parallel axes in one chain."""
    count = 4
    rotation = np.stack([np.eye(3), np.eye(3), Rotation.from_euler("x", 90, degrees=True).as_matrix(), np.eye(3)])
    chain = Chain(
        rotation=rotation,
        translation=np.array([[0, 0, 0.1], [0, 0, 0.2], [0, 0, 0.3], [0.4, 0, 0.0]], dtype=float),
        axis=np.tile([0.0, 0.0, 1.0], (count, 1)),
        revolute=np.ones(count),
        tip_rotation=np.eye(3),
        tip_translation=np.array([0.1, 0.2, 0.3]),
        tool_axis=np.array([0.0, 0.0, 1.0]),
    )
    geometry = dh_of_chain(chain, "standard")
    np.testing.assert_allclose(geometry.a[1:4], [0.0, 0.0, 0.4], atol=1e-12)
    np.testing.assert_allclose(np.degrees(geometry.alpha[1:4]), [0.0, 90.0, 0.0], atol=1e-9)
