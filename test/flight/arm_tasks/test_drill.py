"""Drilling: depth, torque and energy against the ground's law, and why it ends early."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sojourn_flight.arm.tasks.requests import parse_task
from sojourn_physics.soil.drilling import drill

ON_ROCK = ("tool=drill", "soil=rigid_rock", "soil.specific_energy=3.0e+7")


def test_a_hole_in_rock(rover_arm: Callable[..., Any]) -> None:
    rover = rover_arm(*ON_ROCK)
    assert rover.task("tare", 5.0).doing.state == "reached"
    rover.over_ground(1.2, 0.0, 0.01)
    start, energy = len(rover.log), rover.plant.energy
    report = rover.task("drill", 90.0, depth=0.005, force=30.0)
    assert report.doing.state == "reached", report
    own, bit = rover.plant.tool.own, rover.scenario.tool.bit
    hole = own.holes[0]
    assert len(own.holes) == 1 and hole.depth == pytest.approx(0.005, abs=0.0004)
    assert own.cuttings == pytest.approx(math.pi * bit.radius**2 * hole.depth, rel=0.02)
    # steady drilling: the force is held, and torque and headway are those of the ground for that thrust
    pressing = rover.since("force", start)[:, 2]
    tip, phase = rover.since("tip", start)[:, 2], rover.since("phase", start)
    drilling = np.flatnonzero(phase == "drill")
    unloaded = np.flatnonzero(phase == "check")[0]
    last = drilling[drilling < unloaded][-1]
    first = last - 100
    assert pressing[first:last] == pytest.approx(30.0, abs=4.0)
    stiffness = math.pi * bit.radius**2 * 5.0e7  # of a plate of its size on this rock [N/m]
    expected = drill(bit, 3.0e7, float(pressing[first:last].mean()))
    headway = (tip[first] - tip[last]) / ((last - first) * 0.02)
    given = (pressing[last] - pressing[first]) / stiffness / ((last - first) * 0.02)  # of that the ground's own give
    assert headway - given == pytest.approx(expected.depth_per_turn * 30.0 / (2.0 * math.pi), rel=0.1)
    assert report.doing.figures["torque_nm"] == pytest.approx(expected.torque, rel=0.25)
    # what the arm reckons per volume is the torque's part of Teale's energy, 2 π T/(A d), while it got on
    of_torque = 2.0 * math.pi * expected.torque / (math.pi * bit.radius**2 * expected.depth_per_turn)
    assert report.doing.figures["specific_energy_j_m3"] == pytest.approx(of_torque, rel=0.35)
    # all of it has come from the bus, and the bit is warmer
    spent = rover.plant.energy.electrical - energy.electrical
    assert spent > report.doing.figures["work_j"] * 0.9
    assert rover.plant.energy.balance_error(energy) < 5e-3
    assert own.temperature > 250.5
    assert report.doing.figures["bit_temperature_k"] == pytest.approx(own.temperature, abs=2.0)
    # it stands still outside the hole
    assert rover.plant.tool.rate < 30.0 and rover.log[-1]["tip"][2] > 0.0
    rover.run(1.0)
    assert rover.plant.tool.rate == 0.0
    # the same hole goes on at its bottom
    report = rover.task("guarded_move", 30.0, force=10.0, speed=0.005, distance=0.03)
    assert rover.log[-1]["tip"][2] == pytest.approx(-hole.depth, abs=0.002)
    assert report.doing.state == "reached"


@pytest.mark.parametrize(
    ("overrides", "numbers", "reason"),
    [
        (("tool.tool.motor.max_current=0.25",), {"force": 50.0}, "stalled with"),
        (("soil.specific_energy=1.0e+10",), {"force": 20.0, "patience": 1.5}, "no progress"),
        (
            ("tool.tool.heat.capacity=0.3", "tool.tool.heat.conductance=0.0"),
            {"force": 40.0, "depth": 0.02},
            "the bit is at",
        ),
    ],
)
def test_why_it_ends_early(
    rover_arm: Callable[..., Any], overrides: tuple[str, ...], numbers: dict[str, float], reason: str
) -> None:
    rover = rover_arm(*ON_ROCK, *overrides)
    rover.over_ground(1.2, 0.0, 0.01)
    report = rover.task("drill", 60.0, **numbers)
    assert report.doing.state == "failed" and reason in report.doing.reason, report
    rover.run(1.0)
    assert rover.plant.tool.rate == 0.0 and rover.log[-1]["tip"][2] > 0.0, "it has come out, and stands still"


def test_more_than_the_drill_has_is_refused(rover_arm: Callable[..., Any]) -> None:
    rover = rover_arm(*ON_ROCK)
    rover.over_ground(1.2, 0.0, 0.01)
    rover.period(task=parse_task("drill", {"rate": 40.0}))
    assert "rate = 40 rad/s: allowed is at most 30" in rover.said.reason
    rover.period(task=parse_task("dump", {}))
    assert "carries a drill: allowed is a scoop" in rover.said.reason
