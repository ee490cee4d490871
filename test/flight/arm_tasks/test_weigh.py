"""A payload at the tip, weighed by the joints' torques, in the plant and against inverse dynamics."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_flight.arm.model import build_arm_model
from sojourn_flight.arm.payload import StillPosture, identify_payload
from sojourn_machine.errors import InvalidValueError

SCENARIO = load_scenario("flat_drive")
ARM = build_arm_model(SCENARIO.urdf_xml, SCENARIO.arm)
UNFOLD = np.array(SCENARIO.arm.named_poses["unfold"])


def torques(posture: np.ndarray, mass: float, centre: np.ndarray, gravity: np.ndarray) -> np.ndarray:
    """By Pinocchio's recursive Newton-Euler with the mass added to the last link: another route."""
    model = ARM.pinocchio_model.copy()
    tip = model.frames[model.getFrameId(SCENARIO.arm.tip_link)].placement
    model.inertias[model.njoints - 1] += pin.Inertia(mass, tip.act(centre), np.zeros((3, 3)))
    model.gravity.linear = gravity
    return np.array(pin.rnea(model, model.createData(), posture, np.zeros(5), np.zeros(5)))


@settings(max_examples=30, deadline=None)
@given(
    st.floats(0.05, 5.0),
    st.lists(st.floats(-0.1, 0.1), min_size=3, max_size=3),
    st.floats(-0.3, 0.3),
    st.floats(-0.3, 0.3),
)
def test_exact_torques_give_the_exact_payload(mass: float, centre: list[float], pitch: float, roll: float) -> None:
    """On any tilt of the base."""
    gravity = pin.rpy.rpyToMatrix(roll, pitch, 0.0).T @ np.array([0.0, 0.0, -1.62])
    seen = []
    for turn in ([0, 0, 0, 0, 0], [0, 0, 0.5, 0, 0], [0, 0, 0, 0.6, 0], [0, 0, 0, 0.3, 0.8]):
        posture = UNFOLD + np.array(turn)
        seen.append(StillPosture(posture, torques(posture, mass, np.array(centre), gravity), gravity))
    found = identify_payload(ARM, seen)
    assert found.mass == pytest.approx(mass, rel=1e-6)
    assert found.centre == pytest.approx(centre, abs=1e-5)
    assert found.residual < 1e-9


def test_the_deviation_is_honest() -> None:
    """Over many draws of noise the mass scatters as its deviation says."""
    gravity, generator = np.array([0.0, 0.0, -1.62]), np.random.default_rng(4)
    postures = [UNFOLD + np.array(turn) for turn in ([0, 0, 0, 0, 0], [0, 0, 0.5, 0, 0], [0, 0, 0, 0.6, 0])]
    found = [
        identify_payload(
            ARM,
            [
                StillPosture(q, torques(q, 1.0, np.zeros(3), gravity) + generator.normal(0, 0.05, 5), gravity)
                for q in postures
            ],
        )
        for _ in range(300)
    ]
    masses = np.array([each.mass for each in found])
    assert masses.mean() == pytest.approx(1.0, abs=0.02)
    assert masses.std() == pytest.approx(np.sqrt(np.mean([each.mass_deviation**2 for each in found])), rel=0.15)


def test_too_little_is_refused() -> None:
    one = StillPosture(UNFOLD, np.zeros(5), np.array([0.0, 0.0, -1.62]))
    with pytest.raises(InvalidValueError, match="two or more"):
        identify_payload(ARM, [one])
    with pytest.raises(InvalidValueError, match="gravity"):
        identify_payload(ARM, [one._replace(gravity=np.zeros(3))] * 2)


def test_the_task_weighs_in_the_plant(loaded_rover_arm: Callable[..., Any]) -> None:
    """With the noise and the steps of the torque's telemetry: within 2 % of 1.5 kg."""
    mass = 1.5
    rover = loaded_rover_arm(mass)
    report = rover.task("weigh", 120.0)
    assert report.doing.state == "reached", report
    figures = report.doing.figures
    assert figures["payload_kg"] == pytest.approx(mass, rel=0.02)
    assert figures["payload_by_wrist_kg"] == pytest.approx(mass, abs=0.2)
