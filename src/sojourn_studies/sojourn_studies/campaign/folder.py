"""The folder of a campaign: what it is of, each finished run as it comes, and the table of all.

    campaign.json   which campaign: its file, the files and versions that its runs go by
    journal.jsonl   a line for each run, on the disk before the next one is asked for
    runs/00017/     bag, report and summary of a run that is kept
    table.parquet   the rows, by the number of the run; costs.parquet what they cost
    report.html     what came of it

Killed at any moment it goes on: what is in the journal is done, a line that was cut off is not, nor one that is no row
of a run (zeros after a power cut): such a line is passed over and, but for the last, left as it is.
"""

import fcntl
import json
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from sojourn_config.command_errors import UsageError
from sojourn_studies.campaign.carried import unpack
from sojourn_studies.campaign.errors import CampaignError
from sojourn_studies.campaign.identity import JOURNAL, LOCK, check_identity
from sojourn_studies.campaign.row import ENDS, LOST
from sojourn_studies.campaign.task import Finished

RUNS, WORK = "runs", "work"


class CampaignFolder:
    """An open folder.

    Args:
        path: of the folder. place: which folder that was when it was opened.

    Attributes:
        rows, costs: of the runs that are done, by number.
        unreadable: numbers from 1 of the journal's lines that are no row of a run. They are passed over.

    Raises:
        OSError: its journal cannot be read.
    """

    def __init__(self, path: Path, place: os.stat_result) -> None:
        self.path = path
        self._place = place
        self.rows: dict[int, dict[str, Any]] = {}
        self.costs: dict[int, dict[str, Any]] = {}
        self.unreadable: list[int] = []
        self._read_journal()

    @property
    def work(self) -> Path:
        """Where workers of this machine keep what they need; removed at the end."""
        return self.path / WORK

    def done(self) -> set[int]:
        """Numbers of the runs that need not be done again; one that was lost is tried once more."""
        return {number for number, row in self.rows.items() if row["result"] != LOST}

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Write into the folder while the context is open.

        Raises:
            CampaignError: it is not there any more, or cannot be written.
        """
        try:
            there = os.path.samestat(self.path.stat(), self._place)
        except OSError:
            there = False
        if not there:  # workers may have made another one there, to which this campaign's rows do not go
            raise CampaignError(
                f"{self.path}: the folder of the campaign was moved or removed while the campaign ran: put it back, "
                "and the same command goes on with the rest"
            )
        try:
            yield
        except OSError as error:
            raise CampaignError(
                f"{self.path}: the folder of the campaign cannot be written: {error.strerror or error}; what its "
                "journal has is kept: the same command goes on with the rest"
            ) from error

    def take(self, finished: Finished) -> None:
        """Keep a run: its files first, then its line, so that what the journal has is there. Raises CampaignError."""
        number = finished.row["run"]
        with self.writing():
            if finished.kept:
                self._keep(number, finished.kept)
            line = json.dumps({"row": finished.row, "cost": finished.cost}, ensure_ascii=False, allow_nan=False)
            with (self.path / JOURNAL).open("ab") as file:
                file.write(line.encode() + b"\n")
                file.flush()
                os.fsync(file.fileno())
        self.rows[number], self.costs[number] = finished.row, finished.cost

    def place_of(self, number: int) -> Path:
        """Folder of a run that is kept."""
        return self.path / RUNS / f"{number:05d}"

    def _keep(self, number: int, content: bytes) -> None:
        place = self.place_of(number)
        fresh = place.with_suffix(".fresh")
        for old in (fresh, place):
            shutil.rmtree(old, ignore_errors=True)
        fresh.mkdir(parents=True)
        unpack(content, fresh)
        fresh.rename(place)

    def _read_journal(self) -> None:
        journal = self.path / JOURNAL
        if not journal.exists():
            return
        content = journal.read_bytes()
        whole = content[: content.rfind(b"\n") + 1]
        lines = whole.split(b"\n")[:-1]
        for number, line in enumerate(lines, 1):
            entry = _entry(line)
            if entry is not None:
                row, cost = entry
                self.rows[row["run"]], self.costs[row["run"]] = row, cost
            elif number < len(lines):
                self.unreadable.append(number)
            else:
                whole = whole[: -len(line) - 1]
        if len(whole) < len(content):  # killed in the middle of a line, or its end did not come to the disk
            with journal.open("r+b") as file:
                file.truncate(len(whole))


@contextmanager
def open_folder(path: Path, identity: Mapping[str, Any]) -> Iterator[CampaignFolder]:
    """The folder of a campaign, made where it is not there; one process at a time has it.

    Args:
        identity: what its runs go by, as plain JSON values by name.

    Raises:
        UsageError: it cannot be made, read or written, is in use, or is another campaign's.
    """
    with ExitStack() as held:
        try:
            path.mkdir(parents=True, exist_ok=True)
            lock = held.enter_context((path / LOCK).open("a"))
            place = held.enter_context(_held(path))
        except OSError as error:
            raise UsageError(f"{path}: the folder of the campaign cannot be written: {error.strerror}") from error
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise UsageError(f"{path}: another process works on this campaign: let it end, or stop it") from error
        try:
            check_identity(path, json.loads(json.dumps(identity)))
            folder = CampaignFolder(path, place)
        except OSError as error:
            raise UsageError(f"{path}: the folder of the campaign cannot be read or written: {error}") from error
        try:
            yield folder
        finally:
            shutil.rmtree(path / WORK, ignore_errors=True)


@contextmanager
def _held(path: Path) -> Iterator[os.stat_result]:
    """Which folder it is. While the context is open no other comes to have the same number."""
    place = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        yield os.fstat(place)
    finally:
        os.close(place)


def _entry(line: bytes) -> tuple[dict[str, Any], dict[str, Any]] | None:
    """Row and cost of a line of the journal; None where it has none, as after a power cut."""
    try:
        entry = json.loads(line)
        row, cost = entry["row"], entry["cost"]
        fits = isinstance(row["run"], int) and row["result"] in ENDS and isinstance(cost, dict)
    except (ValueError, LookupError, TypeError):
        return None
    return (row, cost) if fits else None
