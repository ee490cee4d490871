"""The workers of a campaign: processes on this machine, or those of a Dask scheduler anywhere.

On this machine scheduler and workers listen on 127.0.0.1 alone, and speak with who has the certificate that is made for
this campaign and never written down: on a machine with several users nobody else can hand them work.
"""

import logging
import os
import sys
from collections.abc import Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import dask
from distributed import Client, LocalCluster, Security
from distributed.utils import silence_logging_cmgr

from sojourn_config.command_errors import UsageError
from sojourn_machine import arithmetic
from sojourn_studies.campaign.alike import Versions, check_alike
from sojourn_studies.campaign.errors import SchedulerGoneError, WorkerError

UNREACHED = (CancelledError, AttributeError, OSError)
"""Errors of a client that has lost its scheduler, where they are not those of a run: it may ask None for one."""
CONNECT_S = 20.0
"""Wall time within which a scheduler must answer [s]."""
_QUIET = {
    "distributed.nanny.pre-spawn-environ": arithmetic.pins(),
    "distributed.logging": {"distributed": "error", "bokeh": "critical", "tornado": "critical"},
    "distributed.admin.large-graph-warning-threshold": "1GB",
    "distributed.worker.profile.enabled": False,
    "distributed.worker.memory.monitor-interval": "1s",
    "distributed.scheduler.no-workers-timeout": "2 minutes",
    "distributed.scheduler.work-stealing": False,
    "distributed.scheduler.active-memory-manager.start": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.tick.limit": "1h",
    "distributed.admin.system-monitor.interval": "5s",
    "distributed.admin.system-monitor.gil.enabled": False,
}
"""A task of ours keeps its worker's process busy for long. Dask's look-outs are for short ones: on their defaults they
take 6 % of a processor and warn of each run; so they take 1 %. They warn of files of 10 MB, too: an elevation model
has as many. And it would wait without end where no worker is left that can be started again."""


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0))


@contextmanager
def workers_here(count: int, work: Path) -> Iterator[Client]:
    """Workers on this machine, one thread each.

    Args:
        count: of processes. work: folder for what they need while they run.
    """
    with (
        dask.config.set(_QUIET),
        LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            security=Security.temporary(),
            silence_logs=logging.CRITICAL,
            local_directory=str(work),
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        yield client


@contextmanager
def workers_of(scheduler: str, versions: Versions) -> Iterator[Client]:
    """The workers of a scheduler. Its certificates are Dask's: `distributed.comm.tls` in its configuration.

    Raises:
        UsageError: it cannot be reached, has no worker, or one that does not compute as we do.
    """
    with dask.config.set(_QUIET), silence_logging_cmgr(logging.CRITICAL):  # what is lost has its word from us
        try:
            client = Client(scheduler, timeout=CONNECT_S, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            why = str(error).strip() or type(error).__name__
            raise UsageError(f"--scheduler {scheduler}: it cannot be reached: {why}") from error
        with client:
            _check_workers(client, scheduler, versions)
            yield client


def threads(client: Client) -> int:
    """How many runs the workers take at once. Raises SchedulerGoneError."""
    try:
        found = client.nthreads()
    except UNREACHED:
        raise SchedulerGoneError from None
    return max(sum(found.values()), 1)


def join(scheduler: str, count: int) -> None:
    """Become workers of a scheduler, started as a campaign needs them; returns only where that fails.

    Raises:
        UsageError: Dask cannot be started.
    """
    environment: Mapping[str, str] = {**os.environ, **arithmetic.pins()}
    command = [sys.executable, "-m", "distributed.cli.dask_worker", scheduler]
    options = ["--nthreads", "1", "--nworkers", str(count), "--no-dashboard"]
    try:
        os.execve(sys.executable, [*command, *options], dict(environment))
    except OSError as error:
        raise UsageError(f"--join {scheduler}: {error.strerror}") from error


def _check_workers(client: Client, scheduler: str, versions: Versions) -> None:
    try:
        found: dict[str, Any] = client.run(_unlike, versions)
    except ImportError as error:
        raise UsageError(f"--scheduler {scheduler}: a worker has no Sojourn installed ({error})") from error
    if not found:
        raise UsageError(
            f"--scheduler {scheduler}: it has no workers: start some with scripts/campaign --join {scheduler}"
        )
    for worker, reason in found.items():
        if reason:
            raise UsageError(f"--scheduler {scheduler}: worker {worker}: {reason}")


def _unlike(versions: Versions) -> str:
    """On a worker: why it cannot take part, or nothing."""
    try:
        check_alike(versions)
    except WorkerError as error:
        return error.reason
    return ""
