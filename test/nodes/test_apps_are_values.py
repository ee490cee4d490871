"""Apps without ROS: a state that was kept gives the same answers again, whatever has been done since."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import partial
from typing import Any

import numpy as np
import pytest

from sojourn_arm.app import ArmApp
from sojourn_config.scenario import load_scenario
from sojourn_contract.app import App, Period
from sojourn_contract.barrier import is_due
from sojourn_contract.codecs import encode
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import inputs_of, topic
from sojourn_contract.values import Header, JointState, PoseStamped
from sojourn_drive.app import DriveApp
from sojourn_plant.app import PlantApp
from sojourn_power.app import PowerApp
from sojourn_sensors.app import SensorsApp

ROLES = ("sensors", "power", "drive", "arm", "plant")
"""In the order in which they act here."""


@pytest.fixture(scope="module")
def apps() -> dict[str, App[Any]]:
    scenario = load_scenario("lunar_sample", ["faults=[{joint: wheel_front_left_joint, kind: servo_locked, at: 0.1}]"])
    return {kind.role: kind.of(scenario) for kind in (PlantApp, SensorsApp, PowerApp, DriveApp, ArmApp)}


class Loop:
    """All roles but the operator, whose goals, by period, are given."""

    def __init__(self, apps: dict[str, App[Any]], goals: dict[int, tuple[str, Any]]) -> None:
        self.apps = apps
        self.goals = goals
        self.states = {role: app.initial_state() for role, app in apps.items()}
        self.period = 1
        self.messages = dict(apps["plant"].first_messages(self.states["plant"], CONTROL_PERIOD_NS))

    def step(self) -> Iterator[tuple[str, bytes]]:
        """One period; gives what everybody has said, as bytes."""
        stamp = self.period * CONTROL_PERIOD_NS
        for role in ROLES:
            rows = [row for row in inputs_of(role, ROLES) if not row.is_event]
            due = {row.name: self.messages.get(row.name) for row in rows if is_due(row, self.period)}
            if not any(message is not None for message in due.values()):
                continue
            goals = [self.goals[self.period]] if self.period in self.goals else []
            goals = [(name, message) for name, message in goals if role in topic(name).subscribers]
            self.states[role], answer = self.apps[role].step(self.states[role], Period(stamp, due, goals))
            assert not answer.refusals
            for name, message in answer.messages:
                self.messages[name] = message
                yield name, encode(topic(name), message)
        self.period += 1

    def run(self, periods: int) -> list[tuple[str, bytes]]:
        return [said for _ in range(periods) for said in self.step()]

    def goes_on_from(self, periods: int, more: int) -> set[str]:
        """Assert that a state which is kept after some periods goes on like that again, after `more` have been run
        from it and some on top. The topics on which it has spoken.
        """
        self.run(periods - self.period + 1)
        kept, period, messages = dict(self.states), self.period, dict(self.messages)
        before = list(parts(kept))
        first = self.run(more)
        end = list(parts(self.states))
        self.run(5)
        assert list(parts(kept)) == before, "nobody has written to it"
        self.states, self.period, self.messages = dict(kept), period, messages
        assert self.run(more) == first
        assert list(parts(self.states)) == end
        return {name for name, _ in first}


def parts(value: Any) -> Iterator[Any]:
    """What a state is made of, to the last bit."""
    if is_dataclass(value):
        for field in fields(value):
            yield field.name
            yield from parts(getattr(value, field.name))
    elif isinstance(value, dict | list | tuple):
        yield len(value)
        for part in value.items() if isinstance(value, dict) else value:
            yield from parts(part)
    elif isinstance(value, np.ndarray):
        yield value.shape, value.tobytes()
    elif isinstance(value, partial):  # makes a report when it is asked for
        yield from parts(value.args[1:])
    else:
        yield repr(value) if isinstance(value, float) else value


def pose(frame: str, x: float, y: float, z: float = 0.0) -> PoseStamped:
    return PoseStamped(0, frame, np.array([x, y, z]))


def test_a_drive_is_gone_on_with_from_a_kept_state_as_if_nothing_had_happened(apps: dict[str, App[Any]]) -> None:
    loop = Loop(apps, {3: ("/goal_pose", pose("odom", 2.0, 0.5))})
    names = loop.goes_on_from(33, 20)
    assert {"/imu/data", "/joint_states", "/hazcam/points", "/power/switches", "/truth/contacts", "/odom"} <= names
    assert all(topic(name).publisher in ROLES for name in names)
    assert max(np.abs(loop.messages["/drive_command"].velocity)) > 0.1


def test_a_motion_of_the_arm_is_gone_on_with_from_a_kept_state_too(apps: dict[str, App[Any]]) -> None:
    """On the way it is told to stop, and given a place in odom, over ground that the camera has seen."""
    unfold = JointState(0, (), frame="unfold")
    goals = {
        3: ("/arm/joint_goal", unfold),
        75: ("/arm/stop", Header(0)),
        130: ("/arm/goal_pose", pose("odom", 1.2, 0.0, 0.2)),
    }
    loop = Loop(apps, goals)
    loop.run(60)
    assert max(np.abs(loop.messages["/arm_command"].velocity)) > 0.01, "in the middle of a motion"
    names = loop.goes_on_from(60, 100)
    assert {"/arm_command", "/arm/status"} <= names
    state = loop.states["arm"]
    assert (state.goal.stamp, state.goal.goals_accepted) == (0, 3) and state.goal.state == "moving"
    assert state.ground.seen is not None and state.ground.cloud == 150 * CONTROL_PERIOD_NS


def test_the_plant_ends_the_run_when_the_operator_does(apps: dict[str, App[Any]]) -> None:
    plant = apps["plant"]
    state = plant.initial_state()
    after, answer = plant.step(state, Period(CONTROL_PERIOD_NS, {"/operator/tick": Header(CONTROL_PERIOD_NS, "end")}))
    assert answer.finished and after is state and not list(answer.messages)
