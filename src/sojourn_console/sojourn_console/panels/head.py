"""What is always in sight: how the machine is, and what stops it."""

import html
from collections.abc import Mapping
from typing import ClassVar

import viser

from sojourn_config.command_errors import CommandError
from sojourn_console.bag_feed import BagFeed
from sojourn_console.errors import ConsoleError
from sojourn_console.model import RunScene
from sojourn_console.panels.alarms import band_html
from sojourn_console.panels.panel import QuietPanel, Workbench, put
from sojourn_console.panels.sight import BUTTONS_HTML, PAGE_HTML
from sojourn_console.uplink import Uplink
from sojourn_contract.heartbeat import RUNNING
from sojourn_operator.foresight_words import number_words

COLORS = {"moving": "#409cff", "reached": "#30d158", "idle": "#8e8e93", "refused": "#ff453a", "failed": "#ff453a"}
OTHER = "#ff9f0a"
QUIET = "font-size:.8em;opacity:.75"
LOUD = f"font-size:.9em;font-weight:bold;color:{OTHER}"


class HeadPanel(QuietPanel):
    """Time, states, charge; stop, pause, resume, cancel; who has the control."""

    title: ClassVar[str] = ""

    def __init__(self, bench: Workbench) -> None:
        self._bench = bench
        gui = bench.server.gui
        gui.add_html(PAGE_HTML)
        self._band = gui.add_html("")
        self._words = gui.add_html("")
        self._note = gui.add_html("")
        self._take = gui.add_button("Take control", icon=viser.Icon.KEY, visible=False)
        self._take.on_click(lambda event: bench.commanding(event.client, lambda: self._taken(event.client), False))
        if not isinstance(bench.feed, BagFeed):
            self._add_buttons()

    def show(self, scene: RunScene) -> None:
        bench = self._bench
        with bench.failures.of("the state of the run"):  # by itself: what fails is told below
            put(self._band, band_html(bench.alarms.open))
            put(self._words, head_html(scene, bench.world.scenario.name, bench.world.scenario.config.machine))
        self._take.visible = bench.control.holder is not None and len(bench.server.get_clients()) > 1
        put(self._note, self._notes_html(scene))

    def _add_buttons(self) -> None:
        bench, gui = self._bench, self._bench.server.gui
        gui.add_html(BUTTONS_HTML)
        stop = gui.add_button("STOP", color="red", icon=viser.Icon.HAND_STOP)
        row = gui.add_button_group("Goal", ("Pause", "Resume", "Cancel"))
        stop.on_click(lambda event: bench.commanding(event.client, self._stop, needs_control=False))
        row.on_click(lambda event: self._pressed(event.client, row.value))

    def _notes_html(self, scene: RunScene) -> str:
        """What is to be known of the page itself, the loud first."""
        bench = self._bench
        silence, other = bench.feed.silence(), bench.another_run
        loud = [words for words in (silence, other.refusal, *bench.failures.words()) if words]
        has_control = f"page {bench.control.holder} has the control" if self._take.visible else ""
        why = "" if silence or other.refusal else bench.feed.refusal() or has_control
        quiet = [words for words in (other.note, why, unread(scene)) if words]
        return "".join(
            f'<div style="{style};margin:0 14px 4px">{html.escape(words)}</div>'
            for style, each in ((LOUD, loud), (QUIET, quiet))
            for words in each
        )

    def _stop(self) -> str:
        """The sequence is stopped first: whatever becomes of the stop, no step of it may begin or go on."""
        bench = self._bench
        held = ""
        if bench.sequences.is_under_way:
            held = f"; {bench.sequences.stop()}"
        try:
            told = bench.desk.stop()
        except CommandError as error:
            raise ConsoleError(f"not stopped: {error}{held}") from error
        words = f"stop sent to {' and '.join(told)}"
        if "arm" not in told and bench.world.scenario.arm is not None:
            words += ", not to the arm: nobody acts on it"
        if "drive" not in told:
            words += ", not to the drive: nobody acts on it"
        return f"{words}{held}" if held else _aside(words, bench.uplink)

    def _cancel(self) -> str:
        bench, uplink = self._bench, self._bench.uplink
        waiting = uplink.waiting() if uplink.is_used else ()
        back = uplink.take_back(waiting) if waiting else ""
        moves = uplink.moves() if uplink.is_used else frozenset()
        if back and not moves:
            bench.desk.driven = None
            return back
        said = bench.sequences.interrupt()  # or it would set the machine going again
        ended = bench.desk.cancel(bench.scene, moves)
        return _aside("; ".join(words for words in (back, said, ended) if words), uplink)

    def _taken(self, client: viser.ClientHandle | None) -> str:
        if client is not None:
            self._bench.control = self._bench.control.taken_by(client.client_id)
        return "the control is here now"

    def _pressed(self, client: viser.ClientHandle | None, what: str) -> None:
        self._bench.commanding(client, lambda: self._act(what), brings_rest=what != "Resume")

    def _act(self, what: str) -> str:
        desk, scene = self._bench.desk, self._bench.scene
        if what == "Pause":
            return _aside(desk.pause(scene), self._bench.uplink)
        return _aside(desk.resume(scene), self._bench.uplink) if what == "Resume" else self._cancel()


