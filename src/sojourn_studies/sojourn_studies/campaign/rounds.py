"""The runs of a campaign over its workers: a window of them is under way, each comes back and the next is sent."""

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import Any

from distributed import Client, Future, as_completed

from sojourn_studies.campaign.carried import CarriedFiles
from sojourn_studies.campaign.cluster import threads
from sojourn_studies.campaign.errors import CampaignError
from sojourn_studies.campaign.row import LOST, unfinished_row
from sojourn_studies.campaign.task import Finished, Order, do

AHEAD = 2
"""Runs under way for each that a worker can take, so that none waits for the next; few, as kept bags wait in memory."""


def carry_out(client: Client, orders: Iterable[Order], carried: CarriedFiles, take: Callable[[Finished], None]) -> None:
    """Do all runs; each is taken as it ends, in any order.

    Raises:
        CampaignError: the scheduler is gone.
    """
    rest = iter(orders)
    here = client.scatter(carried, broadcast=True, hash=False)
    by_key: dict[Any, Order] = {}

    def sent(count: int) -> Iterator[Future]:
        for order in islice(rest, count):
            future = client.submit(do, order, here, key=f"run-{order.draw.number}", pure=False)
            by_key[future.key] = order
            yield future

    under_way = as_completed(sent(AHEAD * threads(client)), loop=client.loop)
    for future in under_way:
        order = by_key.pop(future.key)
        take(_outcome(future, order))
        future.release()
        for following in sent(AHEAD * threads(client) - len(by_key)):
            under_way.add(following)


def _outcome(future: Future, order: Order) -> Finished:
    if future.status == "finished":
        result: Finished = future.result()
        return result
    if future.status == "cancelled":
        raise CampaignError("the scheduler is gone; what is done is kept: the same command goes on with the rest")
    error = future.exception()
    return Finished(unfinished_row(order.draw, LOST, " ".join(str(error).split()) or type(error).__name__))
