"""Runs over real workers that die, and over workers that can do nothing: each run has its row once."""

import os
import signal
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import dask
import pytest
from distributed import Client, Future, LocalCluster
from distributed.comm import CommClosedError

from sojourn_studies.campaign import cluster, rounds
from sojourn_studies.campaign.carried import CarriedFiles
from sojourn_studies.campaign.draws import Draw
from sojourn_studies.campaign.errors import CampaignError
from sojourn_studies.campaign.row import LOST, MET, unfinished_row
from sojourn_studies.campaign.task import Finished, Order

CARRIED = CarriedFiles({"config/x.yaml": b"1"})
Task = Callable[[Order, CarriedFiles], Finished]


def orders(count: int) -> list[Order]:
    return [Order(Draw(number, "flat_drive", {}, ()), "flat_drive", (), True, ()) for number in range(count)]


def deadly(folder: Path, number: int, kills: int) -> Task:
    """A task that kills its process the first times that this run is done. It goes to the workers as it is, as they
    cannot import this module.
    """

    def task(order: Order, carried: CarriedFiles) -> Finished:
        if order.draw.number == number and len(os.listdir(folder)) < kills:
            (folder / str(len(os.listdir(folder)))).touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return Finished({"run": order.draw.number, "result": "met" if carried.files else "raised"})

    return task


def results(folder: Path, workers: int, allowed: int) -> dict[int, Any]:
    """Of eight runs on workers of which so many may die of a run."""
    taken: list[Finished] = []
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": allowed}),
        cluster.workers_here(workers, folder) as client,
    ):
        rounds.carry_out(client, orders(8), CARRIED, taken.append)
    assert len(taken) == 8, "each is taken once"
    return {one.row["run"]: one.row for one in taken}


@pytest.mark.parametrize("workers", [1, 2])
def test_a_campaign_goes_on_when_a_worker_dies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, workers: int) -> None:
    (tmp_path / "kills").mkdir()
    monkeypatch.setattr(rounds, "do", deadly(tmp_path / "kills", 1, kills=1))
    rows = results(tmp_path / "work", workers, allowed=3)
    assert [rows[number]["result"] for number in range(8)] == [MET] * 8


@pytest.mark.parametrize("workers", [1, 2])
def test_only_the_run_that_kills_its_workers_is_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, workers: int
) -> None:
    (tmp_path / "kills").mkdir()
    monkeypatch.setattr(rounds, "do", deadly(tmp_path / "kills", 1, kills=1000))
    rows = results(tmp_path / "work", workers, allowed=0)
    assert [rows[number]["result"] for number in range(8)] == [MET, LOST, *[MET] * 6]
    assert rows[1]["reason"].startswith("each of the 1 workers that had it died, the last of them tls://127.0.0.1:")


@pytest.mark.parametrize("gone", ["before the first is fetched", "when the first was taken"])
def test_it_stops_where_no_worker_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, gone: str) -> None:
    """It waited without end for one that could not be started again."""
    monkeypatch.setattr(rounds, "do", deadly(tmp_path, 1, kills=0))
    monkeypatch.setitem(cluster._QUIET, "distributed.scheduler.no-workers-timeout", "1s")
    taken: list[Finished] = []
    with cluster.workers_here(1, tmp_path / "work") as client:

        def end_workers() -> None:
            client.cluster.scale(0)
            while client.scheduler_info()["workers"]:
                time.sleep(0.01)

        def result(future: Future) -> Any:
            if gone == "before the first is fetched":
                end_workers()
            return fetched(future)

        def take(finished: Finished) -> None:
            taken.append(finished)
            end_workers()

        fetched = Future.result
        monkeypatch.setattr(Future, "result", result)
        with pytest.raises(CampaignError, match=r"for 1 s there was no worker; .*the same command"):
            rounds.carry_out(client, orders(100), CARRIED, take)
    assert len(taken) < 100


