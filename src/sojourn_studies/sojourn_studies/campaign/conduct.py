"""A campaign from its file to its page: the work of scripts/campaign."""

import argparse
import json
import os
import resource
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from hashlib import sha256
from typing import Any

from distributed import Client
from rich.console import Console

from sojourn_config.command_line import ONLY_OWNER
from sojourn_config.paths import repository_root
from sojourn_config.scenario import LoadedScenario
from sojourn_studies.campaign.alike import versions_here
from sojourn_studies.campaign.campaign_file import CampaignConfig, read_campaign
from sojourn_studies.campaign.carried import CarriedFiles, carry, named_there
from sojourn_studies.campaign.check import loaded, telling
from sojourn_studies.campaign.cluster import cores, join, threads, workers_here, workers_of
from sojourn_studies.campaign.draws import Draw, draws, override_texts
from sojourn_studies.campaign.findings import CampaignFindings
from sojourn_studies.campaign.folder import CampaignFolder, open_folder
from sojourn_studies.campaign.identity import FILES, JOURNAL, READ
from sojourn_studies.campaign.page import command_of, in_words, write_page
from sojourn_studies.campaign.progress import CampaignProgress, duration
from sojourn_studies.campaign.rounds import carry_out
from sojourn_studies.campaign.row import LOST
from sojourn_studies.campaign.table import COSTS, TABLE, schema, varied_keys, write_costs, write_table
from sojourn_studies.campaign.task import Finished, Order

PAGE = "report.html"


def run(given: argparse.Namespace) -> int:
    """Do a campaign, or be workers of one; the exit status."""
    os.umask(ONLY_OWNER)
    if given.join is not None:
        join(given.join, given.workers or cores())
    console = Console(highlight=False, soft_wrap=True)
    config, file = read_campaign(given.campaign)
    runs = draws(config)
    scenarios = loaded(telling(runs), file)
    if given.dry_run:
        for draw in runs:
            console.print(f"{draw.number}: {command_of(draw.scenario, draw.overrides)}", markup=False)
        return 0
    out = (given.out or repository_root() / "runs" / f"campaign_{file.stem}").expanduser().absolute()
    about = identity(config, scenarios)
    with _scheduler(given) as scheduler, open_folder(out, about) as folder:
        told = {name: value for name, value in about.items() if name != READ}
        campaign = Campaign(folder, config, runs, {"name": file.stem, "description": config.description, **told})
        try:
            campaign.carry_out(scheduler, given.workers or cores(), carry(scenarios.values()), console)
        finally:
            campaign.write()
        campaign.tell(console)
        return int(any(row["result"] == LOST for row in campaign.rows))


def identity(config: CampaignConfig, scenarios: Mapping[int, LoadedScenario]) -> dict[str, Any]:
    """What the runs go by, by name: two campaigns in which any of it differs have no common table. More runs of the
    same make no other campaign, unless each of them depends on how many there are.

    Args:
        scenarios: that tell which files are read, by the numbers of their runs.
    """
    campaign = config.model_dump(mode="json", exclude={"description"})
    if config.sampling != "latin_hypercube":
        del campaign["runs"]
    files: dict[str, str] = {}
    read: dict[str, str] = {}
    for number, one in scenarios.items():
        own = {name: _digest(text) for name, text in one.files.items()}
        own |= {name: digest[:16] for name, digest in one.digests.items()}
        files |= own
        read[f"by run {number}"] = _digest(json.dumps(own, sort_keys=True))
    return {"campaign": campaign, FILES: dict(sorted(files.items())), READ: read, "versions": dict(versions_here())}


