"""Calls that share nothing, side by side: compiled ones, which let go of Python's lock while they run (`nogil`)."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache
from typing import TypeVar

Result = TypeVar("Result")


def at_once(calls: Sequence[Callable[[], Result]]) -> list[Result]:
    """What calls return, in their order: the first is made in this thread, the others each in one of its own.

    No result depends on how many run at a time, as none of the calls may change what another reads. Raises what the
    first of them raises that fails, once all have ended.
    """
    first, *others = calls
    waiting = [_threads().submit(call) for call in others]
    try:
        return [first(), *(one.result() for one in waiting)]
    finally:
        wait(waiting)


@cache
def _threads() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(thread_name_prefix="at_once")
