"""What every panel is, and what all of them share."""

import html
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import viser

from sojourn_config.command_errors import CommandError
from sojourn_console.alarm_board import AlarmBoard
from sojourn_console.another_run import AnotherRun
from sojourn_console.control import Control
from sojourn_console.desk import CommandDesk
from sojourn_console.draft import Draft
from sojourn_console.errors import ConsoleError
from sojourn_console.failures import Failures
from sojourn_console.feed import Feed, FeedMessage
from sojourn_console.model import RunScene
from sojourn_console.sequence_board import SequenceBoard
from sojourn_console.uplink import Uplink
from sojourn_console.world import World


@dataclass
class Workbench:
    """What the panels of a page work on.

    Args:
        server: of the page. world: of the run. feed: to it. desk: its commands.

        alarms: of the run. sequences: carried out from here. uplink: the way of what is said, where a link stands
            between Earth and machine.

    Attributes:
        lock: held while anything here changes; viser calls from threads of its own.
        scene: newest. control: who may command. draft: the goal that is on the table.
        failures: of parts of the page. another_run: that has begun, and may not be of this world.
    """

    server: viser.ViserServer
    world: World
    feed: Feed
    desk: CommandDesk
    alarms: AlarmBoard
    sequences: SequenceBoard
    uplink: Uplink
    lock: threading.RLock = field(default_factory=threading.RLock)
    scene: RunScene = field(default_factory=RunScene)
    control: Control = field(default_factory=Control)
    draft: Draft = field(default_factory=Draft)
    failures: Failures = field(default_factory=Failures)
    another_run: AnotherRun = field(init=False)

    def __post_init__(self) -> None:
        self.another_run = AnotherRun(self.world)

    def checked_draft(self) -> Draft:
        """The goal that is on the table. Raises GoalError where it cannot be sent."""
        self.draft.check(self.world.ground, self.world.scenario.config.keep_out)
        return self.draft

    def commanding(
        self, client: Any, act: Callable[[], str], needs_control: bool = True, brings_rest: bool = False
    ) -> None:
        """Do what an operator asks for, and tell the page that asked how it went.

        Args:
            client: the page. act: does it. needs_control: it changes the run, which one page at a time may.
            brings_rest: whatever runs may be told so, also a run of another scenario than the one that is shown.
        """
        with self.lock:
            try:
                if needs_control and not brings_rest and self.another_run.refusal:
                    raise ConsoleError(self.another_run.refusal)
                if client is not None and needs_control:
                    self.control = self.control.claimed_by(client.client_id)
                told, title, color = act(), "Done", "green"
            except CommandError as error:
                told, title, color = str(error), "Not done", "red"
        if client is not None and told:
            client.add_notification(title, told, color=color, auto_close_seconds=6.0)


class Panel(Protocol):
    """Controls in a tab of the page."""

    title: ClassVar[str]
    """Of its tab."""
    commands: ClassVar[bool]
    """Whether it is there to command, so that there is none beside a bag."""

    def __init__(self, bench: Workbench) -> None: ...

    def topics(self) -> frozenset[str]:
        """That it looks at, besides those of a scene."""
        ...

    def topics_in_full(self) -> frozenset[str]:
        """Of which it needs every message."""
        ...

    def hear(self, heard: list[FeedMessage]) -> None:
        """Messages that have come."""
        ...

    def show(self, scene: RunScene) -> None:
        """Some times a second, with the newest scene."""
        ...

    def clear(self) -> None:
        """Forget what was: time has jumped."""
        ...

    def close(self) -> None:
        """End what it has begun."""
        ...


class QuietPanel:
    """A panel that looks at nothing but the scene."""

    commands: ClassVar[bool] = False

    def topics(self) -> frozenset[str]:
        return frozenset()

    def topics_in_full(self) -> frozenset[str]:
        return frozenset()

    def hear(self, heard: list[FeedMessage]) -> None:
        return

    def show(self, scene: RunScene) -> None:
        return

    def clear(self) -> None:
        return

    def close(self) -> None:
        return


def table_html(rows: list[tuple[str, str]]) -> str:
    """Names and values, one pair a line."""
    lines = "".join(
        f'<tr><td style="opacity:.65;padding:1px 10px 1px 0;white-space:nowrap;vertical-align:top">{html.escape(name)}'
        f'</td><td style="font-variant-numeric:tabular-nums">{html.escape(value)}</td></tr>'
        for name, value in rows
    )
    return f'<table style="font-size:.82em;margin:2px 14px;border-collapse:collapse">{lines}</table>'


def put(handle: Any, words: str) -> None:
    """Content of an element of the page, sent where it is another one."""
    if handle.content != words:
        handle.content = words
