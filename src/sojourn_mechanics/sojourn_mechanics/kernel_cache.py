"""Where numba keeps the compiled kernels: one folder for each version of their sources.

numba renews a cached function when its own file changes, but not when a kernel that it calls lives in another
file and changes there: the caller would go on with the old code. A folder named after all kernel sources
together rules that out.
"""

import hashlib
import os
import shutil
import time
from pathlib import Path

import numba

PACKAGE = Path(__file__).resolve().parent
PREFIX = "kernels-"
KEPT_S = 86400.0
"""A folder that was touched within this time may be in use by another process [s]."""


def sources_digest() -> str:
    """Digest of every file of the package that has kernels in it."""
    digest = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*.py")):
        text = path.read_bytes()
        if b"njit" in text:
            digest.update(path.relative_to(PACKAGE).as_posix().encode() + text)
    return digest.hexdigest()[:16]


def use_versioned_cache() -> None:
    """Point numba at the folder of the present sources, and remove folders that nobody has used for a while.

    Where the package's folder cannot be written, or NUMBA_CACHE_DIR is set, numba's own choice stands.
    """
    home = PACKAGE / "__pycache__"
    if "NUMBA_CACHE_DIR" in os.environ or not os.access(PACKAGE, os.W_OK):
        return
    folder = home / (PREFIX + sources_digest())
    if not folder.exists():
        for old in home.glob(PREFIX + "*"):
            if time.time() - old.stat().st_mtime > KEPT_S:
                shutil.rmtree(old, ignore_errors=True)
    numba.config.CACHE_DIR = str(folder)
