"""scripts/goal where nothing runs: one sentence, within five seconds."""

import re
import subprocess
import sys
import time
from typing import Any, ClassVar

import pytest

from sojourn_config.command_line import run_script
from sojourn_contract.codecs import encode
from sojourn_contract.heartbeat import (
    RUNNING,
    Counters,
    Heartbeat,
    heartbeat_message,
    read_heartbeats,
    status_values,
)
from sojourn_contract.topics import topic
from sojourn_operator import goal_client, goal_command
from sojourn_operator.fault_sending import CAME, NOT_THERE, REFUSED, WENT, answer_of, fault_event
from sojourn_operator.goal_client import main
from sojourn_operator.goal_sending import ANSWER_S


@pytest.mark.parametrize(("arguments", "who"), [(["drive", "1", "0"], "drive"), (["stop"], "drive or arm")])
def test_one_sentence(arguments: list[str], who: str) -> None:
    command = [
        sys.executable,
        "-m",
        "sojourn_operator.goal_client",
        *arguments,
        "--domain",
        "229",
        "--namespace",
        "none",
    ]
    begin = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True, timeout=600.0)
    assert time.monotonic() - begin > ANSWER_S  # a stack that is slow to be found gets its time
    assert done.returncode == 1
    (line,) = done.stderr.splitlines()
    assert f"no running stack for {who} on domain 229, namespace /none" in line and "scripts/start.py" in line


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("route 1 2 -3", "points: 3 numbers, allowed is an even count"),
        ("task dig depth", "'depth': allowed is KEY=VALUE"),
        ("drive 1 2 --over lunar_sample --frame odom", "--over: a route over the map ends in map"),
        ("fault nonsense joint=x", "kind = nonsense: allowed is one of"),
        ("fault motor_dead", r"joint: the key is missing: allowed is text .* \(joint with a motor\)"),
        ("fault motor_dead kind=nope joint=x", "kind = nope: allowed is one of"),
        ("fault motor_dead joint=x part=3", "part = 3: unknown key: allowed is one of"),
        ("fault motor_weak joint=x part=most", "part = 'most': is text: allowed is a number at least 0, below 1"),
        ("fault message_lost topic=/odom probability=0.5", "allowed in a scenario alone"),
        ("fault message_lost topic=/odom probability=0.5 at=3", "allowed in a scenario alone"),
        ("fault motor_dead joint=x lasts=2", "^lasts: allowed in a scenario alone: .*at once.*goes with --gone"),
        ("fault motor_dead joint=x at=1 until=4", "at and until: allowed in a scenario alone: .*at once.*--gone"),
        ("fault motor_dead joint=x --gone lasts=-1", "lasts: allowed in a scenario alone"),
    ],
)
def test_words_that_mean_nothing_end_with_status_2(command: str, said: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        run_script(main, command.split())
    assert ended.value.code == 2
    assert re.search(said, told := capsys.readouterr().err) and "required" not in told.lower()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--domain", "78", "fly", "3"], "'fly'"),
        (["fly", "3"], "'fly'"),
        (["--domain", "78"], "what to do is missing"),
        (["--domain", "78", "drive", "3"], "required: y"),
        (["task"], "required: name (see"),
        (["fault"], "required: kind (see"),
        (["cancel", "x"], "'x': allowed is a whole number"),
    ],
)
def test_wrong_words_are_told_by_their_names(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as end:
        main(arguments)
    assert end.value.code == 2
    assert said in capsys.readouterr().err


class Heard:
    """In place of the client of a running stack: keeps what is sent, and says that it was reached."""

    sent: ClassVar[list[tuple[str, str, Any]]] = []

    def __init__(self, *_: object) -> None:
        self.sent.clear()

    def __enter__(self) -> "Heard":
        return self

    def __exit__(self, *_: object) -> None: ...

    def send(self, who: str, name: str, message: Any) -> None:
        encode(topic(name), message)  # which refuses another type than the topic's
        self.sent.append((who, name, message))

    def follow(self, _who: str, _timeout_s: float) -> tuple[str, str]:
        return "reached", ""

    def answer(self, _timeout_s: float) -> dict[str, str]:
        return {"asked_state": "allowed"}


@pytest.mark.parametrize(
    ("command", "who", "name", "places", "frame"),
    [
        ("drive 1 2 --z 0.5", "drive", "/goal_pose", [(1.0, 2.0, 0.5)], "map"),
        ("--frame base_link --dry-run drive 1 2", "drive", "/drive/question", [(1.0, 2.0, 0.0)], "base_link"),
        (
            "--domain 7 --namespace arm arm 1 0 -0.2 --timeout 3",
            "arm",
            "/arm/goal_pose",
            [(1.0, 0.0, -0.2)],
            "base_link",
        ),
        (
            "--timeout 3 route --frame odom -1 2 3 -4",
            "drive",
            "/waypoints",
            [(-1.0, 2.0, 0.0), (3.0, -4.0, 0.0)],
            "odom",
        ),
        ("drive 1 2 --frame base_link --dry-run", "drive", "/drive/question", [(1.0, 2.0, 0.0)], "base_link"),
        ("route 1 2 3 4", "drive", "/waypoints", [(1.0, 2.0, 0.0), (3.0, 4.0, 0.0)], "map"),
        ("route 1 2 3 4 --dry-run", "drive", "/drive/question", [(1.0, 2.0, 0.0), (3.0, 4.0, 0.0)], "map"),
        ("route 1 2 --yaw -1 -3 -4e0", "drive", "/waypoints", [(1.0, 2.0, 0.0), (-3.0, -4.0, 0.0)], "map"),
        ("arm 1 0 -0.2", "arm", "/arm/goal_pose", [(1.0, 0.0, -0.2)], "base_link"),
    ],
)
def test_a_place_goes_out_on_the_topic_of_its_command(
    monkeypatch: pytest.MonkeyPatch, command: str, who: str, name: str, places: list[tuple[float, ...]], frame: str
) -> None:
    monkeypatch.setattr(goal_command, "GoalClient", Heard)
    assert main(command.split()) == 0
    ((told, on, message),) = Heard.sent
    assert (told, on, message.frame) == (who, name, frame)
    assert [tuple(pose.position) for pose in getattr(message, "poses", (message,))] == places


@pytest.mark.parametrize(
    ("command", "who", "name", "words"),
    [
        ("task tare seconds=2", "arm", "/arm/task", {"seconds": "2"}),
        ("task place position=1,0,0", "arm", "/arm/task", {"position": "1 0 0"}),
        ("power cameras off", "power", "/power/request", {"cameras": "off"}),
        ("task guarded_move --timeout 60 force=10", "arm", "/arm/task", {"force": "10"}),
        ("task --tim 60 guarded_move --domain=7 force=10 speed=1", "arm", "/arm/task", {"force": "10", "speed": "1"}),
    ],
)
def test_words_go_out_on_the_topic_of_their_command(
    monkeypatch: pytest.MonkeyPatch, command: str, who: str, name: str, words: dict[str, str]
) -> None:
    monkeypatch.setattr(goal_command, "GoalClient", Heard)
    assert main(command.split()) == 0
    ((told, on, message),) = Heard.sent
    assert (told, on, status_values(message)) == (who, name, words)


def test_an_option_between_a_fault_and_its_words_is_taken(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        run_script(main, ["fault", "motor_dead", "--domain", "79", "nope=3"])
    assert "nope = 3: unknown key" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["", "--domain 3", "drive", "--frame drive 1 2", "fly 1 2", "drive 1 2 --speed 3"])
def test_arguments_that_are_none_end_with_status_2(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(command.split())
    assert ended.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("goal") and "--help" in line


def beat(faults: str, refusals: int = 0) -> Heartbeat:
    counters = Counters(refused={"/faults": refusals} if refusals else {})
    (found,) = read_heartbeats(heartbeat_message("plant", RUNNING, 0, counters, extra={"faults": faults}))
    return found


@pytest.mark.parametrize(
    ("options", "before", "now", "outcome"),
    [
        ("", beat(""), beat("other, dead"), CAME),
        ("", beat(""), beat("", 1), REFUSED),
        ("--gone", beat("other, dead"), beat("other"), WENT),
        ("--gone", beat("other"), beat("other"), NOT_THERE),
        ("--gone", None, beat("other"), WENT),
    ],
)
def test_what_became_of_a_fault_by_hand_is_told_by_the_heartbeats(
    options: str, before: Heartbeat | None, now: Heartbeat, outcome: str
) -> None:
    given = goal_client.parser().parse_args(f"fault motor_dead --name dead {options}".split())
    event = fault_event(given, [("joint", "wheel_front_left_joint")])
    answer = answer_of(event, {} if before is None else {"plant": before}, {"plant": now})
    assert answer is not None and answer[0] == outcome


class FaultDesk(Heard):
    """A stack in which a fault has become of this."""

    outcome: ClassVar[str]

    beats: ClassVar[dict[str, Heartbeat]] = {}

    def hear_from(self, _role: str) -> None:
        pass

    def watch(self, *_: object) -> tuple[str, str]:
        return self.outcome, "dead of plant"


@pytest.mark.parametrize(("outcome", "status"), [(CAME, 0), (WENT, 0), (NOT_THERE, 1), (REFUSED, 1)])
def test_the_status_is_0_only_where_a_fault_has_come_or_gone(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], outcome: str, status: int
) -> None:
    monkeypatch.setattr(goal_command, "GoalClient", FaultDesk)
    monkeypatch.setattr(FaultDesk, "outcome", outcome, raising=False)
    assert main(["fault", "motor_dead", "joint=wheel_front_left_joint", "--gone"]) == status
    assert capsys.readouterr().out == f"{outcome}: dead of plant\n"
