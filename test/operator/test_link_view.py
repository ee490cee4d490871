"""What people on Earth are shown of their commands."""

from collections.abc import Callable
from typing import Any

import pytest

from sojourn_config.command_errors import CommandError
from sojourn_contract.heartbeat import status_message
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import DiagnosticArray, DiagnosticStatus, Message
from sojourn_operator.goal_client import parser
from sojourn_operator.link.commands import MachineWord, SentCommand, after_word
from sojourn_operator.link.view import CommandLines, LinkView


class FakeDesk:
    """Keeps who listens to what."""

    def __init__(self) -> None:
        self.takers: dict[str, Callable[[Message], None]] = {}

    def listen(self, row: Topic, take: Callable[[Message], None]) -> None:
        self.takers[row.name] = take


def status(*commands: SentCommand) -> DiagnosticArray:
    link = DiagnosticStatus("link", (("window", "open"), ("light_time_s", "1.300")))
    told = (DiagnosticStatus(f"command {one.number}", tuple(one.values().items()), one.state) for one in commands)
    return DiagnosticArray(10**9, (link, *told))


def test_a_command_is_told_line_by_line_and_each_line_once() -> None:
    desk, lines = FakeDesk(), CommandLines()
    any_desk: Any = desk
    view = LinkView(any_desk, {"drive": "/drive/status"})
    command = SentCommand(7, "/goal_pose", 5, queued=10**9, known=10**9)
    told = list[str]()
    for changed in (
        command,
        command,
        sent := command._replace(state="sent", sent=2 * 10**9, known=2 * 10**9),
        received := after_word(sent, MachineWord(7, "received", 3_300_000_000, given=44), 5 * 10**9),
        after_word(received, MachineWord(7, "executed", 9 * 10**9, "reached", "near"), 11 * 10**9),
    ):
        desk.takers["/link/status"](status(SentCommand(3, "/goal_pose", 4, 0), changed))
        told += lines.new(view.command("/goal_pose", 5), view.state)
    assert told == [
        "     1.00 s  queued (command 7; window open, light takes 1.300 s)",
        "     2.00 s  sent",
        "     3.30 s  received, as is known on Earth since 5.00 s",
        "     9.00 s  executed, as is known on Earth since 11.00 s",
    ]
    assert view.command("/goal_pose", 5)["machine_stamp"] == "44" and view.command("/waypoints", 5) == {}
    desk.takers["/earth/drive/status"](status_message(1, "drive", {"state": "idle"}))
    assert set(view.telemetry) == {"drive"}


@pytest.mark.parametrize("state", ["expired", "cancelled", "dropped", "superseded"])
def test_what_never_comes_to_an_end_is_told_too(state: str) -> None:
    command = SentCommand(1, "/goal_pose", 5, queued=10**9, state=state, known=6 * 10**9)
    told = list(CommandLines().new(command.values(), {}))
    assert told[-1] == f"     6.00 s  {state}"


def test_a_word_that_comes_late_takes_nothing_back() -> None:
    """Acknowledgements do not overtake each other, but one may be lost, or a command end before its receipt is told."""
    command = SentCommand(1, "/goal_pose", 5, queued=1, state="sent", sent=2)
    ended = after_word(command, MachineWord(1, "executed", 9, "reached"), 12)
    assert after_word(ended, MachineWord(1, "received", 3), 13) == ended


def test_cancel_takes_a_number_or_none() -> None:
    assert parser().parse_args(["cancel"]).number is None and parser().parse_args(["cancel", "4"]).number == 4


def test_cancel_where_nothing_runs() -> None:
    from sojourn_operator.goal_client import main

    with pytest.raises(CommandError, match="no running stack"):
        main(["cancel", "--domain", "229", "--namespace", "none"])
