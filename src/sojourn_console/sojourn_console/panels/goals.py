"""Goals by hand: placed in the scene, foreseen, sent."""

import itertools
import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import viser

from sojourn_console.desk import Sent
from sojourn_console.draft import Draft, Kind, Point
from sojourn_console.errors import GoalError
from sojourn_console.far_way import FarWay
from sojourn_console.goal_words import ARM, DRIVE, LOOK, ROUTE, TASK, foresight_rows, hint_html, rehearsal_rows
from sojourn_console.link_words import command_words
from sojourn_console.machine_shape import MachineShape
from sojourn_console.model import COSTMAP, RunScene
from sojourn_console.panels.panel import QuietPanel, Workbench, table_html
from sojourn_console.panels.shared_fields import SharedFields
from sojourn_console.picking import met_by
from sojourn_console.rehearsal import Now, believed
from sojourn_console.rehearser import Rehearser
from sojourn_console.views.view import GREEN, segments
from sojourn_console.views.way_view import on_ground, shown_line
from sojourn_flight.arm.tasks.names import TASKS
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_operator.far_goal import closed_places
from sojourn_operator.steps.step import FINAL_STATES, REFUSED
from sojourn_physics.terrain.ground_samples import heights_of

KINDS: Mapping[str, Kind] = {DRIVE: "drive", ROUTE: "route", ARM: "arm", TASK: "task"}
TIP = "arm_tip_link"
HERE = "…"
"""No waypoint is chosen."""
HANDLE = "/draft/handle_"
IDLE = "idle"
"""State of a drive that a velocity command has come to, too."""


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
        self._line = shown_line(bench.server, "/draft/line", GREEN, 3.0)
        self._handles: list[Any] = []
        self._asked: int | None = None
        self._sent: Sent | None = None
        """Of which is told, None where another answer is."""
        self._words = ""
        self._rehearser = Rehearser()
        self._foreseen: list[tuple[str, str]] = []
        self._far: FarWay | None = None
        self._shared = SharedFields(bench)
        self._connect()
        self._redraw()

    def topics(self) -> frozenset[str]:
        """A way over the map goes round what the drive has found closed."""
        is_way = self._far is not None or self._mode.value in (DRIVE, ROUTE)
        return frozenset((COSTMAP,)) if is_way else frozenset()

    def show(self, scene: RunScene) -> None:
        drive = scene.status("/drive/status")
        if self._asked is not None and drive.get("asked_stamp") == str(self._asked):
            self._asked = None
            self._foreseen = foresight_rows(drive)
        if self._sent is not None:
            self._sent = self._as_told(self._sent, scene)
            rows = self._sent_rows(self._sent, scene)
            if rows:
                self._say(table_html(rows))
        elif self._foreseen:
            self._say(table_html([*self._foreseen, *rehearsal_rows(self._rehearser)]))
        self._go_on(scene)

    def clear(self) -> None:
        self._sent = None
        self._forget_answer()
        self._say("")

    def close(self) -> None:
        self._rehearser.close()

    def _connect(self) -> None:
        bench, shared = self._bench, self._shared

        def undo(event: Any) -> None:
            shared.let(event.client, self._undone)

        def route(event: Any) -> None:
            shared.let(event.client, lambda: bench.commanding(event.client, self._routed, needs_control=False))

        bench.server.scene.on_click()(self._clicked)
        shared.connect(self._mode, self._chosen)
        shared.connect(self._waypoint, self._named)
        shared.connect(self._heading, self._turned)
        shared.connect(self._yaw, self._turned)
        shared.connect(self._task, self._tasked)
        shared.connect(self._values, self._tasked)
        self._undo.on_click(undo)
        self._over.on_click(route)
        self._rehearse.on_click(lambda event: bench.commanding(event.client, self._ask))
        self._send.on_click(lambda event: bench.commanding(event.client, self._sending))

    def _chosen(self) -> None:
        if self._bench.world.source and self._mode.value in (DRIVE, ROUTE):
            self._rehearser.prepare()
        draft = Draft(KINDS.get(self._mode.value, "drive"), yaw=self._wanted_yaw())
        if draft.kind == "arm":
            tip = self._shape.link(TIP, self._bench.scene.joints)
            draft = draft.with_point(_point(tip[0])) if tip is not None else draft
        self._lay(draft)
        self._tasked()

    def _named(self) -> None:
        """A waypoint of the scenario as the place, or as the next point of a route."""
        place = self._bench.world.scenario.config.waypoints.get(self._waypoint.value)
        if place is not None:
            point = on_ground(self._bench.world, np.array([[place.x, place.y, 0.0]]))[0]
            self._put(_point(point))
            self._waypoint.value = HERE

    def _wanted_yaw(self) -> float | None:
        """Heading at the end of a way as the fields have it [rad], None for any."""
        is_wanted = self._heading.value and self._mode.value in (DRIVE, ROUTE)
        return math.radians(self._yaw.value) if is_wanted else None

    def _turned(self) -> None:
        self._change(replace(self._bench.draft, yaw=self._wanted_yaw()))

    def _tasked(self) -> None:
        draft = self._bench.draft
        if draft.kind == "task":
            values = dict(word.partition("=")[::2] for word in self._values.value.split())
            self._lay(Draft("task", draft.points, None, self._task.value, values))
        self._redraw()

    def _undone(self) -> None:
        self._change(self._bench.draft.without_last())

    def _change(self, draft: Draft) -> None:
        self._lay(draft)
        self._redraw()

    def _lay(self, draft: Draft) -> None:
        """On the table: what the one before would take is no answer for another."""
        with self._bench.lock:
            if draft != self._bench.draft:
                self._forget_answer()
            self._bench.draft = draft

    def _forget_answer(self) -> None:
        """That of the drive, and what is rehearsed."""
        if self._sent is None and self._foreseen:
            self._say("")
        self._asked, self._foreseen = None, []
        self._rehearser.end()

    def _clicked(self, event: Any) -> None:
        if self._mode.value in (DRIVE, ROUTE, TASK):
            self._shared.let(event.client, lambda: self._placed(event))

    def _placed(self, event: Any) -> None:
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
        self._sent = Sent(draft, stamp)
        if draft.is_way:
            self._far = FarWay(self._bench.world.site, draft, self._heights) if draft.over_map else None
        self._forget_answer()
        aside = self._bench.uplink.aside()
        return f"{self._mode.value}: sent, {draft.words()}" + (f", {aside}" if aside else "")

    def _as_told(self, sent: Sent, scene: RunScene) -> Sent:
        """A goal that was sent, as it is told now; a way as it was sent last: after a pause it has another stamp."""
        desk = self._bench.desk
        if sent.draft.is_way and desk.driven is not None:
            sent = desk.driven
        status = scene.status(sent.status_topic)
        return replace(sent, told=status.get("state", "")) if desk.is_told_of(sent, status) else sent

    def _sent_rows(self, sent: Sent, scene: RunScene) -> list[tuple[str, str]]:
        """What became of a goal that was sent, as names and values; none where nothing new is told."""
        uplink, status = self._bench.uplink, scene.status(sent.status_topic)
        command = uplink.command(sent.draft.topic, sent.stamp)
        if command:
            return [(f"command {command['number']}", command_words(command, scene.stamp, uplink.moment()))]
        if self._bench.desk.is_told_of(sent, status):
            rows = [("goal", sent.told), ("", status.get("reason", ""))]
            return rows + ([("map", self._far.told)] if self._far and self._far.told else [])
        if not sent.told:
            return [("goal", "sent, nothing is told of it yet")]
        if sent.told == REFUSED or status.get("state", IDLE) in (IDLE, REFUSED):
            return []  # neither a velocity nor what is refused takes its place; nor was there one of what is refused
        return [("goal", sent.told if sent.told in FINAL_STATES else ""), ("", "another goal has taken its place")]

    def _go_on(self, scene: RunScene) -> None:
        """Where the drive has found a way over the map closed, send it along another."""
        far, driven = self._far, self._bench.desk.driven
        if far is None or driven is None or driven.is_paused or scene.pose is None:
            self._far = far if driven is not None else None  # cancelled, or stopped
            return
        far.hear(scene.costmap)
        status = scene.status("/drive/status")
        if not self._bench.desk.is_told_of(driven, status):
            return
        before = far.way
        is_over, way = far.after(status, _point(scene.pose.position))
        if way is not None:
            try:
                self._sent = Sent(way, self._bench.desk.send(way))
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
        self._hint.content = hint_html(mode, draft)
        self._mark(draft if is_goal else Draft())

    def _mark(self, draft: Draft) -> None:
        while self._handles:
            self._handles.pop().remove()
        for number, point in enumerate(draft.points):
            self._handles.append(self._handle(number, point, draft))
        self._draw_line(draft)

    def _draw_line(self, draft: Draft) -> None:
        """Of a way, from where the machine is."""
        pose = self._bench.scene.pose
        points = [*([pose.position] if pose is not None else []), *map(np.array, draft.points)]
        if not draft.is_way or len(points) < 2:
            self._line.remove()
        else:
            self._line.draw(segments(on_ground(self._bench.world, _filled(np.array(points)))))

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

        def move() -> None:
            x, y, z = (float(one) for one in handle.position)
            if not is_arm:
                z = float(on_ground(self._bench.world, np.array([[x, y, 0.0]]))[0, 2])
            self._lay(self._bench.draft.moved(number, (x, y, z)))
            self._hint.content = hint_html(self._mode.value, self._bench.draft)
            self._draw_line(self._bench.draft)

        def dragged(event: Any) -> None:
            with self._bench.lock:
                points = self._bench.draft.points
                is_there = event.phase != "start" and number < len(points)  # a mark that has gone may still tell
                if is_there and not self._shared.let(event.client, move):
                    handle.position = points[number]

        handle.on_update(dragged)
        return handle


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