def head_html(scene: RunScene, name: str, machine: str) -> str:
    """The state of a run in some lines."""
    drive, arm, power = (scene.status(topic) for topic in ("/drive/status", "/arm/status", "/power/status"))
    late = [f"{role} {state}" for role, state in scene.states.items() if state != RUNNING]
    silent = scene.silent
    lines = [
        f'<div style="display:flex;justify-content:space-between"><b>{html.escape(machine)}</b>'
        f'<span style="font-variant-numeric:tabular-nums">{scene.stamp * 1e-9:.1f} s</span></div>',
        f'<div style="opacity:.6">{html.escape(name)}</div>',
        _line("drive", drive, _way(drive), "drive" in silent),
    ]
    if arm:
        lines.append(_line("arm", arm, arm.get("reason", ""), "arm" in silent))
    if scene.charge is not None:
        lines.append(_bar(scene.charge, power.get("mode", power.get("state", ""))))
    elif scene.battery_heard:
        lines.append("<div>charge not known</div>")
    lines += [f'<div style="{LOUD}">{html.escape(role)} silent for {gone:.0f} s</div>' for role, gone in silent.items()]
    if late:
        lines.append(f'<div style="color:{OTHER}">{html.escape(", ".join(late))}</div>')
    return f'<div style="font-size:.86em;line-height:1.5;margin:4px 14px 2px">{"".join(lines)}</div>'


def unread(scene: RunScene) -> str:
    """Of which topics messages have come that could not be read, and how many, in words."""
    counts = [f"{count} of {topic}" for topic, count in sorted(scene.refused.items())]
    return f"messages that could not be read: {', '.join(counts)}" if counts else ""


def _aside(told: str, uplink: Uplink) -> str:
    """What was done, and how it goes there."""
    aside = uplink.aside()
    return f"{told}, {aside}" if aside else told


def _way(drive: Mapping[str, str]) -> str:
    if drive.get("reason"):
        return drive["reason"]
    if drive.get("state") == "moving" and "distance_to_go" in drive:
        return f"{number_words(drive['distance_to_go'], '{:.2f} m')} to go"
    return ""


def _line(role: str, status: Mapping[str, str], words: str, is_past: bool) -> str:
    """is_past: its role is silent, and what it said is of before."""
    state = status.get("state", "not heard")
    color = COLORS["idle"] if is_past else COLORS.get(state, OTHER if status else COLORS["idle"])
    words = f"before it fell silent{': ' if words else ''}{words}" if is_past else words
    more = f' <span style="opacity:.75">{html.escape(words)}</span>' if words else ""
    return (
        f'<div>{role} <span style="background:{color};color:#fff;border-radius:4px;padding:0 6px">'
        f"{html.escape(state)}</span>{more}</div>"
    )


def _bar(charge: float, words: str) -> str:
    color = "#30d158" if charge > 0.4 else OTHER if charge > 0.2 else "#ff453a"
    part = 100.0 * min(max(charge, 0.0), 1.0)
    return (
        f'<div style="display:flex;align-items:center;gap:8px">charge<div style="flex:1;height:9px;background:#8884;'
        f'border-radius:5px"><div style="width:{part:.1f}%;height:100%;background:{color};'
        f'border-radius:5px"></div></div><span style="font-variant-numeric:tabular-nums">{100.0 * charge:.1f} %</span>'
        f'<span style="opacity:.6">{html.escape(words)}</span></div>'
    )
