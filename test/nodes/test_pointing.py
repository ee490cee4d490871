"""The mast of explorer_cameras: what turns it, how fast, what is refused, and that its camera turns with it."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract.app import Period
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topics import topic
from sojourn_contract.values import JointState
from sojourn_machine.shapes import MachineShapes
from sojourn_plant.app import PlantApp, PlantAppState
from sojourn_plant.pointing import TOPIC

PAN, TILT = "mast_pan_joint", "mast_tilt_joint"
PERIOD = 20_000_000


@pytest.fixture(scope="module")
def scenario() -> LoadedScenario:
    return load_scenario("flat_drive", ["machine=explorer_cameras"])


@pytest.fixture(scope="module")
def plant(scenario: LoadedScenario) -> PlantApp:
    return PlantApp(scenario)


def goal(**angles: float) -> JointState:
    return JointState(PERIOD, tuple(angles), np.array(list(angles.values())))


def run(plant: PlantApp, state: PlantAppState, seconds: float, *goals: Any) -> Iterator[tuple[PlantAppState, Any]]:
    for number in range(1, round(seconds * 50) + 1):
        given = [(TOPIC, one) for one in goals] if number == 1 else []
        state, answer = plant.step(state, Period(number * PERIOD, {}, given))
        truth = dict(answer.messages)["/truth/joint_states"]
        yield state, dict(zip(truth.names, truth.position, strict=True))


def test_it_turns_at_the_speed_of_the_joint_and_holds(plant: PlantApp) -> None:
    """0.3 rad at 0.15 rad/s, three quarters of the limit: 2 s, half of it after 1 s; tilt goes the same way back."""
    told = list(run(plant, plant.initial_state(), 4.0, goal(**{PAN: 0.3, TILT: -0.3})))
    pan, tilt = (np.array([joints[name] for _, joints in told]) for name in (PAN, TILT))
    assert pan[49] == pytest.approx(0.15, abs=0.015) and tilt[49] == pytest.approx(-0.15, abs=0.015)
    assert np.diff(pan).max() * 50.0 < 0.2
    assert pan[-1] == pytest.approx(0.3, abs=2e-3) and tilt[-1] == pytest.approx(-0.3, abs=2e-3)
    state, _ = told[-1]
    still = [joints[PAN] for _, joints in run(plant, state, 0.5)]
    assert np.ptp(still) < 1e-3


def test_a_joint_that_nobody_points_stays(plant: PlantApp) -> None:
    (*_, (state, joints)) = run(plant, plant.initial_state(), 1.0, goal(**{PAN: 0.1}))
    assert abs(joints[TILT]) < 5e-3 and state.targets.keys() == {plant.model.joint_index[PAN]}


BAD = [
    ({"steer_front_left_joint": 0.1}, PAN),
    ({"nobody_joint": 0.1}, PAN),
    ({PAN: 4.0}, "-3.1 to 3.1"),
    ({PAN: float("nan")}, "position"),
    ({}, "one for each joint"),
]


@pytest.mark.parametrize(("angles", "words"), BAD)
def test_what_it_cannot_do_is_refused(plant: PlantApp, angles: dict[str, float], words: str) -> None:
    with pytest.raises(RefusedMessageError, match=words):
        plant.check(topic(TOPIC), goal(**angles))


@pytest.mark.parametrize(
    ("step", "words"),
    [
        ("{mast_to: {positions: {wheel_front_left_joint: 1.0}}}", "no joint that an operator points"),
        ("{mast_to: {positions: {mast_pan_joint: 9.0}}}", "-3.1 to 3.1 rad"),
    ],
)
def test_a_step_that_it_cannot_do_is_said_before_the_run(step: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        load_scenario("flat_drive", ["machine=explorer_cameras", f"steps=[{step}]"])


def test_a_machine_without_a_mast_points_nothing() -> None:
    assert load_scenario("flat_drive").pointed_joints == ()


def test_the_navigation_camera_looks_where_the_mast_points(scenario: LoadedScenario) -> None:
    """Pan by a quarter to the left and tilt up by the mounting's 0.35 rad: level, along y, the head's offset turned."""
    shapes = MachineShapes(scenario.urdf_xml, "navcam_link")
    turn, place, _ = shapes.at((PAN, TILT), np.array([np.pi / 2, -0.35]))
    x, y, _ = place
    np.testing.assert_allclose(turn[:, 0], [0.0, 1.0, 0.0], atol=1e-9)
    assert (x, y) == pytest.approx((0.36 - 0.1, 0.06 * np.cos(0.35)))
