"""The folder of a run, runs/<time>/, and the link runs/latest."""

import contextlib
import itertools
import os
import tempfile
from datetime import datetime
from pathlib import Path

from sojourn_bringup.errors import UsageError
from sojourn_config.paths import repository_root

LATEST = "latest"


def make_run_folder(wanted: Path | None, runs: Path | None = None) -> Path:
    """Make the folder of a run and point runs/latest to it.

    Args:
        wanted: the folder to use; None for a new one, named by the time, in `runs` (default: runs/ of the repository).

    Raises:
        UsageError: it cannot be made or written, or holds a run already.
    """
    runs = runs if runs is not None else repository_root() / "runs"
    folder = wanted.expanduser().absolute() if wanted is not None else runs
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if wanted is None:
            folder = _new_folder(runs)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise UsageError(f"the run folder {folder} cannot be written: {error.strerror or error}") from error
    if (folder / "bag").exists() or (folder / "goals.json").exists():
        raise UsageError(f"the run folder {folder} holds a run already: name another one with --run-dir")
    if wanted is None:
        _point_latest(runs, folder)
    return folder


def _new_folder(runs: Path) -> Path:
    """Make a folder named by the time; two runs that start in one second get one each."""
    name = datetime.now().strftime("%Y-%m-%d_%H-%M-%S")
    for number in itertools.count(1):
        folder = runs / (name if number == 1 else f"{name}_{number}")
        with contextlib.suppress(FileExistsError):
            folder.mkdir()
            break
    return folder


def _point_latest(runs: Path, folder: Path) -> None:
    """Swap the link in one step, so that it points to one run or the other at any moment."""
    link, fresh = runs / LATEST, runs / f".{LATEST}.{os.getpid()}"
    try:
        fresh.symlink_to(folder.name)
        fresh.replace(link)
    except OSError as error:
        with contextlib.suppress(OSError):
            fresh.unlink()
        raise UsageError(f"{link} cannot be pointed to the new run: {error.strerror or error}") from error
