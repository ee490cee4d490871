"""An operator whose process is started again goes on with the schedule of faults where the one before it was."""

import json
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_contract.app import Period
from sojourn_contract.fault_messages import read_fault
from sojourn_contract.goal_topics import FAULTS_TOPIC
from sojourn_contract.heartbeat import status_message
from sojourn_contract.kept_data import Kept
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.values import UPRIGHT, Odometry
from sojourn_operator.app import OperatorApp, OperatorState

LOOK_S = 0.1
FAULTS = (
    "{name: weak, kind: motor_weak, joint: wheel_front_left_joint, part: 0.5, at: 5, lasts: 3}",
    "{name: dead, kind: motor_dead, joint: wheel_front_right_joint, at: 5, until: 30}",
    "{name: far, kind: motor_dead, joint: wheel_rear_left_joint, when: {distance: 9.0, later: 1.0}, lasts: 4}",
    "{name: moving, kind: motor_dead, joint: wheel_rear_right_joint, when: {drive: moving}, lasts: 2}",
    "{name: step, kind: motor_dead, joint: wheel_middle_left_joint, when: {after_step: 1}, until: 8}",
)
Events = list[tuple[float, str, bool]]
"""When what is said on /faults acts [s], the fault, whether it comes."""


@cache
def operator(faults: tuple[str, ...]) -> OperatorApp:
    steps = "steps=[{wait_s: 6}, {wait_s: 900}]"
    return OperatorApp(load_scenario("flat_drive", [f"faults=[{', '.join(faults)}]", steps, "duration_limit_s=1000.0"]))


class Run:
    """Operators of one run, one after another; the machine drives 1 m/s and says so each second.

    Args:
        faults: of the scenario.
    """

    def __init__(self, faults: tuple[str, ...] = FAULTS) -> None:
        self.app = operator(faults)
        self.state: OperatorState = self.app.initial_state()
        self.look = 0

    def to(self, end: float) -> Events:
        """Go on to a time [s]; what is said till then."""
        said = Events()
        while LOOK_S * (self.look + 1) <= end + 1e-9:
            self.look += 1
            stamp, zero = round(self.look * LOOK_S * NANOSECONDS), np.zeros(3)
            place = np.array([self.look * LOOK_S, 0.0, 0.0])
            inputs: dict[str, Any] = {"/truth/odom": Odometry(stamp, "map", "base_link", place, UPRIGHT, zero, zero)}
            if self.look % 10 == 0:
                inputs["/drive/status"] = status_message(stamp, "drive", {"state": "moving", "goal_stamp": "0"})
            self.state, answer = self.app.step(self.state, Period(stamp, inputs))
            for name, message in answer.messages:
                if name == FAULTS_TOPIC:
                    event = read_fault(message)
                    said.append((message.stamp / NANOSECONDS, event.name, event.comes))
        return said

    def start_again(self, after: float = 0.0, values: Any = None) -> None:
        """Another process, so long after the end of the one before [s], which has its results as its node reads them.

        Args:
            values: that were kept, in place of its own.
        """
        kept = json.loads(json.dumps(self.app.to_keep(self.state))) if values is None else values
        begun = self.app.initial_state()
        script = self.app.script.begin(self.state.script.results)
        self.look += round(after / LOOK_S)
        stamp = round((self.look + 1) * LOOK_S * NANOSECONDS)
        fresh = OperatorState(script, link=begun.link)
        self.state = self.app.started_again(fresh, stamp, Kept(stamp, kept))


def test_what_was_over_does_not_come_again_and_what_is_there_goes() -> None:
    """A fault of three seconds came a second time, and one that was there when the operator died never went."""
    run = Run()
    assert ("weak", False) in [(name, comes) for _, name, comes in run.to(20.0)]
    run.start_again(after=12.0)
    ((goes_at, *what),) = run.to(60.0)
    assert goes_at == pytest.approx(32.2) and what == ["dead", False]


@settings(max_examples=40)
@given(ends=st.lists(st.integers(1, 350), max_size=4, unique=True))
def test_restarts_change_nothing_of_what_is_said(ends: list[int]) -> None:
    unbroken, broken = Run(FAULTS[:-1]), Run(FAULTS[:-1])  # a step that was under way begins anew
    said = Events()
    for end in sorted(ends):
        said += broken.to(end * LOOK_S)
        before = broken.state.faults
        broken.start_again()
        assert broken.state.faults == before
    assert said + broken.to(40.0) == unbroken.to(40.0)
    assert broken.state.faults == unbroken.state.faults


@pytest.mark.parametrize("values", [{}, {"faults": None}, {"faults": {"begun": {"weak": "x"}}}, {"faults": [1]}])
def test_what_cannot_be_read_is_as_nothing_kept(values: Any) -> None:
    run = Run(FAULTS[:1])
    run.to(20.0)
    run.start_again(values=values)
    assert [name for _, name, _ in run.to(30.0)] == ["weak", "weak"]


def test_without_faults_there_is_nothing_to_keep() -> None:
    run = Run(())
    run.to(1.0)
    assert run.app.to_keep(run.state) is None
