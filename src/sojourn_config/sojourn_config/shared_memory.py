"""Shared-memory files that a run could leave behind.

Our nodes talk over UDP, so the middleware makes none. But the ROS wheels load LTTng's tracing library, which makes
/dev/shm/lttng-ust-wait-* in any process and never removes it.
"""

import contextlib
import os
from pathlib import Path

SHARED_MEMORY = Path("/dev/shm")
PATTERN = "lttng-ust-wait-*"


def remove_tracing_files(folder: Path = SHARED_MEMORY) -> list[Path]:
    """Remove LTTng's files that are ours and that no other process uses. Returns those removed."""
    if not folder.is_dir():
        return []
    removed = []
    files = [path for path in folder.glob(PATTERN) if path.stat().st_uid == os.getuid()]
    used = _mapped_by_others() if files else ""
    for path in files:
        if str(path) not in used:
            with contextlib.suppress(OSError):
                path.unlink()
                removed.append(path)
    return removed


def _mapped_by_others() -> str:
    """Memory maps of all other processes that we may look into, as text."""
    texts = []
    for process in Path("/proc").glob("[0-9]*"):
        if process.name != str(os.getpid()):
            with contextlib.suppress(OSError):
                texts.append((process / "maps").read_text(errors="replace"))
    return "".join(text for text in texts if "lttng-ust-wait" in text)
