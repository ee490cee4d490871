"""States that nodes hand over one by one: which of them become files, and what the plant is told of it."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from sojourn_bringup.checkpoints import FOLDER
from sojourn_bringup.plan import RunPlan
from sojourn_bringup.process_checkpoints import MOST_WAITING, ProcessCheckpoints
from sojourn_contract.checkpoint_topic import FILED, as_text, state_messages
from sojourn_contract.codecs import decode
from sojourn_contract.heartbeat import Counters
from sojourn_contract.role_state import RoleAtCheckpoint, RoleState
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.state_tree import packed
from sojourn_plant.checkpoints import ANSWERED, SILENT

ROLES = ("plant", "drive")


class Run:
    """A supervisor's checkpoints of a run of two roles, in the place of its monitor."""

    def __init__(self, folder: Path) -> None:
        plan = RunPlan("flat_drive", folder, ROLES, ROLES, checkpoint_every_s=0.7)
        self.said: list[str] = []
        self.kept = ProcessCheckpoints(plan, {}, self.said.append)
        self._hear: Callable[[Any], None] = print
        self._folder = folder / FOLDER
        self.filed: list[int] = []
        """Periods that the plant has been told of."""
        self.kept.join(self)  # type: ignore[arg-type]

    def listen(self, _row: Any, callback: Callable[[Any], None], _quality: Any) -> None:
        self._hear = callback

    def sender(self, _row: Any, _quality: Any) -> "Run":
        return self

    def publish(self, data: bytes) -> None:
        self.filed.append(decode(FILED, data).stamp // CONTROL_PERIOD_NS)

    def hand_over(self, role: str, period: int, silent: str = "") -> None:
        stamp = period * CONTROL_PERIOD_NS
        state = RoleAtCheckpoint(RoleState(period, now=stamp), period + 1)
        extra = {ANSWERED: "" if silent else "drive", SILENT: silent} if role == "plant" else None
        for message in state_messages(role, stamp, Counters(), as_text(packed(state, role)), extra):
            self._hear(message)

    @property
    def files(self) -> Sequence[str]:
        return sorted(file.stem for file in self._folder.glob("*"))


@pytest.fixture
def run(tmp_path: Path) -> Run:
    return Run(tmp_path)


@pytest.mark.parametrize("order", [("drive", "plant"), ("plant", "drive")])
def test_a_run_that_is_ahead_of_who_writes_loses_none(run: Run, order: Sequence[str]) -> None:
    """On a busy machine the nodes come to the next period that is kept before the supervisor looks at itself again."""
    for period in (35, 70, 105):
        for role in order:
            run.hand_over(role, period)
    assert run.files == ["00000.70", "00001.40", "00002.10"] and not run.said
    assert run.filed == [35, 70, 105]


def test_it_waits_for_what_is_on_its_way(run: Run) -> None:
    run.hand_over("drive", 35)
    run.hand_over("drive", 70)
    run.hand_over("plant", 35)
    assert run.files == ["00000.70"] and run.filed == [35]
    run.hand_over("plant", 70)
    assert run.files == ["00000.70", "00001.40"] and not run.said


def test_one_of_which_a_part_never_comes_is_said_to_be_lost(run: Run) -> None:
    run.hand_over("plant", 35)
    for role in ROLES:
        run.hand_over(role, 70)
    assert run.files == ["00001.40"]
    assert run.said == ["the checkpoint of 0.70 s is lost: not all of it has come on /checkpoint/state"]


def test_what_comes_once_more_after_its_file_is_passed_over(run: Run) -> None:
    for _ in range(2):
        for role in ROLES:
            run.hand_over(role, 35)
        assert run.files == ["00000.70"] and not run.said


def test_states_that_never_become_whole_do_not_pile_up(run: Run) -> None:
    for period in range(1, MOST_WAITING + 4):
        run.hand_over("drive", period)
    assert [words.split()[3] for words in run.said] == ["0.02", "0.04", "0.06"]


def test_one_that_hands_over_nothing_is_named_once(run: Run) -> None:
    for period in (35, 70):
        run.hand_over("plant", period, silent="drive")
    assert not run.files and run.filed == [35, 70], "the plant does not wait for what never comes"
    (words,) = run.said
    assert words.endswith("no checkpoint of it is kept: drive has not handed over its state on /checkpoint/state")
