"""One run on a worker: the whole graph in its process, its bag judged and, where it is to be kept, sent along.

A worker does one run at a time, however many threads it has: numba, the environment and the folder that a run works in
are the process's. Compiled kernels, imported packages and the configuration on its disk stay from run to run.
"""

import os
import platform
import shutil
import tempfile
import time
import traceback
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock
from typing import Any

from distributed import get_worker

from sojourn_bags.errors import BagsError, UnwritableBagError
from sojourn_bringup.process_table import ROLE_NAMES
from sojourn_config.errors import ConfigError
from sojourn_contract.errors import ContractError
from sojourn_machine.errors import MachineError
from sojourn_operator.scenario_steps import absent_roles, prepare_scenario
from sojourn_stack.errors import StackError
from sojourn_stack.run import RunSpec, run
from sojourn_studies.campaign.alike import Versions, check_alike
from sojourn_studies.campaign.carried import CarriedFiles, in_configuration, packed
from sojourn_studies.campaign.draws import Draw
from sojourn_studies.campaign.row import LOST, RAISED, UNMET, finished_row, unfinished_row

REPORT, BAG, SUMMARY = "report.html", "bag", "summary.json"
_one_at_a_time = Lock()
_KNOWN = (ConfigError, MachineError, StackError, ContractError, BagsError)
"""Errors that say all in their own words."""
_OF_THE_WORKER = (OSError, MemoryError, UnwritableBagError)
"""A disk that is full and memory that is short say nothing of the run: another worker does it, or this one later."""


@dataclass(frozen=True)
class Order:
    """What a worker is asked for.

    Args:
        draw: the run. scenario, overrides: of the run, with the files that they name where the worker has them.
        keep_failures: whether its bag is to be sent along if it fails. versions: what the worker must have.
    """

    draw: Draw
    scenario: str
    overrides: tuple[str, ...]
    keep_failures: bool
    versions: Versions


@dataclass(frozen=True)
class Finished:
    """What comes back.

    Args:
        row: of the table. cost: processor time (`cpu_s`, `run_s` of it in the run itself, with its recording) and wall
            time (`wall_s`) [s], and the worker. kept: bag and report, packed; empty where they are not kept.
    """

    row: dict[str, Any]
    cost: dict[str, Any] = field(default_factory=dict)
    kept: bytes = b""


def do(order: Order, carried: CarriedFiles) -> Finished:
    """Do a run. What goes wrong in it is told in its row.

    Raises:
        WorkerError: this worker does not compute as the others do. OSError: it has no room for the configuration.
    """
    with _one_at_a_time:
        check_alike(order.versions)
        began, spent = time.monotonic(), time.process_time()
        base = _laid_out(carried)
        with tempfile.TemporaryDirectory(prefix="run-", dir=base.parent) as folder, in_configuration(base):
            finished = _done(order, Path(folder))
        wall, cpu = time.monotonic() - began, time.process_time() - spent
        finished.cost.update(cpu_s=cpu, wall_s=wall, worker=get_worker().address)
        return finished


def _done(order: Order, folder: Path) -> Finished:
    try:
        scenario = prepare_scenario(order.scenario, order.overrides)
        absent = absent_roles(scenario.loaded)
        roles = tuple(role for role in ROLE_NAMES if role not in absent)
        before = time.process_time()
        run(RunSpec(scenario.name, roles, scenario.overrides, folder / BAG, scenario.loaded))
        spent = time.process_time() - before
        return _judged(order, folder, scenario.loaded.config.seed, spent)
    except Exception as error:  # one in our own code is the run's too: the campaign goes on
        return Finished(unfinished_row(order.draw, *_ending(error, folder)))


def _ending(error: Exception, folder: Path) -> tuple[str, str]:
    """How an error ends a run, RAISED or LOST, and why in words.

    Args:
        folder: of the run; it has another name each time, which is left out of the words.
    """
    wraps = isinstance(error, BagsError) and error.__cause__ is not None
    cause = error.__cause__ if wraps else error
    if isinstance(cause, _OF_THE_WORKER):
        words = " ".join(str(cause).split()).replace(f"{folder}{os.sep}", "") or type(cause).__name__
        return LOST, f"its worker on {platform.node()} could not go on: {words}"
    if isinstance(error, _KNOWN):
        return RAISED, str(error)
    last = traceback.extract_tb(error.__traceback__)[-1]
    return RAISED, f"{type(error).__name__}: {error} ({Path(last.filename).name}:{last.lineno})"


def _judged(order: Order, folder: Path, seed: int, spent: float) -> Finished:
    from sojourn_bags.reading import read_bag
    from sojourn_bags.summary import summarise, write_summary

    bag = read_bag(folder / BAG)
    summary = summarise(bag)
    row = finished_row(order.draw, summary, seed)
    row["kept"] = order.draw.sampled or (order.keep_failures and row["result"] == UNMET)
    if not row["kept"]:
        return Finished(row, {"run_s": spent})
    from sojourn_bags.page.page import write_page  # not above: most runs are not kept

    write_summary(summary, folder / SUMMARY)
    write_page(bag, folder / REPORT, judged=False)
    return Finished(row, {"run_s": spent}, packed(folder))


def _laid_out(carried: CarriedFiles) -> Path:
    """The folder of this worker with the configuration in it; written once, one of before is removed."""
    base = Path(get_worker().local_directory) / f"sojourn-{os.getpid()}" / carried.digest[:16]
    if not base.is_dir():
        shutil.rmtree(base.parent, ignore_errors=True)
        fresh = base.with_suffix(".fresh")
        carried.write(fresh)
        fresh.rename(base)
    return base
