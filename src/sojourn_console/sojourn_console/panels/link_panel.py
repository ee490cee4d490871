"""The link to Earth: whether it is open and until when, how long light takes, what is on its way."""

from collections.abc import Mapping
from typing import ClassVar

from sojourn_console.feed import FeedMessage
from sojourn_console.link_ahead import LinkAhead
from sojourn_console.model import RunScene
from sojourn_console.panels.panel import QuietPanel, Workbench, put, table_html
from sojourn_contract.codecs import decode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heartbeat import status_values
from sojourn_contract.link_topics import LINK_STATUS
from sojourn_contract.stamps import seconds
from sojourn_contract.values import DiagnosticArray
from sojourn_operator.link.commands import OVER, QUEUED, RECEIVED, SENT

SHOWN = 8
"""Last commands that are told."""
NONE = [("link", "none: the operator stands beside the machine"), ("light takes", "0 s"), ("on its way", "nothing")]


class LinkPanel(QuietPanel):
    """What the Earth knows of the link of a run; that there is none where it has none."""

    title: ClassVar[str] = "Link"

    def __init__(self, bench: Workbench) -> None:
        scenario = bench.world.scenario
        self._ahead = None if scenario.link is None else LinkAhead(scenario.link, scenario.link_sky)
        self._status: DiagnosticArray | None = None
        self._words = bench.server.gui.add_html(table_html(NONE) if self._ahead is None else "")

    def topics(self) -> frozenset[str]:
        return frozenset() if self._ahead is None else frozenset({LINK_STATUS.name})

    def hear(self, heard: list[FeedMessage]) -> None:
        for one in heard:
            if one.row.name == LINK_STATUS.name:
                try:
                    self._status = decode(one.row, one.data)
                except RefusedMessageError:
                    continue  # the scene counts it

    def show(self, scene: RunScene) -> None:
        if self._ahead is None:
            return
        x, y = (0.0, 0.0) if scene.pose is None else scene.pose.position[:2].tolist()
        self._ahead.look(scene.stamp, x, y)
        put(self._words, table_html(link_rows(self._status, scene.stamp, self._ahead)))

    def clear(self) -> None:
        self._status = None
        if self._ahead is not None:
            self._ahead.forget()


def link_rows(status: DiagnosticArray | None, now: int, ahead: LinkAhead) -> list[tuple[str, str]]:
    """Names and values. status: newest /link/status, None before the first. now: simulation time [ns]."""
    light = ahead.light_time_s(now)
    link = {} if status is None else status_values(status)
    rows = [("link", _window(ahead, now)), ("light takes", f"{light:.2f} s, there and back {2.0 * light:.2f} s")]
    if not link:
        return [*rows, ("", "the operator's role has not told of it yet")]
    for way, words in (("up", "to the machine"), ("down", "to the Earth")):
        count, bits = int(link[f"{way}_waiting"]), float(link[f"{way}_waiting_bits"])
        rows.append((words, f"{count} waiting, {bits / 8e3:.2f} kB" if count else "nothing waits"))
    commands = [] if status is None else status.status[1:]
    for one in list(reversed(commands))[:SHOWN]:
        rows.append((one.name, command_words(dict(one.values), now, light)))
    return rows if commands else [*rows, ("commands", "none yet")]


def command_words(values: Mapping[str, str], now: int, light: float) -> str:
    """Where a command is, as far as the Earth knows. now: simulation time [ns]. light: its time [s]."""
    state, topic = values.get("state", "?"), values.get("topic", "?")
    if state in OVER:
        told = ": ".join(word for word in (values.get("outcome", ""), values.get("reason", "")) if word)
        return f"{topic}, {state}" + (f" ({told})" if told else "")
    if state == SENT and values.get("sent_s"):
        left = float(values["sent_s"]) + light - seconds(now)
        if left > 0.0:
            return f"{topic}, on its way, there in {left:.1f} s"
        answer = left + light
        heard = f"word of it in {answer:.1f} s at the soonest" if answer > 0.0 else "word of it is due"
        return f"{topic}, should be there, {heard}"
    if state == QUEUED:
        return f"{topic}, waits on Earth since {values.get('queued_s', '?')} s"
    return f"{topic}, received at {values.get('received_s', '?')} s" if state == RECEIVED else f"{topic}, {state}"


def _window(ahead: LinkAhead, now: int) -> str:
    """Whether it is open, and when that changes."""
    words = "open" if ahead.is_open else "closed"
    change = ahead.changes_at
    if change is None:
        return f"{words}; when that changes is being looked for" if not ahead.is_over else f"{words} for good"
    verb = "closes" if ahead.is_open else "opens"
    return f"{words}, {verb} in {_span(seconds(change - now))}, at {seconds(change):.0f} s"


def _span(time: float) -> str:
    """A length of time in words."""
    minutes, rest = divmod(max(time, 0.0), 60.0)
    hours, minutes = divmod(minutes, 60.0)
    if hours:
        return f"{hours:.0f} h {minutes:.0f} min"
    return f"{minutes:.0f} min {rest:.0f} s" if minutes else f"{rest:.0f} s"
