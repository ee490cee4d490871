"""Goals by hand: placed in the scene, foreseen, sent."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import viser

from sojourn_console.draft import Draft, Kind, Point
from sojourn_console.errors import GoalError
from sojourn_console.far_way import FarWay
from sojourn_console.link_words import command_words
from sojourn_console.machine_shape import MachineShape
from sojourn_console.model import RunScene
from sojourn_console.panels.panel import QuietPanel, Workbench, table_html
from sojourn_console.picking import met_by
from sojourn_console.rehearsal import Now, believed
from sojourn_console.rehearsed import RECKONED, SIMULATED, RehearsedDrive, alike
from sojourn_console.rehearser import Rehearser
from sojourn_console.views.view import GREEN, Shown, segments
from sojourn_console.views.way_view import on_ground
from sojourn_flight.arm.tasks.names import TASKS
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_operator.far_goal import closed_places
from sojourn_operator.foresight_words import foresight_lines
from sojourn_physics.terrain.ground_samples import heights_of

LOOK, DRIVE, ROUTE, ARM, TASK = "look round", "drive to a place", "drive a route", "place the arm's tip", "arm task"
KINDS: Mapping[str, Kind] = {DRIVE: "drive", ROUTE: "route", ARM: "arm", TASK: "task"}
TIP = "arm_tip_link"
APART = 0.02
"""Figures of a drive that differ by less are one."""
HERE = "…"
"""No waypoint is chosen."""
HANDLE = "/draft/handle_"


class GoalsPanel(QuietPanel):
    """A draft of a goal in the scene and in fields, what it would take, and its sending."""

    title: ClassVar[str] = "Goals"
    commands: ClassVar[bool] = True

    def __init__(self, bench: Workbench) -> None:
        self._bench = bench
        gui = bench.server.gui
        has_arm = bench.world.scenario.arm is not None
        self._mode = gui.add_dropdown("A click is", (LOOK, DRIVE, ROUTE, *((ARM, TASK) if has_arm else ())))
        names = tuple(bench.world.scenario.config.waypoints)
        self._waypoint: Any = gui.add_dropdown("Waypoint", (HERE, *names), visible=False)
        self._hint = gui.add_html("")
        self._heading = gui.add_checkbox("With heading", False, visible=False)
        self._yaw = gui.add_slider("Heading [°]", -180.0, 180.0, 1.0, 0.0, visible=False)
        self._task = gui.add_dropdown("Task", TASKS.names() or ("none",), visible=False)
        self._values: Any = gui.add_text("Numbers", "", hint="KEY=VALUE, with spaces between them", visible=False)
        self._undo = gui.add_button("Remove last point", visible=False)
        self._over = gui.add_button("Route over the map", icon=viser.Icon.MAP, visible=False)
        self._rehearse = gui.add_button("Rehearse", icon=viser.Icon.EYE, visible=False)
        self._send = gui.add_button("Send", icon=viser.Icon.SEND, color="green", visible=False)
        self._answer = gui.add_html("")
        self._shape = MachineShape(bench.world.scenario.urdf_xml)
        self._line, self._ball = Shown(), Shown()
        self._handles: list[Any] = []
        self._asked: int | None = None
        self._sent: tuple[str, str, int] | None = None
        """Topic of the status, topic of the goal, and its stamp."""
        self._words = ""
        self._rehearser = Rehearser()
        self._foreseen: list[tuple[str, str]] = []
        self._far: FarWay | None = None
        self._connect()
        self._redraw()

    def show(self, scene: RunScene) -> None:
        drive = scene.status("/drive/status")
        if self._asked is not None and drive.get("asked_stamp") == str(self._asked):
            self._asked = None
            self._foreseen = foresight_rows(drive)
        if self._foreseen and self._sent is None:
            self._say(table_html([*self._foreseen, *rehearsal_rows(self._rehearser)]))
        if self._sent is not None:
            topic, goal, stamp = self._sent
            status, command = scene.status(topic), self._bench.uplink.command(goal, stamp)
            if command:
                words = command_words(command, scene.stamp, self._bench.uplink.moment())
                self._say(table_html([(f"command {command['number']}", words)]))
            elif status.get("goal_stamp") == str(stamp):
                told = [("goal", status.get("state", "")), ("", status.get("reason", ""))]
                self._say(table_html(told + ([("map", self._far.told)] if self._far and self._far.told else [])))
        self._go_on(scene)

    def clear(self) -> None:
        self._asked = self._sent = None
        self._foreseen = []
        self._rehearser.end()
        self._say("")

    def close(self) -> None:
        self._rehearser.close()

    def _connect(self) -> None:
        bench = self._bench
        scene = bench.server.scene
        scene.on_click()(self._clicked)
        self._mode.on_update(lambda _: self._chosen())
        self._waypoint.on_update(lambda _: self._named())
        self._heading.on_update(lambda _: self._turned())
        self._yaw.on_update(lambda _: self._turned())
        self._task.on_update(lambda _: self._tasked())
        self._values.on_update(lambda _: self._tasked())
        self._undo.on_click(lambda _: self._change(bench.draft.without_last()))
        self._over.on_click(lambda event: bench.commanding(event.client, self._routed, needs_control=False))
        self._rehearse.on_click(lambda event: bench.commanding(event.client, self._ask))
        self._send.on_click(lambda event: bench.commanding(event.client, self._sending))

    def _chosen(self) -> None:
        if self._bench.world.source and self._mode.value in (DRIVE, ROUTE):
            self._rehearser.prepare()
        with self._bench.lock:
            draft = Draft(KINDS.get(self._mode.value, "drive"))
            if draft.kind == "arm":
                tip = self._shape.link(TIP, self._bench.scene.joints)
                draft = draft.with_point(_point(tip[0])) if tip is not None else draft
            self._bench.draft = draft
        self._tasked()

    def _named(self) -> None:
        """A waypoint of the scenario as the place, or as the next point of a route."""
        place = self._bench.world.scenario.config.waypoints.get(self._waypoint.value)
        if place is not None:
            point = on_ground(self._bench.world, np.array([[place.x, place.y, 0.0]]))[0]
            self._put(_point(point))
            self._waypoint.value = HERE

    def _turned(self) -> None:
        yaw = math.radians(self._yaw.value) if self._heading.value else None
        with self._bench.lock:
            draft = self._bench.draft
            self._bench.draft = Draft(draft.kind, draft.points, yaw, draft.task, draft.values)
        self._redraw()

    def _tasked(self) -> None:
        with self._bench.lock:
            draft = self._bench.draft
            if draft.kind == "task":
                values = dict(word.partition("=")[::2] for word in self._values.value.split())
                self._bench.draft = Draft("task", draft.points, None, self._task.value, values)
        self._redraw()

    def _change(self, draft: Draft) -> None:
        with self._bench.lock:
            self._bench.draft = draft
        self._redraw()

    def _clicked(self, event: Any) -> None:
        if self._mode.value not in (DRIVE, ROUTE, TASK):
            return
        place = met_by(self._bench.world.ground, np.array(event.ray_origin), np.array(event.ray_direction))
        if place is None:
            event.client.add_notification("No ground there", "the goal has to be on the map", color="red")
            return
        if self._mode.value == TASK:
            self._aim(place)
            return
        self._put(_point(place))

    def _put(self, point: Point) -> None:
        """A point of a route, or the place to drive to: what a map has made of that before is forgotten."""
        self._change(replace(self._bench.draft, kind=KINDS[self._mode.value]).with_point(point))

    def _routed(self) -> str:
        """The way to the last point over the map of the site, and what the drive has found closed on it."""
        bench, scene = self._bench, self._bench.scene
        draft = bench.checked_draft()
        if scene.pose is None:
            raise GoalError("over the map", "the drive has not said yet where the machine is")
        try:
            site = bench.world.site.with_found(closed_places(scene.costmap))
        except InvalidValueError as error:
            raise GoalError("over the map", str(error)) from error
        routed = draft.over(site, _point(scene.pose.position), self._heights)
        self._change(routed)
        return f"a route of {len(routed.points)} points: look at it, rehearse it, send it"

    def _aim(self, place: Any) -> None:
        """A task at a place of the ground: into its numbers, in base_link, as the arm takes them."""
        pose = self._bench.scene.pose
        if pose is None:
            return
        turn = viser.transforms.SO3(pose.orientation[[3, 0, 1, 2]]).inverse()
        local = turn.apply(place - pose.position)
        others = [word for word in self._values.value.split() if not word.startswith("position=")]
        self._values.value = " ".join(["position=" + ",".join(f"{one:.3f}" for one in local), *others])
        self._tasked()

    def _ask(self) -> str:
        draft = self._bench.checked_draft()
        self._asked, self._sent = self._bench.desk.ask(draft), None
        self._foreseen = [("rehearsal", "asked, waits for the drive …")]
        scene, world = self._bench.scene, self._bench.world
        if world.source and scene.pose is not None and scene.charge is not None:
            now = Now(scene.pose, scene.charge, scene.stamp * 1e-9)
            self._rehearser.begin(world.source, believed(world.scenario, now, draft))
        return ""

    def _sending(self) -> str:
        draft = self._bench.checked_draft()
        stamp = self._bench.desk.send(draft)
        self._bench.uplink.name(draft.topic, stamp, draft.words())
        self._sent = ("/drive/status" if draft.is_way else "/arm/status", draft.topic, stamp)
        if draft.is_way:
            self._far = FarWay(self._bench.world.site, draft, self._heights) if draft.over_map else None
        self._asked, self._foreseen = None, []
        self._rehearser.end()
        aside = self._bench.uplink.aside()
        return f"{self._mode.value}: sent" + (f" {aside}" if aside else "")

    def _go_on(self, scene: RunScene) -> None:
        """Where the drive has found a way over the map closed, send it along another."""
        far, driven = self._far, self._bench.desk.driven
        if far is None or driven is None or driven.is_paused or scene.pose is None:
            self._far = far if driven is not None else None  # cancelled, or stopped
            return
        far.hear(scene.costmap)
        status = scene.status("/drive/status")
        if status.get("goal_stamp") != self._bench.uplink.machine_stamp(driven.draft.topic, driven.stamp):
            return
        before = far.way
        is_over, way = far.after(status, _point(scene.pose.position))
        if way is not None:
            try:
                self._sent = ("/drive/status", way.topic, self._bench.desk.send(way))
            except GoalError as error:
                is_over, far.told = True, str(error)
            if self._bench.draft == before:
                self._change(way)
        if is_over:
            self._say(table_html([("goal", status["state"]), ("", far.told or status.get("reason", ""))]))
            self._far = self._sent = None

    def _heights(self, places: FloatArray) -> FloatArray:
        """Of the ground at places, shape (n, 2) [m]."""
        return heights_of(self._bench.world.ground, *places.T)

    def _say(self, words: str) -> None:
        if words != self._words:
            self._words = self._answer.content = words

    def _redraw(self) -> None:
        """Controls and marks as the draft has them."""
        mode, draft = self._mode.value, self._bench.draft
        is_goal, is_way = mode != LOOK, mode in (DRIVE, ROUTE)
        for handle, is_there in (
            (self._waypoint, is_way and len(self._waypoint.options) > 1),
            (self._heading, is_way), (self._yaw, is_way and self._heading.value),
            (self._over, is_way and bool(draft.points)), (self._rehearse, is_way),
            (self._undo, mode == ROUTE and bool(draft.points)), (self._send, is_goal),
            (self._task, mode == TASK), (self._values, mode == TASK),
        ):  # fmt: skip
            handle.visible = is_there
        self._hint.content = _hint(mode, draft)
        self._mark(draft if is_goal else Draft())

    def _mark(self, draft: Draft) -> None:
        server, world = self._bench.server, self._bench.world
        while self._handles:
            self._handles.pop().remove()
        for number, point in enumerate(draft.points):
            self._handles.append(self._handle(number, point, draft))
        pose = self._bench.scene.pose
        points = [*([pose.position] if pose is not None else []), *map(np.array, draft.points)]
        if not draft.is_way or len(points) < 2:
            self._line.remove()
        else:
            line = segments(on_ground(world, _filled(np.array(points))))
            self._line.put(
                server.scene.add_line_segments(
                    "/draft/line", line, colors=GREEN, thickness=3.0, thickness_units="screen"
                )
            )

    def _handle(self, number: int, point: Point, draft: Draft) -> Any:
        """To drag a place with: on the ground, or at the tip of the arm."""
        scene, is_arm = self._bench.server.scene, draft.kind == "arm"
        parent = "/machine" if is_arm else ""
        handle = scene.add_transform_controls(
            f"{parent}{HANDLE}{number}",
            scale=0.35 if is_arm else 0.8,
            active_axes=(True, True, is_arm),
            disable_rotations=True,
            depth_test=False,
            position=point,
        )
        scene.add_icosphere(
            f"{parent}{HANDLE}{number}/ball", radius=0.04 if is_arm else 0.12, color=GREEN, cast_shadow=False
        )

        def dragged(_: Any) -> None:
            x, y, z = (float(one) for one in handle.position)
            if not is_arm:
                z = float(on_ground(self._bench.world, np.array([[x, y, 0.0]]))[0, 2])
            with self._bench.lock:
                self._bench.draft = self._bench.draft.moved(number, (x, y, z))
            self._hint.content = _hint(self._mode.value, self._bench.draft)

        handle.on_update(dragged)
        return handle


def foresight_rows(status: Mapping[str, str]) -> list[tuple[str, str]]:
    """The drive's answer to a question, as names and values."""
    first, *rest = foresight_lines(status)
    rows = [("rehearsal", first)]
    for line in rest:
        name, _, value = line.partition(":")
        rows.append((name, value.strip()))
    return rows


