"""Memory that a process holds, on Linux."""

import os
from pathlib import Path

_PAGE = os.sysconf("SC_PAGE_SIZE")


def memory_mb(pid: int | None = None) -> float:
    """Resident memory [MB] of a process, None for this one. Raises OSError where it has ended or nothing tells."""
    fields = Path(f"/proc/{'self' if pid is None else pid}/statm").read_text(encoding="ascii").split()
    return int(fields[1]) * _PAGE / 1e6
