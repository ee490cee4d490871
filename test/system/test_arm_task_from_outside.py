"""A task of the arm from a package that is not ours, registered by an entry point: asked for in a scenario, carried out
in a run of the whole stack, told in its bag and kept by a checkpoint; nothing of this repository is edited.
"""

from collections.abc import Iterator

import numpy as np
import pytest
from outside import Stranger, known_by
from programs import PATIENT, PATIENT_BENCH

from domains import domain_to_keep

TASK = '''
"""Nod: turn the last joint to and fro, some times."""

from dataclasses import dataclass, replace
from typing import ClassVar

from pydantic import Field

from sojourn_flight.arm.goals import JointGoal
from sojourn_flight.arm.tasks.requests import TaskRequest
from sojourn_flight.arm.tasks.task import Doing


class Nod(TaskRequest):
    task: ClassVar[str] = "nod"
    angle: float = Field(default=0.2, gt=0.0, le=1.0, description="of a nod [rad]")
    times: int = Field(default=2, ge=1, le=10, description="nods")

    def begin(self, beginning):
        rest = tuple(float(angle) for angle in beginning.posture)
        names = beginning.params.joint_names
        bent = JointGoal(names, (*rest[:-1], rest[-1] + self.angle))
        return Nodding((bent, JointGoal(names, rest)) * self.times)


@dataclass(frozen=True, slots=True)
class Nodding:
    """State: the goals that are still ahead, and whether the first of them has been given."""

    ahead: tuple[JointGoal, ...]
    asked: bool = False
    done: int = 0

    def advance(self, view, dt):
        figures = {"nods": self.done / 2.0}
        if not self.ahead:
            return self, Doing(state="reached", progress=1.0, figures=figures)
        if not self.asked:
            return replace(self, asked=True), Doing(goal=self.ahead[0], figures=figures)
        if view.status in ("refused", "stopped", "holding"):
            return self, Doing(state="failed", reason=view.reason, figures=figures)
        if view.status == "reached":
            return Nodding(self.ahead[1:], False, self.done + 1), Doing(figures=figures)
        return self, Doing(figures=figures)
'''
SCENARIO = """
description: Nodding
seed: 3
machine: scara
body: earth
terrain: {kind: flat, size_x: 4.0, size_y: 4.0, resolution: 0.1}
soil: lunar_nominal
start: {x: 0.0, y: 0.0, yaw: 0.0}
battery_soc: 0.8
duration_limit_s: 60.0
steps:
  - arm_task: {name: nod, values: {times: 2}}
    timeout_s: 50.0
"""


@pytest.fixture(scope="module")
def stranger(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stranger]:
    """With a direct run."""
    base = tmp_path_factory.mktemp("stranger")
    (base / "manners").mkdir()
    (base / "manners" / "__init__.py").write_text("", encoding="utf-8")
    (base / "manners" / "nod.py").write_text(TASK, encoding="utf-8")
    known_by(base, "manners", "[sojourn.arm_tasks]\nnod = manners.nod:Nod\n")
    one = Stranger(base, base / "nodding.yaml")
    one.scenario.write_text(SCENARIO, encoding="utf-8")
    try:
        run = one.call("start", one.scenario, *PATIENT, "--direct", "--run-dir", base / "run")
        assert run.wait() == 0, run.text
        yield one
    finally:
        one.end()


def test_the_arm_nods(stranger: Stranger) -> None:
    said, bag = stranger.programs[0].text, stranger.bag("run")
    assert "arm: nod" in said and said.count("reached") == 1 and "not reached" not in said, said
    told = [status for status in bag["/arm/status"].statuses() if status.get("task") == "nod"]
    assert float(told[-1]["nods"]) == 2.0
    last = bag["/truth/joint_states"].joints().position[:, -1]
    turned = last - last[0]
    assert np.abs(turned).max() == pytest.approx(0.2, abs=0.02)
    far = np.abs(turned) > 0.1
    assert np.count_nonzero(far[1:] & ~far[:-1]) == 2


def test_replay_and_contract_know_it(stranger: Stranger) -> None:
    run, domain = stranger.base / "run", domain_to_keep()
    replay = stranger.call("replay", run, "--node", "arm", "--exact", *PATIENT_BENCH, "--domain", domain)
    assert replay.wait() == 0 and "identical" in replay.text, replay.text
    check = stranger.call("contract_tool", "check", "--bag", run)
    assert check.wait() == 0 and "keeps the contract: no violation" in check.text, check.text


def test_a_checkpoint_holds_its_state(stranger: Stranger) -> None:
    roles = ("plant", "sensors", "arm", "power", "operator")
    assert stranger.goes_on(roles, "arm", "'Nodding' in repr(app)") == "it goes on as it was\n"


def test_a_mistake_in_its_numbers_is_told(stranger: Stranger) -> None:
    tried = stranger.call("start", stranger.scenario, "--set", "steps[0].arm_task.values.angle=3", "--resolved")
    assert tried.wait() != 0 and "nod: angle = '3'" in tried.text and "of a nod" in tried.text, tried.text
