"""What is told before it is whole: another thread makes it while the run goes on.

Whoever asks for it waits until it is there, so no value depends on how long that took, or on the thread that made it:
what is made may depend only on what was known when it was begun. One thread makes one thing after another, in the order
in which they were begun; who waits for one lends a hand with the parts of it that share nothing (`shared`). More
threads than these two would take the time of the run itself, which goes on in one.

It gains time where what is made lets go of Python's lock, as compiled kernels do (`nogil`), and there is a second core.
"""

import os
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import cache, cached_property
from threading import Condition
from typing import Any, Generic, TypeVar

Whole = TypeVar("Whole")
Made = TypeVar("Made")
MOST = 4
"""Things that are unfinished at a time: who begins another waits for the oldest, or memory would grow without end."""


class Unfinished(Generic[Whole]):
    """One such thing.

    Args:
        work: in the other thread. change: what becomes of its result, in the thread of whoever asks first.
    """

    def __init__(self, work: Future[Any], change: Callable[[Any], Whole]) -> None:
        self._work, self._change = work, change

    @property
    def is_finished(self) -> bool:
        """Whether nobody has to wait for it."""
        return self._work.done()

    def finished(self) -> Whole:
        """It, whole. Raises what making it has raised."""
        return self._whole

    def then(self, change: Callable[[Whole], Made]) -> "Unfinished[Made]":
        """What is made of it."""
        return Unfinished(self._work, lambda _: change(self._whole))

    @cached_property
    def _whole(self) -> Whole:
        _help_until_done(self._work)
        return self._change(self._work.result())


def begun(make: Callable[[], Whole]) -> Unfinished[Whole]:
    """What `make` returns, once the other thread has called it."""
    while len(_under_way) >= MOST:
        _help_until_done(_under_way.popleft())
    work = _maker().submit(make)
    work.add_done_callback(_tell)
    _under_way.append(work)
    return Unfinished(work, _itself)


def shared(calls: Sequence[Callable[[], Made]]) -> list[Made]:
    """What calls return, in their order, that share nothing: made here, and by whoever waits meanwhile.

    No result depends on how many run at a time, as none of the calls may change what another reads. Raises what the
    first of them raises that fails, once all have ended.
    """
    parts = [_Part(call) for call in calls]
    with _changed:
        _offered.extend(parts[1:])
        _changed.notify_all()
    parts[0].make()
    for part in parts[1:]:
        with _changed:
            is_ours = part in _offered
            if is_ours:
                _offered.remove(part)
        if is_ours:
            part.make()
    for part in parts:
        part.made.exception()  # waits
    return [part.made.result() for part in parts]


def finish_all() -> None:
    """Wait until nothing is being made."""
    while _under_way:
        _help_until_done(_under_way.popleft())


class _Part:
    """A call that whoever has time may make, once."""

    def __init__(self, call: Callable[[], Any]) -> None:
        self._call = call
        self.made = Future[Any]()

    def make(self) -> None:
        try:
            self.made.set_result(self._call())
        except BaseException as error:
            self.made.set_exception(error)


def _help_until_done(work: Future[Any]) -> None:
    """Make parts that are offered, as long as a work is not done."""
    while not work.done():
        with _changed:
            _changed.wait_for(lambda: _offered or work.done())
            part = _offered.popleft() if _offered else None
        if part is not None:
            part.make()


def _tell(_: Future[Any]) -> None:
    """Wake those who wait for a work that is done."""
    with _changed:
        _changed.notify_all()


def _itself(value: Whole) -> Whole:
    return value


_under_way = deque[Future[Any]]()
_offered = deque[_Part]()
"""Parts that nobody makes yet."""
_changed = Condition()
"""Of what is offered, and of what is done."""


@cache
def _maker() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, thread_name_prefix="unfinished")


# A copy of this process has none of its threads: what is under way is finished before it, and its own thread is new.
os.register_at_fork(before=finish_all, after_in_child=_maker.cache_clear)
