"""What Linux tells of a process: the memory that it holds, and whether it is stopped.

Asked some hundred times a second through a long run. A `Path` for each time would put every part of its name among
those that Python keeps for good: what it keeps them in grows by megabytes, in jumps, though each is soon forgotten.
"""

import os

_PAGE = os.sysconf("SC_PAGE_SIZE")


def memory_mb(pid: int | None = None) -> float:
    """Resident memory [MB] of a process, None for this one. Raises OSError where it has ended or nothing tells."""
    return int(_told("self" if pid is None else pid, "statm").split()[1]) * _PAGE / 1e6


def is_stopped(pid: int) -> bool:
    """Whether a process has been stopped, by SIGSTOP or a debugger, and could go on. Raises OSError as above."""
    return _told(pid, "stat").rpartition(")")[2].split()[0] in ("T", "t")


def _told(process: int | str, file: str) -> str:
    with open(f"/proc/{process}/{file}", encoding="utf-8", errors="replace") as text:
        return text.read()
