"""What /drive/status says of a goal on its way."""

from dataclasses import replace

import pytest

from sojourn_config.scenario import load_flight
from sojourn_drive.app import DriveApp
from sojourn_drive.goals import GoalStatus
from sojourn_flight.supervision.drive_types import DriveState


@pytest.fixture(scope="module")
def app() -> DriveApp:
    return DriveApp(load_flight("flat_drive", ["steps=[]"]))


@pytest.fixture
def state(app: DriveApp) -> DriveState:
    return app.initial_state().drive


@pytest.mark.parametrize(("waits", "told"), [(True, "waiting for power"), (False, "")])
def test_a_goal_that_does_not_get_on_says_why(state: DriveState, waits: bool, told: str) -> None:
    on_its_way = GoalStatus("moving", "", 77, 1)
    values = on_its_way.status(replace(state, text="waiting for power", waits=waits))
    assert (values["state"], values["reason"]) == ("moving", told)


def test_the_reason_of_an_end_stands_before_it(state: DriveState) -> None:
    ended = GoalStatus("stopped", "stopped by operator", 77, 1)
    assert ended.status(replace(state, text="waiting for power", waits=True))["reason"] == "stopped by operator"
