"""Becomes a command that dies with the process that started it: python -I -S child_process.py PARENT_PID COMMAND ...

Linux sends SIGKILL to the command if its parent ends in any way (prctl(2), PR_SET_PDEATHSIG; kept over execve). A
program of its own and not a function between fork and exec, which is not safe in a process with threads.
"""

import ctypes
import os
import signal
import sys

PR_SET_PDEATHSIG = 1
COMMAND_NOT_FOUND = 127


def dying_with_us(command: list[str]) -> list[str]:
    """The command that becomes `command`, and dies with this process."""
    return [sys.executable, "-I", "-S", __file__, str(os.getpid()), *command]


def die_with(parent: int) -> None:
    """Have this process killed when its parent ends; end it where that has ended already."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != parent:
        sys.exit(1)


def main() -> None:
    """Ask for the signal, look whether the parent still lives, and become the command."""
    parent, command = int(sys.argv[1]), sys.argv[2:]
    die_with(parent)
    # Python ignores SIGPIPE, and what is ignored stays ignored over execve
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    try:
        os.execvp(command[0], command)
    except OSError as error:
        print(f"{command[0]} cannot be started: {error.strerror}", file=sys.stderr)
        sys.exit(COMMAND_NOT_FOUND)


if __name__ == "__main__":
    main()