def rehearsal_rows(rehearser: Rehearser) -> list[tuple[str, str]]:
    """What a rehearsal has found so far, as names and values."""
    rows = _found_rows(rehearser.found.get(RECKONED), rehearser.looks)
    rows += _found_rows(rehearser.found.get(SIMULATED))
    if rehearser.problem:
        return [*rows, (SIMULATED, rehearser.problem)]
    if rehearser.is_under_way and SIMULATED not in rehearser.found:
        rows.append((SIMULATED, "begins …"))
    return rows


def _found_rows(found: RehearsedDrive | None, looks: Sequence[RehearsedDrive] = ()) -> list[tuple[str, str]]:
    if found is None:
        return []
    same = alike(looks) if looks else [found]
    state = found.state if found.is_over else f"{found.time_s:.0f} s so far"
    if len(same) < len(looks):
        state += f" in {len(same)} of {len(looks)}"
    charge = f", charge {found.charge:.1%}, {found.mode.lower()}" if math.isfinite(found.charge) else ""
    slip = f", slip {found.slip:.0%}" if found.means == SIMULATED else ""
    return [
        (found.means, f"{state}: {found.reason}" if found.reason else state),
        ("driven", f"{found.length_m:.2f} m in {found.time_s:.0f} s{_spread('time_s', same, '.0f')}"),
        ("energy", f"{found.energy_wh:.2f} Wh{_spread('energy_wh', same, '.2f')}{charge}"),
        ("worst", f"tilt {found.tilt_deg:.1f}°{slip}"),
    ]


