"""Sequences of commands: a text, from a file or written here, checked, carried out, and its history."""

import html
from typing import Any, ClassVar

import viser

from sojourn_console.errors import SequenceError
from sojourn_console.feed import FeedMessage
from sojourn_console.model import RunScene
from sojourn_console.panels.panel import QuietPanel, Workbench, put, table_html
from sojourn_console.sequence_board import with_step
from sojourn_contract.stamps import seconds
from sojourn_operator.sequence.runner import Entry
from sojourn_operator.steps.step import GOOD_OUTCOMES

HINT = "steps:\n  - drive_to: {x: 2.0, y: 0.5}\n    when: /battery_state.percentage > 0.4"
LINES = 40
"""Of the history that are shown, the latest first."""
HOLD, RESUME, SKIP, ABORT = "Hold", "Resume", "Skip", "Abort"


class SequencePanel(QuietPanel):
    """A text, what is done with it, and what came of it."""

    title: ClassVar[str] = "Sequence"
    commands: ClassVar[bool] = True

    def __init__(self, bench: Workbench) -> None:
        self._bench, self._board = bench, bench.sequences
        gui = bench.server.gui
        self._upload = gui.add_upload_button("Load a file", icon=viser.Icon.UPLOAD, mime_type=".yaml,.yml")
        self._text: Any = gui.add_text("Steps", "", multiline=True, hint=HINT)
        self._add = gui.add_button("Add the goal of the tab Goals", icon=viser.Icon.PLUS)
        self._first = gui.add_button_group("Sequence", ("Check", "Run"))
        self._words = gui.add_button_group("While it runs", (HOLD, RESUME, SKIP, ABORT))
        self._found = gui.add_html("")
        self._where = gui.add_html("")
        with gui.add_folder("History"):
            self._history = gui.add_html("")
            self._export = gui.add_button_group("Save", ("Sequence", "Scenario", "History"))
        self._name = "sequence"
        self._connect()

    def topics_in_full(self) -> frozenset[str]:
        return self._board.topics

    def hear(self, heard: list[FeedMessage]) -> None:
        self._board.hear(heard)

    def show(self, scene: RunScene) -> None:
        put(self._where, _small(self._board.describe()))
        put(self._history, history_html(self._board.history))

    def clear(self) -> None:
        self._board.clear()

    def _connect(self) -> None:
        bench = self._bench
        self._upload.on_upload(lambda event: bench.commanding(event.client, self._loaded, needs_control=False))
        self._text.on_update(lambda event: self._written(event.client is not None))
        self._add.on_click(lambda event: bench.commanding(event.client, self._added, needs_control=False))
        self._first.on_click(lambda event: self._begin(event.client))
        self._words.on_click(lambda event: bench.commanding(event.client, self._told))
        self._export.on_click(lambda event: bench.commanding(event.client, lambda: self._saved(event.client), False))

    def _written(self, by_hand: bool) -> None:
        """A text that has been changed has not been checked."""
        if by_hand:
            put(self._found, "")

    def _loaded(self) -> str:
        file = self._upload.value
        try:
            self._text.value = file.content.decode("utf-8")
        except UnicodeDecodeError as error:
            raise SequenceError(f"{file.name} cannot be read as text: {error}") from error
        self._name = file.name
        return self._checked()

    def _added(self) -> str:
        draft = self._bench.checked_draft()
        self._text.value = with_step(self._text.value, draft.step())
        return self._checked()

    def _begin(self, client: Any) -> None:
        runs = self._first.value == "Run"
        self._bench.commanding(client, self._run if runs else self._checked, needs_control=runs)

    def _checked(self) -> str:
        try:
            config = self._board.check(self._text.value, self._name)
        except SequenceError as error:
            put(self._found, problems_html(str(error)))
            raise SequenceError("what is wrong stands below the text") from error
        put(self._found, _small(f"{len(config.steps)} steps, nothing wrong"))
        return f"{len(config.steps)} steps, nothing wrong"

    def _run(self) -> str:
        self._checked()
        if self._bench.uplink.is_used:
            raise SequenceError("a sequence goes round the link to Earth: switch off “Over the link” in the tab Link")
        return self._board.begin(self._text.value, self._name)

    def _told(self) -> str:
        words = {
            HOLD: self._board.hold, RESUME: self._board.resume, SKIP: self._board.skip, ABORT: self._board.abort,
        }  # fmt: skip
        return words[self._words.value]()

    def _saved(self, client: Any) -> str:
        what = self._export.value
        name, text = {
            "Sequence": ("sequence.yaml", lambda: self._text.value),
            "Scenario": ("scenario_steps.yaml", lambda: self._board.as_scenario(self._text.value)),
            "History": ("history.json", self._board.as_json),
        }[what]
        client.send_file_download(name, text().encode())
        return f"{name} saved"


def history_html(history: tuple[Entry, ...]) -> str:
    """The latest entries, the newest first: when, who, what, outcome and why."""
    rows = []
    for entry in reversed(history[-LINES:]):
        mark = "✓" if entry.outcome in GOOD_OUTCOMES else "✗"
        why = f" ({entry.reason})" if entry.reason else ""
        rows.append((f"{seconds(entry.stamp):.1f} s", f"{mark} {entry.who}: {entry.what}: {entry.outcome}{why}"))
    return table_html(rows)


def problems_html(text: str) -> str:
    """What is wrong with a sequence, a line each."""
    lines = "".join(f"<div>{html.escape(line)}</div>" for line in text.splitlines())
    return f'<div style="font-size:.82em;color:#ff453a;margin:2px 14px">{lines}</div>'


def _small(words: str) -> str:
    return f'<div style="font-size:.82em;opacity:.8;margin:2px 14px">{html.escape(words)}</div>'