class Campaign:
    """One campaign in its folder.

    Args:
        folder: open. config: its file. runs: all of them. about: what the page says of it.
    """

    def __init__(
        self, folder: CampaignFolder, config: CampaignConfig, runs: Sequence[Draw], about: Mapping[str, Any]
    ) -> None:
        self.folder, self.config, self.runs, self.about = folder, config, runs, about

    @property
    def rows(self) -> list[dict[str, Any]]:
        """Of the runs that are done, by number."""
        return [self.folder.rows[number] for number in sorted(self.folder.rows) if number < len(self.runs)]

    def orders(self) -> Iterator[Order]:
        """What is left to be done; what was lost comes last, as it may be lost again."""
        done, versions = self.folder.done(), versions_here()
        left = [draw for draw in self.runs if draw.number not in done]
        for draw in sorted(left, key=lambda one: one.number in self.folder.rows):
            set_there = {key: named_there(value) for key, value in (self.config.set | dict(draw.values)).items()}
            scenario = str(set_there.pop("scenario", named_there(draw.scenario)))
            yield Order(draw, scenario, override_texts(set_there), self.config.keep.failures, versions)

    def carry_out(self, scheduler: Client | None, here: int, carried: CarriedFiles, console: Console) -> None:
        """Do what is left.

        Args:
            scheduler: whose workers do it; None: processes on this machine, `here` at most.
        """
        orders = list(self.orders())
        if not orders:
            return
        done = len(self.runs) - len(orders)
        console.print(f"campaign {self.folder.path}: {done} of {len(self.runs)} runs are done", markup=False)
        for line in self.folder.unreadable:
            console.print(
                f"{self.folder.path / JOURNAL}, line {line}: it is no row of a run and is passed over; a run that has "
                "no other line is done again",
                markup=False,
            )
        most = min(here, len(orders))
        with self._workers(scheduler, most) as client, CampaignProgress(len(self.runs), done, console) as progress:
            stopwatch = _Stopwatch(threads(client))

            def take(finished: Finished) -> None:
                self.folder.take(finished)
                stopwatch.count(finished.cost)
                progress.count(finished.row["result"])

            carry_out(client, orders, carried, take)
            words = stopwatch.words()
        console.print(words, markup=False)

    def write(self) -> None:
        """Table, costs and page of what is done; nothing where that is nothing. Raises CampaignError."""
        if not self.rows:
            return
        path = self.folder.path
        found = self._findings()
        shown = {row["run"]: self.runs[row["run"]] for row in found.worst()}
        commands = {number: command_of(draw.scenario, draw.overrides) for number, draw in shown.items()}
        with self.folder.writing():
            write_table(path / TABLE, self.rows, schema(self.runs))
            write_costs(path / COSTS, self.folder.costs)
            write_page(path / PAGE, found, self.about, commands)

    def tell(self, console: Console) -> None:
        """What came of it, in two lines, and in a third what was lost."""
        found = self._findings()
        console.print(
            f"{found.rate.met} of {found.rate.runs} runs met their goals: {in_words(found.rate)}", markup=False
        )
        console.print(f"{self.folder.path / PAGE}, and {TABLE} beside it", markup=False)
        lost = Counter(row["reason"] for row in self.rows if row["result"] == LOST)
        if lost:
            console.print(
                f"{lost.total()} runs were lost and are not judged ({lost.most_common(1)[0][0]}): the same command "
                "tries them once more",
                markup=False,
            )

    def _findings(self) -> CampaignFindings:
        return CampaignFindings(self.rows, varied_keys(self.runs), len(self.runs))

    @contextmanager
    def _workers(self, scheduler: Client | None, here: int) -> Iterator[Client]:
        if scheduler is not None:
            yield scheduler
            return
        with self.folder.writing():
            self.folder.work.mkdir(exist_ok=True)
        with workers_here(here, self.folder.work) as client:
            yield client


@contextmanager
def _scheduler(given: argparse.Namespace) -> Iterator[Client | None]:
    """The scheduler that was asked for, None for none: reached before a folder is made, so that a wrong one leaves
    nothing. Raises UsageError.
    """
    if given.scheduler is None:
        yield None
        return
    with workers_of(given.scheduler, versions_here()) as client:
        yield client


class _Stopwatch:
    """What the machinery of a campaign costs beside its runs."""

    def __init__(self, threads: int) -> None:
        self._threads, self._runs, self._busy_s = threads, 0, 0.0
        self._began, self._spent = time.monotonic(), _own_s()

    def count(self, cost: Mapping[str, Any]) -> None:
        self._runs += 1
        self._busy_s += cost.get("wall_s", 0.0)

    def words(self) -> str:
        wall = time.monotonic() - self._began
        busy = 100.0 * self._busy_s / (wall * self._threads)
        own = (_own_s() - self._spent) / max(self._runs, 1)
        return (
            f"{self._runs} runs in {duration(wall)}, {self._threads} at a time; workers were at work for {busy:.0f} % "
            f"of it; handing out and collecting took {1000.0 * own:.0f} ms of processor time a run"
        )


def _digest(text: str) -> str:
    return sha256(text.encode()).hexdigest()[:16]


def _own_s() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime
