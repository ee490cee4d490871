"""scripts/contract check --exec: a program alone, judged by the contract while a reference bag is played to it."""

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from programs import PATIENT_BENCH, Program

Start = Callable[..., Program]
FLIGHT_DRIVE = f"{sys.executable} {Path(__file__).parent / 'flight_drive.py'}"

DROWSY = """
import math
import numpy as np
from sojourn_contract import process
from sojourn_drive.node import DriveNode

class Drowsy(DriveNode):
    def publish(self, topic, message):
        if topic == "/odom" and message.stamp == 4_000_000_000:
            return
        if topic == "/drive_command" and message.stamp == 6_000_000_000:
            message = message._replace(velocity=np.array([math.nan, *message.velocity[1:]]))
        super().publish(topic, message)

process.run(Drowsy)
"""


def test_a_program_that_knows_nothing_of_ours_keeps_the_contract(start: Start, domain: int) -> None:
    """Its answers are not those of our drive, and need not be."""
    program = start(
        "contract_tool", "check", "--exec", FLIGHT_DRIVE, "--role", "drive", "--domain", domain, *PATIENT_BENCH
    )
    assert program.wait() == 0, program.text
    assert f"{FLIGHT_DRIVE} keeps the contract: no violation" in program.text.splitlines()[-1]
    assert not program.leaves_processes()


def test_what_a_program_does_wrong_is_told_with_topic_stamp_and_field(
    start: Start, domain: int, tmp_path: Path
) -> None:
    candidate, verdict = tmp_path / "candidate.py", tmp_path / "verdict.json"
    candidate.write_text(DROWSY, encoding="utf-8")
    command = f"{sys.executable} {candidate}"
    options = ("--role", "drive", "--domain", domain, "--json", verdict, *PATIENT_BENCH)
    program = start("contract_tool", "check", "--exec", command, *options)
    assert program.wait() == 1, program.text
    assert "/drive_command at 6.00 s: velocity[wheel_front_left_joint] = NaN" in program.text
    assert "/odom at 4.00 s: header.stamp = missing" in program.text
    assert program.text.splitlines()[-1].startswith("2 violations on 2 topics")
    assert json.loads(verdict.read_text())["participants"] == ["drive"]
    assert not program.leaves_processes()


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("sh -c 'sleep 1000'", "drive is not ready after 2 s of wall time: it does not publish /odom"),
        ("false", "ended with status 1 (it was not ready yet)"),
        ("no_such_program", "no_such_program"),
    ],
)
def test_a_program_that_never_answers_or_dies(command: str, words: str, start: Start, domain: int) -> None:
    wait_s = "2" if words.startswith("drive is not ready") else "600"
    arguments = ("--role", "drive", "--domain", domain, "--timeout", "300", "--start-timeout", wait_s)
    program = start("contract_tool", "check", "--exec", command, *arguments)
    assert program.wait() == 1, program.text
    (line,) = (line for line in program.text.splitlines() if not line.startswith("note: "))
    assert words in line
    assert not program.leaves_processes()
