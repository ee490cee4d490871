"""scripts/goal where nothing runs: one sentence, within five seconds."""

import subprocess
import sys
import time

import pytest

from sojourn_config.command_errors import CommandError
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


def test_a_route_needs_pairs() -> None:
    with pytest.raises(CommandError, match="points: 3 numbers, allowed is an even count"):
        main(["route", "1", "2", "-3"])
