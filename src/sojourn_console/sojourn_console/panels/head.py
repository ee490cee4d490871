"""What is always in sight: how the machine is, and what stops it."""

import html
from collections.abc import Mapping
from typing import ClassVar

import viser

from sojourn_console.bag_feed import BagFeed
from sojourn_console.model import RunScene
from sojourn_console.panels.alarms import band_html
from sojourn_console.panels.panel import QuietPanel, Workbench, put
from sojourn_console.panels.sight import BUTTONS_HTML, PAGE_HTML
from sojourn_console.uplink import Uplink
from sojourn_contract.heartbeat import RUNNING

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
        self._told = ("", "")
        self._note = gui.add_html("")
        self._take = gui.add_button("Take control", icon=viser.Icon.KEY, visible=False)
        self._take.on_click(lambda event: bench.commanding(event.client, lambda: self._taken(event.client), False))
        if not isinstance(bench.feed, BagFeed):
            self._add_buttons()

    def show(self, scene: RunScene) -> None:
        refusal = self._bench.feed.refusal()
        words = head_html(scene, self._bench.world.scenario.name, self._bench.world.scenario.config.machine)
        holder = self._bench.control.holder
        pages = len(self._bench.server.get_clients())
        silence = self._bench.feed.silence()
        note = silence or refusal or (f"page {holder} has the control" if holder is not None and pages > 1 else "")
        self._take.visible = holder is not None and pages > 1
        put(self._band, band_html(self._bench.alarms.open))
        if (words, note) != self._told:
            self._told = (words, note)
            self._words.content = words
            self._note.content = (
                f'<div style="{LOUD if silence else QUIET};margin:0 14px 4px">{html.escape(note)}</div>' if note else ""
            )

    def _add_buttons(self) -> None:
        bench, gui = self._bench, self._bench.server.gui
        gui.add_html(BUTTONS_HTML)
        stop = gui.add_button("STOP", color="red", icon=viser.Icon.HAND_STOP)
        row = gui.add_button_group("Goal", ("Pause", "Resume", "Cancel"))
        stop.on_click(lambda event: bench.commanding(event.client, self._stop, needs_control=False))
        row.on_click(lambda event: bench.commanding(event.client, lambda: self._act(row.value)))

    def _stop(self) -> str:
        bench = self._bench
        told = bench.desk.stop()
        words = f"stop sent to {' and '.join(told)}"
        if "arm" not in told and bench.world.scenario.arm is not None:
            words += ", not to the arm: nobody acts on it"
        if "drive" not in told:
            words += ", not to the drive: nobody acts on it"
        if bench.sequences.is_under_way:
            bench.sequences.hold()
            return f"{words}; the sequence is held"
        return _aside(words, bench.uplink)

    def _cancel(self) -> str:
        bench, uplink = self._bench, self._bench.uplink
        waiting = uplink.waiting() if uplink.is_used else ()
        back = uplink.take_back(waiting) if waiting else ""
        moves = uplink.moves() if uplink.is_used else frozenset()
        if back and not moves:
            bench.desk.driven = None
            return back
        ended = bench.desk.cancel(bench.scene, moves)
        return _aside(f"{back}; {ended}" if back else ended, uplink)

    def _taken(self, client: viser.ClientHandle | None) -> str:
        if client is not None:
            self._bench.control = self._bench.control.taken_by(client.client_id)
        return "the control is here now"

    def _act(self, what: str) -> str:
        desk, scene = self._bench.desk, self._bench.scene
        if what == "Pause":
            return _aside(desk.pause(scene), self._bench.uplink)
        return _aside(desk.resume(), self._bench.uplink) if what == "Resume" else self._cancel()


def head_html(scene: RunScene, name: str, machine: str) -> str:
    """The state of a run in some lines."""
    drive, arm, power = (scene.status(topic) for topic in ("/drive/status", "/arm/status", "/power/status"))
    late = [f"{role} {state}" for role, state in scene.states.items() if state != RUNNING]
    lines = [
        f'<div style="display:flex;justify-content:space-between"><b>{html.escape(machine)}</b>'
        f'<span style="font-variant-numeric:tabular-nums">{scene.stamp * 1e-9:.1f} s</span></div>',
        f'<div style="opacity:.6">{html.escape(name)}</div>',
        _line("drive", drive, _way(drive)),
    ]
    if arm:
        lines.append(_line("arm", arm, arm.get("reason", "")))
    if scene.charge is not None:
        lines.append(_bar(scene.charge, power.get("mode", power.get("state", ""))))
    if late:
        lines.append(f'<div style="color:{OTHER}">{html.escape(", ".join(late))}</div>')
    return f'<div style="font-size:.86em;line-height:1.5;margin:4px 14px 2px">{"".join(lines)}</div>'


def _aside(told: str, uplink: Uplink) -> str:
    """What was done, and how it goes there."""
    aside = uplink.aside()
    return f"{told}, {aside}" if aside else told


def _way(drive: Mapping[str, str]) -> str:
    if drive.get("reason"):
        return drive["reason"]
    if drive.get("state") == "moving" and "distance_to_go" in drive:
        return f"{float(drive['distance_to_go']):.2f} m to go"
    return ""


def _line(role: str, status: Mapping[str, str], words: str) -> str:
    state = status.get("state", "not heard")
    color = COLORS.get(state, OTHER if status else "#8e8e93")
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
