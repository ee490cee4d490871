"""A program of the console beside the page, which yields to whatever else runs."""

import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

_NICE = 10


def start(
    module: str, arguments: Sequence[str] = (), in_background: bool = False, **pipes: Any
) -> "subprocess.Popen[Any]":
    """Start a module of ours as a program. Ctrl-C is for the page, which then ends it.

    Args:
        in_background: nobody waits for it, and it yields to what runs in other sessions, too: Linux shares the
            processor between sessions first, and `nice` counts within each (sched(7), autogroup).
        pipes: of subprocess.Popen.

    Raises OSError where it cannot be started.
    """
    command = ["nice", "-n", str(_NICE), sys.executable, "-m", module, *arguments]
    if not in_background:
        return subprocess.Popen(command, process_group=0, **pipes)
    program = subprocess.Popen(command, start_new_session=True, **pipes)
    with suppress(OSError):  # another system, or one without
        Path(f"/proc/{program.pid}/autogroup").write_text(str(_NICE))
    return program
