"""Picking with the plant in the loop: a tube is lifted, weighed and put down; what cannot be is told."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from sojourn_flight.arm.tasks.requests import parse_task

TUBE = "{name: tube, x: 0.1, y: 0.2, mass: 0.3, width: 0.03, height: 0.03, friction: 0.4}"
WITH_TUBE = ("tool=gripper", "body=mars", "soil=mars", f"objects=[{TUBE}]")


def where(rover: Any) -> str:
    """Middle of the tube in base_link, as numbers in a text."""
    base = pin.XYZQUATToSE3(rover.plant.configuration[:7])
    return " ".join(f"{value:.4f}" for value in base.actInv(np.array(rover.plant.tool.own.places[0])))


def test_pick_weigh_and_put_down(rover_arm: Callable[..., Any]) -> None:
    rover = rover_arm(*WITH_TUBE)
    report = rover.task("pick", 90.0, position=where(rover), force=10.0, mass=0.3, friction=0.4)
    assert report.doing.state == "reached" and "30.0 mm wide" in report.doing.reason, report
    own = rover.plant.tool.own
    assert own.held == 0 and own.grasp == pytest.approx(10.0) and own.needed < 10.0
    assert rover.plant.tool.payload == 0.3
    rover.settle(np.array(rover.scenario.arm.named_poses["unfold"]))
    weighed = rover.task("weigh", 60.0)
    assert weighed.doing.figures["payload_kg"] == pytest.approx(0.3, abs=0.03), weighed
    rover.over_ground(1.2, -0.2, 0.03)
    assert rover.task("release", 20.0).doing.state == "reached"
    own = rover.plant.tool.own
    assert own.held is None and rover.plant.tool.payload == 0.0 and own.slips == 0
    assert own.places[0][:2] == pytest.approx(rover.log[-1]["tip"][:2], abs=0.005)


def test_a_heavier_object_than_was_thought_slips_and_it_is_told(rover_arm: Callable[..., Any]) -> None:
    """0.3 kg with a friction of 0.4 need 1.4 N on Mars at rest."""
    rover = rover_arm(*WITH_TUBE)
    report = rover.task("pick", 90.0, position=where(rover), force=1.0)
    assert report.doing.state == "failed" and "slipped out" in report.doing.reason, report
    own = rover.plant.tool.own
    assert own.held is None and own.slips == 1 and rover.plant.tool.payload == 0.0


def test_what_cannot_be_is_refused_with_the_numbers(rover_arm: Callable[..., Any]) -> None:
    rover = rover_arm(*WITH_TUBE)
    for numbers, reason in (
        ({"force": 100.0}, "force = 100 N: allowed is at most 60 N"),
        ({"force": 1.0, "mass": 0.3, "friction": 0.4}, "0.3 kg with a friction of 0.4 needs 1.5 N or more"),
    ):
        rover.period(task=parse_task("pick", {"position": where(rover), **numbers}))
        assert reason in rover.said.reason
    report = rover.task("pick", 90.0, position="1.1 -0.1 -0.455", force=5.0)
    assert report.doing.state == "failed" and "closed on nothing" in report.doing.reason
