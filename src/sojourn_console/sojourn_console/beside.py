"""A program of the console beside the page, which yields to whatever else runs."""

import subprocess
import sys
from collections.abc import Sequence
from typing import Any

_NICE = 10


def start(module: str, arguments: Sequence[str] = (), **pipes: Any) -> "subprocess.Popen[Any]":
    """Start a module of ours as a program. pipes: of subprocess.Popen. Ctrl-C is for the page, which then ends it.

    Raises OSError where it cannot be started.
    """
    command = ["nice", "-n", str(_NICE), sys.executable, "-m", module, *arguments]
    return subprocess.Popen(command, process_group=0, **pipes)
