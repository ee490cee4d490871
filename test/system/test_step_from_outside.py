"""A step of a scenario from a package that is not ours, registered by an entry point: checked before a run, carried out
in the same way in every layout, told in the bag; nothing of this repository is edited.
"""

import json
from collections.abc import Iterator

import pytest
from outside import Stranger, known_by
from programs import LAYOUTS, PATIENT, PATIENT_BENCH

from domains import domain_to_keep

STEP = '''
"""Wave: turn one joint of the arm so far and let it there, then look at it for a while."""

from typing import ClassVar

import numpy as np
from pydantic import Field

from sojourn_contract.values import JointState
from sojourn_machine.params import Params
from sojourn_operator.steps.step import DONE, OperatorStep


class WaveStep(Params, OperatorStep):
    role: ClassVar[str] = "arm"
    topic: ClassVar[str] = "/arm/joint_goal"
    joint: str = Field(description="that is turned")
    angle: float = Field(ge=-1.0, le=1.0, description="to which it is turned [rad]")
    seconds: float = Field(default=0.0, ge=0.0, le=10.0, description="for which it is looked at [s]")

    def problems(self, bundle):
        if self.joint not in bundle.arm_joints:
            yield ("joint",), self.joint, "is no joint of the arm: allowed is one of " + ", ".join(bundle.arm_joints)

    def describe(self):
        return f"wave with {self.joint}"

    def goal(self, view):
        return JointState(view.stamp, (self.joint,), np.array([self.angle]))

    def end(self, view):
        ended = super().end(view)
        if ended is None or ended[0] != "reached":
            return ended
        return (DONE, "seen") if view.is_over(self.seconds) else None
'''
SCENARIO = """
description: Waving
seed: 3
machine: scara
body: earth
terrain: {kind: flat, size_x: 4.0, size_y: 4.0, resolution: 0.1}
soil: lunar_nominal
battery_soc: 0.8
duration_limit_s: 60.0
steps:
  - wave: {joint: arm_elbow_joint, angle: 0.3, seconds: 4.0}
    timeout_s: 20.0
  - wait_s: 0.4
"""


@pytest.fixture(scope="module")
def stranger(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stranger]:
    """With a run in each layout."""
    base = tmp_path_factory.mktemp("stranger")
    (base / "manners").mkdir()
    (base / "manners" / "__init__.py").write_text("", encoding="utf-8")
    (base / "manners" / "wave.py").write_text(STEP, encoding="utf-8")
    known_by(base, "manners", "[sojourn.steps]\nwave = manners.wave:WaveStep\n")
    one = Stranger(base, base / "waving.yaml")
    one.scenario.write_text(SCENARIO, encoding="utf-8")
    try:
        for layout, options in LAYOUTS.items():
            domain = () if layout == "direct" else ("--domain", domain_to_keep())
            run = one.call("start", one.scenario, *PATIENT, *options, *domain, "--run-dir", base / layout)
            assert run.wait() == 0, run.text
        yield one
    finally:
        one.end()


@pytest.mark.parametrize("layout", LAYOUTS)
def test_it_is_carried_out_and_told(stranger: Stranger, layout: str) -> None:
    report = stranger.call("report", stranger.base / layout)
    assert report.wait() == 0, report.text
    summary = json.loads((stranger.base / layout / "summary.json").read_text(encoding="utf-8"))
    assert summary["all_met"] and summary["steps_not_sent"] == 0 and summary["sim_time_s"] > 4.0
    bag = stranger.bag(layout)
    moved = bag["/truth/joint_states"].joints()
    assert moved.position[-1, list(moved.names).index("arm_elbow_joint")] == pytest.approx(0.3, abs=0.01)
    told = [status["step"] for status in bag["/diagnostics"].statuses() if "step" in status]
    assert "step 1 of 2: wave with arm_elbow_joint" in told


def test_the_layouts_are_equal(stranger: Stranger) -> None:
    compared = stranger.call("compare", stranger.base / "direct", stranger.base / "processes")
    assert compared.wait() == 0 and "identical" in compared.text, compared.text


def test_replay_knows_it(stranger: Stranger) -> None:
    replay = stranger.call(
        "replay", stranger.base / "direct", "--node", "arm", "--exact", *PATIENT_BENCH, "--domain", domain_to_keep()
    )
    assert replay.wait() == 0 and "identical" in replay.text, replay.text


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("wave:", "wafe:", ["waving.yaml:11", "steps[0].wafe", "did you mean wave?", "wait_s", "drive_to"]),
        ("angle: 0.3", "angle: 3", ["waving.yaml:11", "steps[0].wave.angle = 3", "at most 1", "[rad]"]),
        ("angle: 0.3", 'angle: "0.3"', ["steps[0].wave.angle", "is text"]),
        ("seconds: 4.0", "second: 4.0", ["steps[0].wave.second", "did you mean seconds?"]),
        ("joint: arm_elbow_joint", "joint: knee", ["waving.yaml:11", "wave.joint = 'knee'", "arm_elbow_joint"]),
        ("machine: scara", "machine: skid", ["waving.yaml:11", "steps[0].wave", "has no arm"]),
    ],
)  # fmt: skip
def test_a_mistake_in_it_is_told(stranger: Stranger, old: str, new: str, words: list[str]) -> None:
    wrong = stranger.base / "wrong" / "waving.yaml"
    wrong.parent.mkdir(exist_ok=True)
    wrong.write_text(SCENARIO.replace(old, new), encoding="utf-8")
    tried = stranger.call("start", wrong, "--resolved")
    assert tried.wait() != 0
    for word in words:
        assert word in tried.text, tried.text
