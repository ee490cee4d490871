"""What on the page fails, by itself: everything else goes on, and whoever looks is told.

A page is the process that carries out a sequence. One view that cannot draw what has come must not end it.
"""

import sys
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager

from sojourn_console.model import RunScene
from sojourn_console.views.view import SceneView

STAYS_S = 10.0
"""Wall time for which a failure is told after its last time: what comes in one message is over in one look."""


class Failures:
    """Of one page.

    with failures.of("the view cameras"):
        view.show(scene)
    """

    def __init__(self) -> None:
        self._last: dict[str, tuple[float, str]] = {}
        """Of each part that has failed, when it did last, and with what error."""
        self._printed: set[tuple[str, type[BaseException]]] = set()

    @contextmanager
    def of(self, part: str) -> Iterator[None]:
        """Within it an error is that of a part of the page, and is kept; the first of each kind is printed."""
        try:
            yield
        except Exception as error:  # the page goes on without the part
            self.take(part, error)

    def take(self, part: str, error: Exception) -> None:
        """Keep an error."""
        self._last[part] = time.monotonic(), f"{type(error).__name__}: {error}"
        if (part, type(error)) not in self._printed:
            self._printed.add((part, type(error)))
            print(f"{part} fails, and the page goes on without it:", file=sys.stderr)
            traceback.print_exception(error)

    def words(self) -> list[str]:
        """What fails now, a sentence each."""
        now = time.monotonic()
        return [f"{part} fails: {error}" for part, (at, error) in self._last.items() if now < at + STAYS_S]


class OutlivedView:
    """A view that fails by itself: as a `SceneView` of its own.

    Args:
        view: drawn. failures: of the page.
    """

    def __init__(self, view: SceneView, failures: Failures) -> None:
        self._view, self._failures = view, failures
        self._part = f"the view {view.title or type(view).__name__}"
        self.title, self.needs, self.starts_shown = view.title, view.needs, view.starts_shown

    def show(self, scene: RunScene) -> None:
        """Draw a scene, as far as it goes."""
        with self._failures.of(self._part):
            self._view.show(scene)

    def hide(self) -> None:
        """Draw nothing."""
        with self._failures.of(self._part):
            self._view.hide()
