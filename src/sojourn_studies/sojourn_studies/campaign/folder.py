"""The folder of a campaign: what it is of, each finished run as it comes, and the table of all.

    campaign.json   which campaign: its file, the files and versions that its runs go by
    journal.jsonl   a line for each run, on the disk before the next one is asked for
    runs/00017/     bag, report and summary of a run that is kept
    table.parquet   the rows, by the number of the run; costs.parquet what they cost
    report.html     what came of it

Killed at any moment it goes on: what is in the journal is done, a line that was cut off is not.
"""

import fcntl
import json
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sojourn_config.command_errors import UsageError
from sojourn_studies.campaign.carried import unpack
from sojourn_studies.campaign.row import LOST
from sojourn_studies.campaign.task import Finished

IDENTITY, JOURNAL, RUNS, LOCK, WORK = "campaign.json", "journal.jsonl", "runs", "lock", "work"


class CampaignFolder:
    """An open folder.

    Args:
        path: of the folder. rows, costs: of the runs that are done, by number.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.rows: dict[int, dict[str, Any]] = {}
        self.costs: dict[int, dict[str, Any]] = {}
        self._read_journal()

    @property
    def work(self) -> Path:
        """Where workers of this machine keep what they need; removed at the end."""
        return self.path / WORK

    def done(self) -> set[int]:
        """Numbers of the runs that need not be done again; one whose worker was lost is tried once more."""
        return {number for number, row in self.rows.items() if row["result"] != LOST}

    def take(self, finished: Finished) -> None:
        """Keep a run: its files first, then its line, so that what the journal has is there."""
        number = finished.row["run"]
        if finished.kept:
            place = self.place_of(number)
            fresh = place.with_suffix(".fresh")
            for old in (fresh, place):
                shutil.rmtree(old, ignore_errors=True)
            fresh.mkdir(parents=True)
            unpack(finished.kept, fresh)
            fresh.rename(place)
        line = json.dumps({"row": finished.row, "cost": finished.cost}, ensure_ascii=False, allow_nan=False)
        with (self.path / JOURNAL).open("ab") as file:
            file.write(line.encode() + b"\n")
            file.flush()
            os.fsync(file.fileno())
        self.rows[number], self.costs[number] = finished.row, finished.cost

    def place_of(self, number: int) -> Path:
        """Folder of a run that is kept."""
        return self.path / RUNS / f"{number:05d}"

    def _read_journal(self) -> None:
        journal = self.path / JOURNAL
        if not journal.is_file():
            return
        content = journal.read_bytes()
        whole = content[: content.rfind(b"\n") + 1]
        for line in whole.splitlines():
            entry = json.loads(line)
            number = entry["row"]["run"]
            self.rows[number], self.costs[number] = entry["row"], entry["cost"]
        if len(whole) < len(content):  # killed in the middle of a line
            with journal.open("r+b") as file:
                file.truncate(len(whole))


@contextmanager
def open_folder(path: Path, identity: Mapping[str, Any]) -> Iterator[CampaignFolder]:
    """The folder of a campaign, made where it is not there; one process at a time has it.

    Args:
        identity: what its runs go by, as plain JSON values by name.

    Raises:
        UsageError: it cannot be made or written, is in use, or is another campaign's.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        lock = (path / LOCK).open("a")
    except OSError as error:
        raise UsageError(f"{path}: the folder of the campaign cannot be written: {error.strerror}") from error
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise UsageError(f"{path}: another process works on this campaign: let it end, or stop it") from error
        _check_identity(path, json.loads(json.dumps(identity)))
        try:
            yield CampaignFolder(path)
        finally:
            shutil.rmtree(path / WORK, ignore_errors=True)


def _check_identity(path: Path, identity: dict[str, Any]) -> None:
    file = path / IDENTITY
    if not (file.exists() and (path / JOURNAL).exists()):
        others = [one.name for one in path.iterdir() if one.name != LOCK]
        if others and not file.exists():
            raise UsageError(f"{path}: holds {others[0]} and is no folder of a campaign: name an empty one with --out")
        fresh = file.with_suffix(".fresh")
        fresh.write_text(json.dumps(identity, indent=1), encoding="utf-8")
        fresh.rename(file)
        return
    try:
        before = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UsageError(f"{file}: cannot be read: {error}") from error
    differing = [name for name in identity if before.get(name) != identity[name]]
    if differing:
        words = "; ".join(_difference(name, before.get(name), identity[name]) for name in differing)
        raise UsageError(
            f"{path} is the folder of another campaign: {words}. A table has the runs of one campaign: name another "
            "folder with --out"
        )


def _difference(name: str, before: Any, now: Any) -> str:
    if isinstance(before, dict) and isinstance(now, dict):
        keys = [key for key in {**before, **now} if before.get(key) != now.get(key)]
        return f"{name}: {', '.join(keys[:5])}{' and more' if len(keys) > 5 else ''} differ"
    return f"{name} was {json.dumps(before)}, and is {json.dumps(now)}"
