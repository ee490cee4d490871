"""Soil that a scoop takes away: mass balance, what it weighs, what a second dig meets, what the lid keeps."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sojourn_flight.arm.goal_events import was
from sojourn_flight.arm.tasks.activity import NoTask
from sojourn_flight.arm.tasks.requests import parse_task
from sojourn_physics.plant.tools.tool_state import Soil
from sojourn_physics.terrain.memory_tiles import DUG

FINE = ("terrain.memory_cell=0.01",)


def missing(rover: Any) -> float:
    """Volume that lacks in the ground [m3], in double precision from what is stored."""
    ground = rover.plant.ground
    return math.fsum(float(tile[..., DUG].astype(np.float64).sum()) for tile in ground.tiles.values()) * ground.cell**2


def test_dig_weigh_and_dump(rover_arm: Callable[..., Any]) -> None:
    rover = rover_arm("soil=lunar_nominal", *FINE)
    assert rover.task("tare", 5.0).doing.state == "reached"
    rover.over_ground(1.2, 0.0, 0.02)
    begun, energy = len(rover.log), rover.plant.energy
    report = rover.task("dig", 60.0, depth=0.02, length=0.08)
    assert report.doing.state == "reached", report
    own, soil = rover.plant.tool.own, rover.scenario.soils["lunar_nominal"]
    depth, width = report.doing.figures["depth_m"], rover.scenario.tool.cut.width
    assert own.carried.volume == pytest.approx(0.08 * depth * width, rel=0.2)
    assert missing(rover) == pytest.approx(own.carried.volume + own.pushed.volume, rel=1e-9)
    assert own.carried.mass == pytest.approx(soil.density * own.carried.volume, rel=1e-9)
    assert own.pushed.volume < 1e-9 and own.carried.volume < rover.scenario.tool.capacity
    tips = rover.since("tip", begun)
    trench = 0.5 * (tips[:, 0].max() + tips[:, 0].min()), float(tips[-1, 1])
    floor = rover.plant.ground.lowered(*trench)
    assert floor == pytest.approx(-tips[:, 2].min(), abs=0.004)
    assert rover.plant.energy.balance_error(energy) < 2e-3, "also while soil comes onto the arm"
    # it hangs on the arm: the wrist feels it, and the joints' torques tell it
    rover.over_ground(1.2, 0.0, 0.3)
    weighed = rover.task("weigh", 60.0)
    assert weighed.doing.state == "reached", weighed
    assert weighed.doing.figures["payload_by_wrist_kg"] == pytest.approx(own.carried.mass, abs=0.03)
    assert weighed.doing.figures["payload_kg"] == pytest.approx(own.carried.mass, abs=0.03)
    # beside the trench it falls out as a heap
    rover.over_ground(1.2, 0.2, 0.1)
    assert rover.task("dump", 30.0).doing.state == "reached"
    left = rover.plant.tool.own.carried.volume
    assert 0.0 <= left < 1e-9 and rover.plant.tool.position == pytest.approx(0.0, abs=0.05)
    assert missing(rover) == pytest.approx(left, abs=1e-9 * own.carried.volume)  # and of what it pushed
    place = rover.log[-1]["tip"][:2]
    radius = (3.0 * own.carried.volume / (math.pi * math.tan(soil.friction_angle))) ** (1.0 / 3.0)
    assert -rover.plant.ground.lowered(*place) == pytest.approx(radius * math.tan(soil.friction_angle), rel=0.25)


def test_a_full_scoop_pushes_the_rest_and_feels_it(rover_arm: Callable[..., Any]) -> None:
    rover = rover_arm("soil=lunar_nominal", *FINE)
    rover.over_ground(1.25, 0.0, 0.01)
    tool = rover.model.tool
    tool._law.params = rover.scenario.tool.model_copy(update={"capacity": 3e-5})
    pushed = []
    try:
        rover.period(task=None)
        rover.period(task=parse_task("dig", {"depth": 0.02, "length": 0.1, "speed": 0.02}))
        while rover.report.doing.state == "moving":
            rover.period()
            pushed.append(rover.plant.tool.own.pushed.volume)
            assert missing(rover) == pytest.approx(
                rover.plant.tool.own.carried.volume + rover.plant.tool.own.pushed.volume, rel=1e-9, abs=1e-18
            )
            assert rover.plant.tool.pile == pytest.approx(
                rover.plant.tool.own.pushed.mass * rover.model.gravity, rel=1e-12
            )
    finally:
        tool._law.params = rover.scenario.tool
    assert rover.report.doing.state == "reached", rover.report
    own = rover.plant.tool.own
    assert own.carried.volume == pytest.approx(3e-5) and max(pushed) > 2e-5
    assert own.pushed.volume < 1e-9, "it stays as a heap when the scoop leaves the ground"
    # emptied, in the same trench it meets the lower ground
    rover.plant = replace(rover.plant, tool=replace(rover.plant.tool, own=replace(own, carried=Soil()), payload=0.0))
    tips, begun = rover.since("tip", 0), len(rover.log)
    rover.over_ground(1.22, 0.0, 0.02)
    report = rover.task("dig", 60.0, depth=0.01, length=0.03)
    assert report.doing.state == "reached", report
    assert rover.since("tip", begun)[:, 2].min() < tips[:, 2].min() - 0.006


def test_a_scoop_that_is_lifted_open_keeps_nothing(rover_arm: Callable[..., Any]) -> None:
    rover = rover_arm("soil=lunar_nominal", *FINE)
    empty = replace(rover, plant=rover.plant.copy(), log=[])
    rover.over_ground(1.2, 0.0, 0.02)
    assert rover.task("dig", 60.0, depth=0.02, length=0.04).doing.state == "reached"
    energy, carried = rover.plant.energy, rover.plant.tool.own.carried
    assert carried.volume > 1e-5
    # the load hangs on a model that branches share: each of them puts its own there
    empty.run(0.5)
    twin = rover_arm("soil=lunar_nominal", *FINE)
    twin.run(0.5)
    assert np.array_equal(empty.plant.velocity, twin.plant.velocity)
    assert np.array_equal(empty.output.wrist_wrench, twin.output.wrist_wrench)
    rover.tasks = replace(rover.tasks, activity=NoTask(), tool_command=rover.tasks.tool_command._replace(position=1.2))
    rover.run(2.0)
    assert rover.plant.tool.own.carried.volume < 1e-9
    own = rover.plant.tool.own
    assert missing(rover) == pytest.approx(own.carried.volume + own.pushed.volume, abs=1e-18)
    assert rover.plant.energy.electrical > energy.electrical


@pytest.mark.parametrize("name", ["drill", "pick"])
def test_what_a_scoop_cannot_do_is_refused(rover_arm: Callable[..., Any], name: str) -> None:
    rover = rover_arm("soil=lunar_nominal", *FINE)
    numbers = {"position": "1.2 0 -0.4"} if name == "pick" else {}
    rover.period(task=parse_task(name, numbers))
    assert rover.report is None and was("refused", rover.said.events) and "this arm" in rover.said.reason
