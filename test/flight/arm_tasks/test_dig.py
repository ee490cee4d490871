"""Digging: forces against the law that the plant's soil has, energy, and what gives way."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sojourn_machine.supports import ScoopParams
from sojourn_physics.contact.rows import cut_of


def test_a_furrow_in_lunar_soil(rover_arm: Callable[..., Any]) -> None:
    rover = rover_arm("soil=lunar_nominal")
    rover.over_ground(1.2, 0.0, 0.02)
    start, energy = len(rover.log), rover.plant.energy
    report = rover.task("dig", 60.0, depth=0.015, length=0.06)
    assert report.doing.state == "reached", report
    figures = report.doing.figures
    force, tip = rover.since("force", start), rover.since("tip", start)
    assert figures["depth_m"] == pytest.approx(0.015, abs=0.002)
    assert figures["peak_force_n"] == pytest.approx(force[:, 2].max(), rel=0.08)
    # the drag: friction under the tool's end and McKyes' cut of its flank, against the way
    dragging = np.flatnonzero((force[:, 2] > 5.0) & (tip[:, 0] < tip[:, 0].max() - 0.03))
    row = dragging[len(dragging) // 2]
    soil = rover.scenario.soils["lunar_nominal"]
    scoop: ScoopParams = rover.scenario.tool.cut
    cut = cut_of(scoop, soil, rover.model.gravity)
    area, depth = np.pi * 0.018**2, -tip[row, 2]
    friction = force[row, 2] * np.tan(np.radians(soil.friction_angle_deg)) + area * soil.cohesion
    most = friction + depth * (cut.linear + depth * (cut.quadratic + depth * cut.cubic))
    slid, modulus = tip[:, 0].max() - tip[row, 0], soil.shear_modulus
    displacement = 4.0 * modulus * (1.0 - np.exp(-slid / (4.0 * modulus)))  # what the ground remembers of the way
    expected = most * (1.0 - np.exp(-displacement / modulus))
    assert np.hypot(force[row, 0], force[row, 1]) == pytest.approx(expected, rel=0.08)
    assert force[row, 0] > 0.0, "against the way towards the rover"
    # what the arm felt as work went into the soil
    work = -float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(tip, axis=0)))
    assert rover.plant.energy.soil_work - energy.soil_work == pytest.approx(work, rel=0.1)
    assert figures["work_j"] == pytest.approx(work, rel=0.15)
    assert rover.log[-1]["force"] == pytest.approx(np.zeros(3), abs=1e-9)


def test_on_rock_it_scratches_and_does_not_press_harder_than_it_may(rover_arm: Callable[..., Any]) -> None:
    rover = rover_arm("soil=rigid_rock")
    rover.over_ground(1.2, 0.0, 0.015)
    start = len(rover.log)
    report = rover.task("dig", 60.0, depth=0.02, length=0.04, force=20.0)
    assert report.doing.state in ("reached", "failed"), report
    assert rover.since("force", start)[:, 2].max() < 45.0
    assert report.doing.figures.get("depth_m", 0.0) < 0.002


def test_hold_force_on_rock_and_soil(rover_arm: Callable[..., Any]) -> None:
    for soil in ("rigid_rock", "lunar_nominal"):
        rover = rover_arm(f"soil={soil}")
        rover.over_ground(1.2, 0.0, 0.004)
        report = rover.task("hold_force", 30.0, force=15.0)
        assert report.doing.state == "reached", report
        held = len(rover.log)
        rover.run(4.0)
        assert rover.since("force", held)[:, 2] == pytest.approx(15.0, abs=1.5)


def test_a_tool_that_presses_hard_on_rock_does_not_chatter(rover_arm: Callable[..., Any]) -> None:
    """The lead that damps a parked rover made the turret swing at 500 Hz, by 0.2 rad/s, from some 20 N on."""
    rover = rover_arm("soil=rigid_rock")
    rover.over_ground(1.1, 0.3, 0.004)
    report = rover.task("hold_force", 30.0, force=40.0)
    assert report.doing.state == "reached", report
    held = len(rover.log)
    rover.run(0.5)
    assert rover.since("speed", held).max() < 2e-3
