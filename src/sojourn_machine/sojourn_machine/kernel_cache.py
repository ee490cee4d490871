"""Where numba keeps the compiled kernels: one folder for each version of their sources.

numba renews a cached function when its own file changes, but not when a kernel that it calls lives in another
file and changes there: the caller would go on with the old code. A folder named after all kernel sources
together rules that out.
"""

import hashlib
import importlib.util
import os
import shutil
import time
from collections.abc import Iterator
from pathlib import Path

HOME = Path(__file__).resolve().parent / "__pycache__"
PACKAGES = ("sojourn_machine", "sojourn_physics", "sojourn_flight", "sojourn_analysis")
"""Those with kernels in them; one that is not installed is left out."""
PREFIX = "kernels-"
MARKS = (b"sojourn_machine.kernels", b"njit", b"IntEnum", b"compiled into kernels")
"""What tells a file that counts: kernels, columns that are compiled into them as numbers, and constants of which it is
said. `scripts/lib/environment.sh` asks the same."""
KEPT_S = 86400.0
"""A folder that was touched within this time may be in use by another process [s]."""


def package_folders() -> Iterator[Path]:
    """Folders of the packages with kernels; none of them is imported for it."""
    for name in PACKAGES:
        found = importlib.util.find_spec(name)
        if found is not None and found.origin is not None:
            yield Path(found.origin).resolve().parent


def sources_digest() -> str:
    """Digest of every file of these packages that has kernels, or their columns, in it."""
    digest = hashlib.sha256()
    for package in package_folders():
        for path in sorted(package.rglob("*.py")):
            text = path.read_bytes()
            if any(mark in text for mark in MARKS):
                digest.update(path.relative_to(package.parent).as_posix().encode() + text)
    return digest.hexdigest()[:16]


def cache_folder() -> Path | None:
    """Folder of the present sources; those that nobody has used for a while are removed.

    None where it cannot be written, or where NUMBA_CACHE_DIR is set: numba's own choice stands.
    """
    if "NUMBA_CACHE_DIR" in os.environ or not os.access(HOME.parent, os.W_OK):
        return None
    folder = HOME / (PREFIX + sources_digest())
    if not folder.exists():
        for old in HOME.glob(PREFIX + "*"):
            if time.time() - old.stat().st_mtime > KEPT_S:
                shutil.rmtree(old, ignore_errors=True)
    return folder
