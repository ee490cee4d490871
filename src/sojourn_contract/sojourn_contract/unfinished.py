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
from functools import cache
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
        self._whole: list[Whole] = []
        """It, once somebody has asked for it."""

    @property
    def is_finished(self) -> bool:
        """Whether nobody has to wait for it."""
        return self._work.done()

    def finished(self) -> Whole:
        """It, whole. Raises what making it has raised."""
        if not self._whole:
            _help_until(self._work.done)
            self._whole.append(self._change(self._work.result()))
        return self._whole[0]

    def then(self, change: Callable[[Whole], Made]) -> "Unfinished[Made]":
        """What is made of it."""
        return Unfinished(self._work, lambda _: change(self.finished()))


def begun(make: Callable[[], Whole]) -> Unfinished[Whole]:
    """What `make` returns, once the other thread has called it."""
    _finish_all_but(MOST - 1)
    work = _maker().submit(make)
    work.add_done_callback(_tell)
    with _changed:
        _under_way.append(work)
    return Unfinished(work, _itself)


def shared(calls: Sequence[Callable[[], Made]]) -> list[Made]:
    """What calls return, in their order, that share nothing: made here, and by whoever waits meanwhile.

    No result depends on how many run at a time, as none of the calls may change what another reads. Raises what the
    first of them raises that fails, once all have ended.
    """
    parts = [_Part(call) for call in calls]
    with _changed:
        _offered.extend(parts)
        _changed.notify_all()
    try:
        _help_until(lambda: all(part.is_made for part in parts), parts)
    finally:
        with _changed:  # nobody is to begin one once the others are given up
            for part in parts:
                if part in _offered:
                    _offered.remove(part)
    return [part.result() for part in parts]


def finish_all() -> None:
    """Wait until nothing is being made."""
    _finish_all_but(0)


class _Part:
    """A call that whoever has time makes, once."""

    def __init__(self, call: Callable[[], Any]) -> None:
        self._call = call
        self._result: Any = None
        self._error: Exception | None = None
        self.is_made = False

    def make(self) -> None:
        try:
            self._result = self._call()
        except Exception as error:
            self._error = error
        with _changed:
            self.is_made = True
            _changed.notify_all()

    def result(self) -> Any:
        """What the call has returned; raises what it has raised."""
        if self._error is not None:
            raise self._error
        return self._result


def _help_until(is_done: Callable[[], bool], ours: Sequence[_Part] | None = None) -> None:
    """Wait, and make parts that are offered meanwhile, of `ours` or all. One that is interrupted is offered again."""
    while not is_done():
        part = None
        try:
            with _changed:
                _changed.wait_for(lambda: is_done() or _next(ours) is not None)
                part = _next(ours)
                if part is not None:
                    _offered.remove(part)
            if part is not None:
                part.make()
        except BaseException:
            with _changed:
                if part is not None and not part.is_made and part not in _offered:
                    _offered.append(part)
                    _changed.notify_all()
            raise


def _next(ours: Sequence[_Part] | None) -> "_Part | None":
    """The first that is offered, of `ours` or all."""
    return next((part for part in _offered if ours is None or part in ours), None)


def _finish_all_but(count: int) -> None:
    """Wait for the oldest until only so many are left."""
    while (oldest := _oldest_beyond(count)) is not None:
        _help_until(oldest.done)


def _oldest_beyond(count: int) -> Future[Any] | None:
    with _changed:
        return _under_way.popleft() if len(_under_way) > count else None


def _tell(_: Future[Any]) -> None:
    """Wake those who wait for a work that is done."""
    with _changed:
        _changed.notify_all()


def _itself(value: Whole) -> Whole:
    return value


_changed = Condition()
"""Of what is offered, and of what is done; its lock is that of the lists."""
_under_way = deque[Future[Any]]()
_offered = deque[_Part]()
"""Parts that nobody makes yet."""


@cache
def _maker() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(1, thread_name_prefix="unfinished")


def _before_fork() -> None:
    """A copy of this process has none of its threads: what is under way is finished, and none of them has the lock."""
    finish_all()
    _changed.acquire()


def _in_copy() -> None:
    _changed.release()
    _maker.cache_clear()


os.register_at_fork(before=_before_fork, after_in_parent=_changed.release, after_in_child=_in_copy)
