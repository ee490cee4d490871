"""The folder of a run, runs/<time>/, and the link runs/latest."""

import contextlib
import itertools
import os
import tempfile
from datetime import datetime
from pathlib import Path

from sojourn_config.command_errors import UsageError
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
            folder = new_folder(runs)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise UsageError(f"the run folder {folder} cannot be written: {error.strerror or error}") from error
    if (folder / "bag").exists() or (folder / "goals.json").exists():
        raise UsageError(f"the run folder {folder} holds a run already: name another one with --run-dir")
    if wanted is None:
        _point_latest(runs, folder)
    return folder


class FolderWatch:
    """Notices that a folder has been removed, or another one put in its place."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._identity = self._look()

    def is_there(self) -> bool:
        """Whether the folder is still the one that it was."""
        return self._look() == self._identity

    def why_gone(self) -> str:
        """What ends a run whose folder has gone, as nothing that is written from here on would be found; else empty."""
        return "" if self.is_there() else f"the run folder {self._folder} is gone: somebody has removed or renamed it"

    def _look(self) -> tuple[int, int] | None:
        try:
            found = self._folder.stat()
        except OSError:
            return None
        return found.st_dev, found.st_ino


def new_folder(runs: Path) -> Path:
    """Make a folder named by the time in `runs`; two runs that start in one second get one each."""
    runs.mkdir(parents=True, exist_ok=True)
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
