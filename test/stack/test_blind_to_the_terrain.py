"""What would fly knows no bounds of the simulated ground: its maps lie round where it stands."""

import pickle
from dataclasses import replace
from typing import Any

import pytest

from sojourn_config.scenario import load_scenario
from sojourn_contract.app import App
from sojourn_stack.apps import make_apps

ELSEWHERE = [
    "terrain.kind=generated", "terrain.size_x=61", "terrain.size_y=47", "terrain.center_x=3", "terrain.center_y=-2",
    "terrain.resolution=0.25",
]  # fmt: skip


def flying(role: str, overrides: list[str]) -> App[object]:
    return make_apps(load_scenario("lunar_sample", overrides), (role,))[role]


def untold_of_height(app: App[Any]) -> Any:
    """Its first state without the height at which it is said to stand, which is all that it is told of the ground."""
    state = app.initial_state()
    if not hasattr(state, "drive"):
        return state
    odometry = replace(state.drive.odometry, z=0.0)
    return replace(
        state, drive=replace(state.drive, odometry=odometry), output=replace(state.output, odometry=odometry)
    )


@pytest.mark.parametrize("role", ["drive", "arm", "power"])
def test_its_first_state_is_the_same_on_any_ground(role: str) -> None:
    here, there = (pickle.dumps(untold_of_height(flying(role, overrides))) for overrides in ([], ELSEWHERE))
    assert here == there


def test_the_maps_of_the_drive_lie_round_its_start() -> None:
    """A start that is moved moves them; beyond what is simulated they are as large."""
    corners = []
    for x, y in ((0.0, 0.0), (14.0, -9.0)):
        ground = [f"terrain.center_x={x}", f"terrain.center_y={y}"]
        app = flying("drive", [f"start.x={x}", f"start.y={y}", *ground])
        seen = app.initial_state().drive.avoidance  # type: ignore[attr-defined]
        for grid in (seen.map, seen.wide):
            size = grid.cell * grid.layers.shape[1]
            corners += [grid.x0 - x, grid.y0 - y, size]
            assert grid.x0 + 0.5 * size == pytest.approx(x, abs=2.0 * grid.cell)
            assert grid.y0 + 0.5 * size == pytest.approx(y, abs=2.0 * grid.cell)
    assert corners[:6] == pytest.approx(corners[6:], abs=0.5)