def test_it_stops_where_the_scheduler_is_gone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rounds, "do", deadly(tmp_path, 1, kills=0))
    taken: list[Finished] = []
    with cluster.workers_here(1, tmp_path / "work") as client:

        def take(finished: Finished) -> None:
            taken.append(finished)
            client.cluster.close()

        with pytest.raises(CampaignError, match=r"the scheduler is gone; .*the same command"):
            rounds.carry_out(client, orders(100), CARRIED, take)
    assert 1 <= len(taken) < 100


@pytest.mark.parametrize("error", [CommClosedError("Stream is closed"), AttributeError("gather")])
def test_a_scheduler_that_goes_while_a_run_is_fetched_loses_no_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    """The run had a row that told of a closed stream."""

    def result(future: Future) -> Any:
        raise error

    monkeypatch.setattr(rounds, "do", deadly(tmp_path, 1, kills=0))
    taken: list[Finished] = []
    with cluster.workers_here(1, tmp_path / "work") as client:
        monkeypatch.setattr(Future, "result", result)
        with pytest.raises(CampaignError, match="the scheduler is gone"):
            rounds.carry_out(client, orders(2), CARRIED, taken.append)
    assert not taken


def test_two_campaigns_on_one_scheduler_have_each_its_own_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    """The second had the rows and the configuration of the first, as a scheduler does what has a key once."""

    def whose(order: Order, carried: CarriedFiles) -> Finished:
        return Finished({"run": order.draw.number, "result": MET, "of": (order.scenario, carried.files)})

    monkeypatch.setattr(rounds, "do", whose)
    taken: dict[str, list[Finished]] = {"one": [], "other": []}

    def carry_out(client: Client, name: str, take: Callable[[Finished], None]) -> None:
        own = (replace(order, scenario=name) for order in orders(8))
        rounds.carry_out(client, own, CarriedFiles({name: b"1"}), take)

    with (
        LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as here,
        Client(here, set_as_default=False) as one,
        Client(here, set_as_default=False) as other,
    ):

        def take(finished: Finished) -> None:
            taken["one"].append(finished)
            if len(taken["one"]) == 1:  # while others of the first are under way
                carry_out(other, "other", taken["other"].append)

        carry_out(one, "one", take)
    for name, ended in taken.items():
        assert sorted(run.row["run"] for run in ended) == list(range(8))
        assert [run.row["of"] for run in ended] == [(name, {name: b"1"})] * 8


def taken_until_the_end(task: Task, count: int, monkeypatch: pytest.MonkeyPatch) -> list[Finished]:
    """What is taken of a campaign that does not come to its end, on one worker in this process."""
    monkeypatch.setattr(rounds, "do", task)
    taken: list[Finished] = []
    with (
        LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as here,
        Client(here, set_as_default=False) as client,
        pytest.raises(CampaignError, match=r"5 runs one after the other were lost, .* No space left.*the same command"),
    ):
        rounds.carry_out(client, orders(count), CARRIED, taken.append)
    return taken


def test_it_stops_where_run_after_run_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """A full disk makes no thousand rows; runs lost between others are no reason to stop."""

    def full(order: Order, carried: CarriedFiles) -> Finished:
        if order.draw.number < 16 and order.draw.number % 4 == 0:
            return Finished({"run": order.draw.number, "result": MET})
        return Finished(unfinished_row(order.draw, LOST, "No space left on device"))

    taken = taken_until_the_end(full, 1000, monkeypatch)
    assert 16 <= len(taken) < 30
    assert [one.row["result"] for one in taken[-5:]] == [LOST] * 5


def test_a_worker_without_room_for_the_configuration_loses_its_run(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(order: Order, carried: CarriedFiles) -> Finished:
        raise OSError(28, "No space left on device")

    taken = taken_until_the_end(full, 30, monkeypatch)
    assert [one.row["result"] for one in taken] == [LOST] * 5
