"""The runs of a campaign over its workers: a window of them is under way, each comes back and the next is sent.

A worker that dies takes along every run that was on it, and Dask sends them out again; which of them it died of is not
known. So a run whose workers died too often is held back and, when the rest is done, done once more by itself: what was
only beside a deadly run has its row, and the deadly one is lost.
"""

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import Any, NamedTuple, NoReturn
from uuid import uuid4

from distributed import Client, Future, KilledWorker, as_completed
from distributed.scheduler import NoWorkerError

from sojourn_studies.campaign.carried import CarriedFiles
from sojourn_studies.campaign.cluster import UNREACHED, threads
from sojourn_studies.campaign.errors import GOES_ON, CampaignError, SchedulerGoneError
from sojourn_studies.campaign.row import LOST, unfinished_row
from sojourn_studies.campaign.task import Finished, Order, do

AHEAD = 2
"""Runs under way for each that a worker can take, so that none waits for the next; few, as kept bags wait in memory."""
LOST_IN_A_ROW = 5
"""Runs lost one after the other, for each that the workers take at once, after which the campaign stops: a disk that is
full for one run is full for the next, and a thousand rows that say so are no use."""


class _Ended(NamedTuple):
    """A run that came back, and whether it did so because its workers died."""

    order: Order
    finished: Finished
    killed: bool


class _Losses:
    """Counts the runs that were lost since the last that was not. `most`: after which it is enough."""

    def __init__(self, most: int) -> None:
        self._most, self._count = most, 0

    def are_too_many(self, finished: Finished) -> bool:
        """Whether they are with this run."""
        self._count = self._count + 1 if finished.row["result"] == LOST else 0
        return self._count >= self._most


def carry_out(client: Client, orders: Iterable[Order], carried: CarriedFiles, take: Callable[[Finished], None]) -> None:
    """Do all runs; each is taken once, as it ends, in any order.

    Raises:
        CampaignError: the scheduler or all its workers are gone, or run after run is lost.
    """
    token = uuid4().hex  # of this campaign's keys: a scheduler has what two clients call alike done once, for both
    # not scattered: what is scattered is gone with the last worker that has it, what is computed is computed anew
    here = client.submit(_as_it_is, carried, key=f"carried-{token}", pure=False)
    most = LOST_IN_A_ROW * threads(client)
    held: list[_Ended] = []
    losses = _Losses(most)
    for ended in _ended(client, orders, here, lambda: AHEAD * threads(client), f"run-{token}"):
        if ended.killed:
            held.append(ended)
        else:
            take(ended.finished)
        if losses.are_too_many(ended.finished):
            _stop(ended, held, take, most)
    losses = _Losses(most)
    for ended in _ended(client, [one.order for one in held], here, lambda: 1, f"run-alone-{token}"):
        held.pop(0)
        take(ended.finished)
        if losses.are_too_many(ended.finished):
            _stop(ended, held, take, most)


def _stop(last: _Ended, held: Iterable[_Ended], take: Callable[[Finished], None], count: int) -> NoReturn:
    """End the campaign. Raises CampaignError."""
    for one in held:  # with their rows they come after the others the next time
        take(one.finished)
    raise CampaignError(
        f"{count} runs one after the other were lost, the last one because {last.finished.row['reason']}; {GOES_ON}"
    )


def _ended(
    client: Client, orders: Iterable[Order], here: Future, most: Callable[[], int], name: str
) -> Iterator[_Ended]:
    """Runs as they end.

    Args:
        here: the files that they need, on the workers. most: how many may be under way now. name: of the
            tasks, that no others on the scheduler have.
    """
    rest = iter(orders)
    by_key: dict[Any, Order] = {}

    def sent() -> Iterator[Future]:
        for order in islice(rest, max(most() - len(by_key), 0)):  # fewer may go than are: a worker has died
            future = client.submit(do, order, here, key=f"{name}-{order.draw.number}", pure=False)
            by_key[future.key] = order
            yield future

    under_way = as_completed(sent(), loop=client.loop)
    for future in under_way:
        yield _outcome(future, by_key.pop(future.key))
        future.release()
        for following in sent():
            under_way.add(following)


def _outcome(future: Future, order: Order) -> _Ended:
    """What a run came to, by fetching it: where its worker dies before that Dask does it anew, which is waited
    for. Its status alone would not tell of that.
    """
    try:
        return _Ended(order, future.result(), killed=False)
    except NoWorkerError as error:
        raise CampaignError(f"for {error.timeout:.0f} s there was no worker; {GOES_ON}") from None
    except KilledWorker as error:
        last = error.last_worker.address
        reason = f"each of the {error.allowed_failures + 1} workers that had it died, the last of them {last}"
        return _Ended(order, _lost(order, reason), killed=True)
    except Exception as error:
        if future.status != "error" and isinstance(error, UNREACHED):
            raise SchedulerGoneError from None
        return _Ended(order, _lost(order, " ".join(str(error).split()) or type(error).__name__), killed=False)


def _lost(order: Order, reason: str) -> Finished:
    return Finished(unfinished_row(order.draw, LOST, reason))


def _as_it_is(value: CarriedFiles) -> CarriedFiles:
    return value
