"""What a person sees of a run: a table that is kept up to date on a terminal, plain lines elsewhere."""

import sys
import time
from collections.abc import Sequence
from types import TracebackType
from typing import Self

from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from sojourn_bringup.health import DEAD, RESTARTING, SILENT, Health, Progress
from sojourn_config.shown import shown
from sojourn_contract.heartbeat import READY, RUNNING, STALLED
from sojourn_contract.stamps import seconds

_COLOURS = {READY: "green", RUNNING: "green", STALLED: "red", SILENT: "red", DEAD: "red", RESTARTING: "yellow"}
PIPE_WIDTH = 160
"""Columns where the output is no terminal, so that no line is broken for a width that nobody has."""
_REDRAW_S = 0.25
_LINE_EVERY_S = 10.0


def wide_console() -> Console:
    """Standard output: as wide as the terminal, and plain and wide in a pipe."""
    found = Console(highlight=False)
    return found if found.is_terminal else Console(highlight=False, width=PIPE_WIDTH)


class Screen:
    """Base: says lines, and shows nothing else. A context manager."""

    def __init__(self, console: Console | None = None) -> None:
        self.console = console or Console(highlight=False, soft_wrap=True)

    def say(self, text: str) -> None:
        """One line that stays."""
        self.console.print(Text(shown(text)))

    def show(self, nodes: Sequence[Health], progress: Progress) -> None:
        """Called some times a second."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        pass


class TableScreen(Screen):
    """A table of the nodes' health."""

    def __init__(self, console: Console | None = None) -> None:
        super().__init__(console)
        self._live = Live(console=self.console, auto_refresh=False)
        self._drawn_at = 0.0

    def show(self, nodes: Sequence[Health], progress: Progress) -> None:
        """Draw the table again, four times a second at most."""
        now = time.monotonic()
        if now - self._drawn_at >= _REDRAW_S:
            self._drawn_at = now
            self._live.update(Group(health_table(nodes), progress_line(progress)), refresh=True)

    def __enter__(self) -> Self:
        self._live.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._live.__exit__(kind, error, trace)


class PlainScreen(Screen):
    """A line for each change of a node's state, and one every ten seconds for the progress."""

    def __init__(self, console: Console | None = None) -> None:
        super().__init__(console)
        self._states: dict[str, str] = {}
        self._last_line = time.monotonic()

    def show(self, nodes: Sequence[Health], progress: Progress) -> None:
        """Say what has changed."""
        for node in nodes:
            if self._states.get(node.role) != node.state:
                self._states[node.role] = node.state
                note = f" ({node.detail})" if node.detail and node.detail != node.state else ""
                process = f" (process {node.pid})" if node.pid else ""
                self.say(f"{node.role}{process}: {node.state}{note}")
        if time.monotonic() - self._last_line >= _LINE_EVERY_S:
            self._last_line = time.monotonic()
            self.say(progress_line(progress).plain)


def health_table(nodes: Sequence[Health]) -> Table:
    """Table of the nodes' health."""
    table = Table(title=None)
    for name, justify in (
        ("node", "left"),
        ("process", "right"),
        ("state", "left"),
        ("last heartbeat", "right"),
        ("refused", "right"),
        ("restarts", "right"),
        ("memory", "right"),
        ("note", "left"),
    ):
        table.add_column(name, justify=justify, overflow="fold")  # type: ignore[arg-type]
    for node in nodes:
        table.add_row(
            node.role,
            str(node.pid) if node.pid else "",
            Text(shown(node.state), style=_COLOURS.get(node.state, "")),
            f"{seconds(node.stamp):.0f} s" if node.stamp else "",
            str(node.refused) if node.refused else "",
            str(node.restarts) if node.restarts else "",
            f"{node.memory_mb:.0f} MB" if node.memory_mb else "",
            Text(shown(node.note)),
        )
    return table


def progress_line(progress: Progress) -> Text:
    """Where the run is, in a line."""
    parts = [f"simulation time {progress.time_s:.0f} s"]
    if progress.speed:
        parts.append(f"{progress.speed:.1f} times real time")
    if progress.step:
        parts.append(progress.step)
    if progress.to_go_m is not None:
        parts.append(f"{progress.to_go_m:.2f} m to go")
    return Text(shown(", ".join(parts)))


def default_screen() -> Screen:
    """A table where somebody looks at it, lines where they are kept."""
    return TableScreen() if sys.stdout.isatty() else PlainScreen()
