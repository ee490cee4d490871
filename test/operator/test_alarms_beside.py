"""The alarms beside a stack that ends, stands for a while, is gone without a word, or is started anew."""

import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from sojourn_bringup.alarms_live import AlarmDesk
from sojourn_bringup.contract_live import NothingRunsError
from sojourn_contract.heartbeat import ENDED, RUNNING, STALLED, Counters, heartbeat_message
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import STANDARD
from sojourn_contract.values import Clock, Message
from sojourn_operator.alarms.params import AlarmParams, Severity
from sojourn_operator.alarms.watch import Watch

Said = list[tuple[str, Message]]
BEATS = "/diagnostics"


USUAL = {"roles": AlarmParams.model_validate({"field": f"{BEATS}.state", "critical": {"equals": STALLED}})}


def beat(role: str, state: str, second: float, why: str = "") -> tuple[str, Message]:
    return BEATS, heartbeat_message(role, state, round(second * NANOSECONDS), Counters(), why)


def goes(second: float) -> Said:
    """What a stack says at a time [s]."""
    return [
        ("/clock", Clock(round(second * NANOSECONDS))),
        beat("plant", RUNNING, second),
        beat("drive", RUNNING, second),
    ]


class Beside(AlarmDesk):
    """In place of a desk beside a stack.

    Args:
        says: what comes in each half second of wall time, by its number.
    """

    def __init__(self, says: Callable[[int], Said], monkeypatch: pytest.MonkeyPatch) -> None:
        super().__init__(0, "", Watch(USUAL, STANDARD), "anna")
        self.says, self.wall, self.count = says, 1000.0, 0
        self.takes: dict[str, Any] = {}
        monkeypatch.setattr(time, "monotonic", lambda: self.wall)

    def listen(self, row: Topic, take: Any, lockstep: bool = True, role: str = "") -> Any:
        self.takes[row.name] = take

    def spin(self, wall_s: float) -> None:
        assert self.count < 1000, "it watches for ever"
        self.wall += 0.5
        self.count += 1
        for name, message in self.says(self.count - 1):
            if name in self.takes:
                self.takes[name](message)

    def texts(self, severity: Severity = Severity.CRITICAL) -> list[str]:
        """Of events that are as bad as that."""
        return [event.text for event in self.log if event.severity is severity]


@pytest.fixture(autouse=True)
def no_input(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    with Path(os.devnull).open(encoding="utf-8") as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        yield


def test_a_run_is_over_once_whoever_keeps_its_time_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In real time the others wait for it until they are ended, too: that was an alarm at every end."""
    ends = {
        20: [beat("plant", ENDED, 10.0)],
        21: [beat("drive", STALLED, 10.0, "waiting for /clock")],
        22: [beat("drive", ENDED, 10.0)],
    }
    desk = Beside(lambda number: goes(number / 2 + 1.0) if number < 20 else ends.get(number, []), monkeypatch)
    assert desk.run(None, publish=False)
    assert not desk.texts() and not desk.state.alarms.shown
    assert "the run is over" in capsys.readouterr().out
    assert [event.who for event in desk.log if event.text == ENDED] == ["plant", "drive"]


def test_whoever_goes_on_speaking_after_the_end_does_not_make_it_last(monkeypatch: pytest.MonkeyPatch) -> None:
    desk = Beside(lambda number: [beat("plant" if number == 5 else "other", ENDED, 3.0)], monkeypatch)
    assert desk.run(None, publish=False) and desk.count < 20


def test_another_node_that_ends_is_not_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    def says(number: int) -> Said:
        return goes(number / 2 + 1.0) + ([beat("drive", ENDED, 5.0)] if number == 10 else [])

    desk = Beside(says, monkeypatch)
    assert desk.run(60.0, publish=False) and desk.count > 100 and not desk.texts()


def test_a_stack_that_stands_for_a_while_is_told_and_followed_further(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its watcher had gone after 5 s, with status 0 and "the run is over"."""

    def says(number: int) -> Said:
        if 10 <= number < 50:  # for 20 s
            return [beat("drive", STALLED, 6.0, "waiting for /imu/data")] if number == 30 else []
        return goes(number / 2 + 1.0) if number < 100 else [beat("plant", ENDED, 50.0)] if number == 100 else []

    desk = Beside(says, monkeypatch)
    assert desk.run(None, publish=False)
    silence, stalled, _, again = desk.texts()
    assert silence.startswith("nothing has been heard of it for 5 s") and stalled == "stalled: waiting for /imu/data"
    assert again == silence  # 5 s after that word
    assert [event.text for event in desk.log if event.who == "run"].count("is heard again") == 2
    assert capsys.readouterr().out.count("the run is over") == 1


def test_a_stack_that_says_why_it_stands_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    def says(number: int) -> Said:
        if number < 10:
            return goes(number / 2 + 1.0)
        return [beat("drive", STALLED, 6.0, "waiting for /clock")] if number < 200 else [beat("plant", ENDED, 6.0)]

    desk = Beside(says, monkeypatch)
    assert desk.run(None, publish=False) and desk.count > 200


def test_a_stack_that_ends_after_a_silence_is_at_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """As one that is taken down where it has come to a stand."""
    ends = {40: [beat("plant", ENDED, 6.0), beat("drive", ENDED, 6.0)]}
    desk = Beside(lambda number: goes(number / 2 + 1.0) if number < 10 else ends.get(number, []), monkeypatch)
    assert desk.run(None, publish=False) and len(desk.texts()) == 1


def test_a_stack_that_is_gone_without_a_word_is_lost_in_the_end(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    desk = Beside(lambda number: goes(number / 2 + 1.0) if number < 10 else [], monkeypatch)
    assert not desk.run(None, publish=False)
    silence, lost = desk.log[-2:]
    assert silence.text.startswith("nothing has been heard") and "has the stack ended?" in lost.text
    assert silence.severity is lost.severity is Severity.CRITICAL
    assert 60 < desk.count < 80 and "the run is over" not in capsys.readouterr().out


def test_a_stack_that_is_gone_before_it_has_begun_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    desk = Beside(lambda number: [beat("plant", "ready", 0.0)] if number < 4 else [], monkeypatch)
    assert not desk.run(None, publish=False) and 60 < desk.count < 70


def test_who_leaves_a_silent_stack_is_told_so_by_the_status(monkeypatch: pytest.MonkeyPatch) -> None:
    desk = Beside(lambda number: goes(number / 2 + 1.0) if number < 10 else [], monkeypatch)
    assert not desk.run(15.0, publish=False)


def test_a_stack_that_is_started_anew_is_not_the_run_that_was_watched(monkeypatch: pytest.MonkeyPatch) -> None:
    desk = Beside(lambda number: goes((number % 40) / 2 + 1.0), monkeypatch)
    assert not desk.run(None, publish=False)
    assert desk.count == 41 and "started anew" in desk.texts()[0]


def test_a_stack_that_is_started_after_the_end_of_the_run_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    ends = {10: [beat("plant", ENDED, 6.0)]}
    desk = Beside(lambda number: ends.get(number, goes((number % 11) / 2 + 1.0)), monkeypatch)
    assert desk.run(None, publish=False) and not desk.texts()


def test_where_nothing_runs_that_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(NothingRunsError):
        Beside(lambda _: [], monkeypatch).run(None, publish=False)