def _spread(name: str, looks: Sequence[RehearsedDrive], form: str) -> str:
    """By how much a figure differs from time to time; nothing where it hardly does."""
    values = [getattr(one, name) for one in looks]
    low, high = min(values), max(values)
    return f" ({low:{form}} to {high:{form}})" if high > (1.0 + APART) * low else ""


def _hint(mode: str, draft: Draft) -> str:
    if mode == LOOK:
        words = "Choose what a click in the scene means to place a goal."
    elif not draft.points and mode != TASK:
        words = "Click on the ground." if mode == DRIVE else "Click on the ground, point by point."
    elif mode == ARM:
        words = "Tip in base_link: " + ", ".join(f"{one:.3f}" for one in draft.points[0]) + " m. Drag the handle."
    elif mode == TASK:
        words = "A click on the ground fills in its position in base_link."
    else:
        x, y, _ = draft.points[-1]
        words = (
            f"({x:.2f}, {y:.2f}) m"
            + (f", {len(draft.points)} points" if draft.kind == "route" else "")
            + ". Drag to move."
        )
    return f'<div style="font-size:.82em;opacity:.75;margin:0 14px">{words}</div>'


def _filled(points: Any) -> Any:
    """A line through points with one every 0.2 m, so that it follows the ground."""
    parts = []
    for one, other in itertools.pairwise(points):
        count = max(2, int(np.linalg.norm(other - one) / 0.2))
        parts.append(np.linspace(one, other, count))
    return np.concatenate(parts)


def _point(place: Any) -> Point:
    x, y, z = (float(one) for one in place)
    return x, y, z
