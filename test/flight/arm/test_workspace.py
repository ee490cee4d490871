"""The workspace map against what geometry says."""

import math

import numpy as np
import pytest

from sojourn_analysis.arm.workspace import DIRECTIONS, workspace_map
from sojourn_config.arms import load_arm
from sojourn_flight.arm.dynamics import gravity_effort
from sojourn_flight.arm.inverse_search import spread
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.manipulability import largest_force, manipulability

EARTH = np.array([0.0, 0.0, -9.81])


def test_scara_is_a_ring_with_one_pointing() -> None:
    scara = load_arm("scara")
    found = workspace_map(scara, EARTH, postures=60_000, loaded_postures=5_000, cells=30)
    reached = np.isfinite(found.pointing)
    across = 0.5 * (found.across[1:] + found.across[:-1])
    height = 0.5 * (found.height[1:] + found.height[:-1])
    inner = math.sqrt(0.425**2 + 0.375**2 - 2 * 0.425 * 0.375 * math.cos(math.radians(180 - 147)))
    assert across[reached.any(axis=0)].min() == pytest.approx(inner, abs=0.03)
    assert found.reach_from_axis == pytest.approx(0.8, abs=1e-3)
    assert height[reached.any(axis=1)].max() - height[reached.any(axis=1)].min() == pytest.approx(0.195, abs=0.05)
    ring = math.radians(300) / 2 * (0.8**2 - inner**2) * 0.195
    assert found.volume == pytest.approx(ring, rel=0.15)
    assert found.one_way and np.nanmean(found.pointing[:, across > inner + 0.1]) > 0.9  # straight down, turned any way
    assert found.payload is not None
    assert np.nanmax(found.payload) == pytest.approx(400 / 9.81 - 2.8, rel=1e-3)  # the quill's effort less its own mass


def test_explorer_is_dexterous_in_the_middle_and_not_at_the_rim() -> None:
    explorer = load_arm("explorer_arm")
    found = workspace_map(explorer, EARTH, postures=200_000, loaded_postures=4_000, cells=24)
    across = 0.5 * (found.across[1:] + found.across[:-1])
    height = 0.5 * (found.height[1:] + found.height[:-1])
    distance = np.hypot(across[None, :] - 0.05, height[:, None] + 0.05)  # from the elevation joint
    assert np.nanmean(found.pointing[(distance > 0.3) & (distance < 0.6)]) > 0.9
    assert np.nanmean(found.pointing[distance > 0.95]) < 0.5
    assert np.all(np.isnan(found.pointing[distance > 1.03]))


def test_map_values_are_those_of_the_best_posture_in_each_cell() -> None:
    puma = load_arm("puma560")
    found = workspace_map(puma, EARTH, postures=400, loaded_postures=400, cells=6)
    best: dict[tuple[int, int], list[float]] = {}
    for q in spread(6, 400) * (puma.upper - puma.lower) + puma.lower:
        tip, holding = forward_kinematics(puma, q), gravity_effort(puma, q, EARTH)
        column = int(np.searchsorted(found.across, math.hypot(*tip.position[:2]), side="right")) - 1
        row = int(np.searchsorted(found.height, tip.position[2], side="right")) - 1
        lift = largest_force(puma, tip.jacobian, holding, np.array([0.0, 0.0, 1.0])) / 9.81
        worst = min(largest_force(puma, tip.jacobian, holding, side) for side in (*np.eye(3), *-np.eye(3)))
        values = [manipulability(tip.jacobian), lift, worst]
        cell = (min(row, len(found.height) - 2), min(column, len(found.across) - 2))
        best[cell] = [max(pair) for pair in zip(values, best.get(cell, values), strict=True)]
    assert found.payload is not None
    assert np.isfinite(found.pointing).sum() == len(best)
    for (row, column), (dexterity, lift, worst) in best.items():
        assert found.manipulability[row, column] == pytest.approx(dexterity, rel=1e-9)
        assert found.payload[row, column] == pytest.approx(lift, rel=1e-9)
        assert found.force[row, column] == pytest.approx(worst, rel=1e-9)


def test_an_arm_that_does_not_turn_its_tool_has_one_orientation() -> None:
    found = workspace_map(load_arm("cartesian"), EARTH, postures=5_000, loaded_postures=500, cells=12)
    assert found.one_way and np.nanmax(found.pointing) == pytest.approx(1.0 / DIRECTIONS)
    assert len(found.height) - 1 == 6, "0.6 m high, 1.2 m wide: no row too many by rounding"


def test_of_an_arm_that_cannot_hold_itself_the_force_is_without_weight() -> None:
    """The map used to be empty for arms that fly."""
    weighed = workspace_map(load_arm("srms"), EARTH, 4_000, 1_000, 12)
    weightless = workspace_map(load_arm("srms"), np.zeros(3), 4_000, 1_000, 12)
    assert weighed.weightless and not weightless.weightless
    np.testing.assert_allclose(weighed.force, weightless.force)


def test_every_cell_that_is_reached_is_asked_what_it_is_worth() -> None:
    """The rim used to lack manipulability and force: few samples are there."""
    found = workspace_map(load_arm("srms"), np.zeros(3), 40_000, 3_000, 20)
    assert np.array_equal(np.isnan(found.pointing), np.isnan(found.manipulability))


def test_no_weight_no_payload_figure() -> None:
    assert workspace_map(load_arm("srms"), np.zeros(3), 2_000, 500, 12).payload is None
