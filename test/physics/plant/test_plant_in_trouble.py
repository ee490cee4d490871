"""Drops, tip-overs, a step, free fall: forces stay finite, energy is kept, a roll-over is told."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

Machines = Callable[..., Any]
ROLL_OVER = math.radians(75.0)


def watched_run(machine: Any, state: Any, seconds: float, tilt_of: Callable[[Any], float], rate: float = 0.0) -> Any:
    """The end state; checks on the way that everything is finite, and that a roll-over is told when it happens."""
    beyond = False
    forces = 0.0

    def watch(now: Any, output: Any) -> None:
        nonlocal beyond, forces
        beyond = beyond or tilt_of(now) > ROLL_OVER
        forces = max(forces, float(np.abs(output.contacts[:, 6:9]).max()))
        assert now.rolled_over == beyond
        assert all(np.isfinite(part).all() for part in (now.joints, *now.supports, output.contacts, output.efforts))

    end = machine.run(seconds, machine.hold(rate), state, watch)
    assert forces < 100.0 * machine.weight
    return end


@pytest.mark.parametrize("soil", ["lunar_nominal", "rigid_rock"])
@pytest.mark.parametrize(
    ("axis", "angle", "lift", "rolled"),
    [("x", 0.0, 0.3, False), ("x", 1.6, 0.5, True), ("y", 3.1, 0.8, True), ("y", 1.0, 0.9, None)],
    ids=["dropped", "on the side", "upside down", "on its nose"],
)
def test_thrown_down(
    machine: Machines, tilt_of: Any, soil: str, axis: str, angle: float, lift: float, rolled: bool | None
) -> None:
    one = machine("flat_drive", f"soil={soil}")
    thrown = one.thrown(axis, angle, lift)
    first = one.run(0.02, state=thrown)
    end = watched_run(one, first, 8.0, tilt_of)
    assert end.energy.balance_error(first.energy) < 1e-3
    assert -0.2 < end.configuration[2] < 2.0
    assert np.abs(end.velocity).max() < 0.5
    if rolled is not None:
        assert end.rolled_over == rolled


def test_driven_off_a_step(machine: Machines, tilt_of: Any) -> None:
    terrain = "{kind: step, step_height: -0.4, step_x: 0.5, size_x: 20.0, size_y: 20.0}"
    one = machine("flat_drive", f"terrain={terrain}")
    end = watched_run(one, one.start, 25.0, tilt_of, rate=0.8)
    assert end.configuration[2] < one.start.configuration[2] - 0.1
    assert end.energy.balance_error(one.start.energy) < 1e-3


def test_driven_off_the_map_is_told(machine: Machines) -> None:
    one = machine("flat_drive", "start.x=8.0")
    assert not one.start.off_terrain
    end = one.run(20.0, one.hold(0.8))
    assert end.off_terrain
    assert np.isfinite(end.configuration).all()


def test_free_fall(flat: Any) -> None:
    """High over the ground: the centre of mass falls with g, and the turning of the whole machine is kept."""
    high = flat.thrown("x", 0.4, 100.0)
    high.velocity[3:6] = [0.3, -0.2, 0.5]
    data = flat.model.multibody.createData()

    def momentum(state: Any) -> Any:
        pin.computeCentroidalMomentum(flat.model.multibody, data, state.configuration, state.velocity)
        return data.hg.linear.copy(), data.hg.angular.copy(), data.com[0].copy()

    command = flat.hold()
    command.load_fractions[:] = 0.0
    before = momentum(high)
    state = flat.run(2.0, command, high)
    after = momentum(state)
    g = flat.model.gravity
    fallen = after[0] - before[0]
    assert np.allclose(fallen, [0.0, 0.0, -flat.model.mass * g * 2.0], rtol=1e-6, atol=2e-2 * flat.model.mass * g)
    assert np.allclose(after[1], before[1], atol=1e-2 * np.linalg.norm(before[1]))
    assert after[2][2] - before[2][2] == pytest.approx(before[0][2] / flat.model.mass * 2.0 - 2.0 * g, rel=1e-2)
