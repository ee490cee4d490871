"""Alarms and the one log: what is the matter, what has happened, and that somebody has seen it."""

import html
import json
from typing import Any, ClassVar

import viser

from sojourn_console.alarm_board import AlarmBoard
from sojourn_console.alarm_sound import sound_html
from sojourn_console.feed import FeedMessage
from sojourn_console.model import RunScene
from sojourn_console.panels.choice import ALL, Choice
from sojourn_console.panels.panel import QuietPanel, Workbench, put, table_html
from sojourn_console.panels.sight import BAND_MARK, ONE_LINE
from sojourn_contract.stamps import seconds
from sojourn_operator.alarms.engine import Alarm, shown_value
from sojourn_operator.alarms.params import Severity

SEVERITY_COLORS = {Severity.WATCH: "#64a0d2", Severity.WARNING: "#ff9f0a", Severity.CRITICAL: "#ff453a"}
KINDS = (ALL, "alarm", "goal", "node", "contract", "operator")
LINES = 60
"""Of the log that are shown, the latest first."""
SOUNDING = 15
"""Shows for which a sound stays on the page: a page that opens later is not to play it."""


class AlarmsPanel(QuietPanel):
    """A list, what acknowledges, the log."""

    title: ClassVar[str] = "Alarms"

    def __init__(self, bench: Workbench) -> None:
        self._bench, self._board = bench, bench.alarms
        gui = bench.server.gui
        self._list = gui.add_html(alarms_html(self._board))
        self._which = Choice(gui, "Alarm")
        self._seen = gui.add_button("Acknowledge", icon=viser.Icon.CHECK)
        self._sounds = gui.add_checkbox("Sound", True)
        self._sound = gui.add_html("")
        with gui.add_folder("Log"):
            self._kind: Any = gui.add_dropdown("Of", KINDS)
            self._save = gui.add_button("Save as JSON", icon=viser.Icon.DOWNLOAD)
            self._log = gui.add_html("")
        self._risen, self._played, self._silent_in = Severity.NONE, 0, 0
        self._seen.on_click(lambda event: bench.commanding(event.client, self._acknowledged, needs_control=False))
        self._save.on_click(lambda event: bench.commanding(event.client, lambda: self._write(event.client), False))

    def topics_in_full(self) -> frozenset[str]:
        return self._board.topics

    def hear(self, heard: list[FeedMessage]) -> None:
        self._risen = max(self._risen, self._board.hear(heard))

    def show(self, scene: RunScene) -> None:
        put(self._list, alarms_html(self._board))
        put(self._log, log_html(self._board, self._kind.value))
        self._which.offer([alarm.key for alarm in self._board.open])
        self._silent_in = max(self._silent_in - 1, 0)
        if self._risen and self._sounds.value:
            self._played, self._silent_in = self._played + 1, SOUNDING
            put(self._sound, sound_html(self._risen, self._played))
        elif not self._silent_in:
            put(self._sound, "")
        self._risen = Severity.NONE

    def clear(self) -> None:
        self._board.clear()
        self._risen = Severity.NONE

    def _acknowledged(self) -> str:
        return self._board.acknowledge(self._which.chosen)

    def _write(self, client: Any) -> str:
        data = [event.as_data() for event in self._board.log]
        client.send_file_download("log.json", (json.dumps(data, indent=1, ensure_ascii=False) + "\n").encode())
        return f"{len(data)} entries"


def band_html(open_alarms: list[Alarm]) -> str:
    """What is always in sight while an alarm has not been acknowledged: it blinks where the worst is critical."""
    if not open_alarms:
        return ""
    worst = max(alarm.worst for alarm in open_alarms)
    more = f" and {len(open_alarms) - 1} more" if len(open_alarms) > 1 else ""
    first = next(alarm for alarm in open_alarms if alarm.worst == worst)
    style = f"background:{SEVERITY_COLORS[worst]};color:#fff;border-radius:6px;padding:0 10px;margin:0 14px;{ONE_LINE}"
    blinks = "animation:alarm 1s steps(2) infinite" if worst is Severity.CRITICAL else ""
    return (
        "<style>@keyframes alarm{50%{filter:brightness(.55)}}</style>"
        f'<div class="{BAND_MARK}" style="{style};font-size:.84em;{blinks}"><b>{worst.word.upper()}</b> '
        f"{html.escape(first.key + more)}</div>"
    )


def alarms_html(board: AlarmBoard) -> str:
    """A block for each alarm that is shown."""
    blocks = [_alarm_html(alarm, board.limits(alarm).help) for alarm in board.shown] or [
        '<div style="opacity:.7">no alarm</div>'
    ]
    if board.behind:
        blocks.append(f'<div style="opacity:.7">{board.behind} messages are still to be judged …</div>')
    return f'<div style="font-size:.82em;margin:2px 14px;line-height:1.45">{"".join(blocks)}</div>'


def log_html(board: AlarmBoard, kind: str) -> str:
    """The latest entries, the newest first."""
    found = [event for event in reversed(board.log) if kind in (ALL, event.kind)][:LINES]
    return table_html([(f"{seconds(event.stamp):.1f} s", f"{event.who}: {event.text}") for event in found])


def _alarm_html(alarm: Alarm, words: str) -> str:
    faded = "opacity:.6" if alarm.acknowledged else ""
    return (
        f'<div style="margin-bottom:5px;{faded}"><span style="background:{SEVERITY_COLORS[alarm.worst]};color:#fff;'
        f'border-radius:4px;padding:0 6px">{alarm.worst.word}</span> <b>{html.escape(alarm.key)}</b> '
        f"{html.escape(shown_value(alarm.value))}<br>"
        f'<span style="opacity:.75">{html.escape(alarm.word)}, since {seconds(alarm.since):.1f} s'
        f"{html.escape(f'. {words}' if words else '')}</span></div>"
    )
