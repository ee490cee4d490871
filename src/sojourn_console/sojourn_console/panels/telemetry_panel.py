"""Plots and numbers of any field."""

import math
from typing import Any, ClassVar

import viser
from viser import uplot

from sojourn_console.errors import GoalError, LayoutError
from sojourn_console.feed import FeedMessage
from sojourn_console.layouts import layouts_file, read_layouts, save_layout
from sojourn_console.model import RunScene
from sojourn_console.panels.panel import Workbench, table_html
from sojourn_console.telemetry import FieldCurve, Telemetry, aligned, as_csv

COLORS = ("#409cff", "#ff9500", "#30d158", "#ff453a", "#bf5af2", "#64d2ff", "#ffd60a", "#ac8e68")
MOST_CURVES = 8
"""Of a plot; of more the first are drawn."""
EVERY = 10
"""Of the shows of a page one draws plots anew: three times a second."""
SPANS = {"30 s": 30.0, "2 min": 120.0, "10 min": 600.0, "all": math.inf}
HEIGHT = 150
UNDER, BESIDE = 32, 62
"""Room for the numbers of the axes [pixels]: beside a plot for as much as -0.0325."""


class TelemetryPanel:
    """Fields that are followed, each as a plot or as numbers."""

    title: ClassVar[str] = "Telemetry"
    commands: ClassVar[bool] = False

    def __init__(self, bench: Workbench) -> None:
        self._bench, self._file = bench, layouts_file()
        self.telemetry = Telemetry(bench.world.table, bench.world.attachments)
        gui = bench.server.gui
        topics = tuple(row.name for row in bench.world.table if row.logged and row.name != "/clock")
        first = "/odom" if "/odom" in topics else topics[0]
        self._topic = gui.add_dropdown("Topic", topics, initial_value=first)
        self._field = gui.add_dropdown("Field", ("…",))
        self._typed: Any = gui.add_text("Or by name", "", hint="/joint_states.velocity[wheel_front_left_joint]")
        self._add = gui.add_button_group("Show as", ("Plot", "Number"))
        self._span = gui.add_dropdown("Span", tuple(SPANS), initial_value="2 min")
        self._freeze = gui.add_checkbox("Freeze", False)
        with gui.add_folder("Layouts and CSV", expand_by_default=False):
            self._csv = gui.add_button("Save as CSV", icon=viser.Icon.DOWNLOAD)
            self._name = gui.add_text("Name", "")
            self._save = gui.add_button("Save layout")
            self._known = gui.add_dropdown("Saved", ("…",))
            self._load = gui.add_button("Show layout")
        self._numbers: set[str] = set()
        self._table = gui.add_html("")
        self._folder = gui.add_folder("Plots")
        self._plots: dict[str, tuple[Any, Any, tuple[str, ...]]] = {}
        self._count = 0
        self._connect()
        self._ask()
        self._list_layouts()

    def topics(self) -> frozenset[str]:
        return frozenset((self.telemetry.asked,)) - {""}

    def topics_in_full(self) -> frozenset[str]:
        return self.telemetry.topics

    def hear(self, heard: list[FeedMessage]) -> None:
        if not self._freeze.value:
            self.telemetry.hear(heard)

    def clear(self) -> None:
        self.telemetry.clear()

    def close(self) -> None:
        self.telemetry.clear()

    def show(self, scene: RunScene) -> None:
        self._count += 1
        if self._count % EVERY or self._freeze.value:
            return
        problems = self.telemetry.update()
        known = self.telemetry.names_of(self._topic.value)
        if known and tuple(self._field.options) != known:
            self._field.options = known
        now = scene.stamp * 1e-9
        for field in self.telemetry.fields:
            if field not in self._numbers:
                self._draw(field, now)
        rows = [
            (curve.name, f"{curve.values[-1]:.6g} {curve.unit}")
            for field in self.telemetry.fields
            if field in self._numbers
            for curve in self.telemetry.curves(field)
            if len(curve.values)
        ]
        words = table_html([*rows, *problems.items()])
        if words != self._table.content:
            self._table.content = words

    def _connect(self) -> None:
        bench = self._bench
        self._topic.on_update(lambda _: self._ask())
        self._add.on_click(lambda event: bench.commanding(event.client, self._adding, needs_control=False))
        self._csv.on_click(lambda event: bench.commanding(event.client, lambda: self._write(event.client), False))
        self._save.on_click(lambda event: bench.commanding(event.client, self._saving, needs_control=False))
        self._load.on_click(lambda event: bench.commanding(event.client, self._loading, needs_control=False))

    def _ask(self) -> None:
        with self._bench.lock:
            self.telemetry.asked = self._topic.value
            self._field.options = self.telemetry.names_of(self._topic.value) or ("…",)

    def _adding(self) -> str:
        typed = self._typed.value.strip()
        field = typed or f"{self._topic.value}.{self._field.value}"
        if not typed and self._field.value == "…":
            raise GoalError(self._topic.value, "nothing has come on it yet, so its fields are not known")
        self._follow(field, self._add.value == "Number")
        self._typed.value = ""
        return ""

    def _follow(self, field: str, as_number: bool) -> None:
        self.telemetry.follow(field)
        if as_number:
            self._numbers.add(field)
            self._close_plot(field)
        else:
            self._numbers.discard(field)

    def _draw(self, field: str, now: float) -> None:
        curves = self.telemetry.curves(field)[:MOST_CURVES]
        shown = tuple(curve.name for curve in curves)
        data = aligned(curves, now - SPANS[self._span.value]) if curves else ()
        if not curves or len(data[0]) < 2:
            return
        box, plot, drawn = self._plots.get(field, (None, None, ()))
        if plot is not None and drawn == shown:
            plot.data = data
            return
        if box is not None:
            box.remove()
        with self._folder:
            box = self._bench.server.gui.add_folder(_title(field, curves))
        with box:
            plot = self._bench.server.gui.add_uplot(
                data,
                (uplot.Series(label="t [s]"), *(_series(field, curve, number) for number, curve in enumerate(curves))),
                scales={"x": uplot.Scale(time=False, auto=True), "y": uplot.Scale(auto=True)},
                axes=(_axis(UNDER), _axis(BESIDE)),
                legend=uplot.Legend(show=True),
                height=HEIGHT,
            )
            close = self._bench.server.gui.add_button("Remove", icon=viser.Icon.X)
        close.on_click(lambda _: self._remove(field))
        self._plots[field] = (box, plot, shown)

    def _remove(self, field: str) -> None:
        with self._bench.lock:
            self.telemetry.forget(field)
            self._numbers.discard(field)
            self._close_plot(field)

    def _close_plot(self, field: str) -> None:
        box, _, _ = self._plots.pop(field, (None, None, ()))
        if box is not None:
            box.remove()

    def _write(self, client: Any) -> str:
        curves = [curve for field in self.telemetry.fields for curve in self.telemetry.curves(field)]
        if not curves:
            raise GoalError("CSV", "there is nothing to write: follow a field first")
        client.send_file_download("telemetry.csv", as_csv(curves).encode())
        return f"{len(curves)} columns"

    def _saving(self) -> str:
        fields = tuple(f"{field}{' #' if field in self._numbers else ''}" for field in self.telemetry.fields)
        save_layout(self._file, self._name.value.strip(), fields)
        self._list_layouts()
        return f"layout {self._name.value.strip()} saved"

    def _loading(self) -> str:
        known = read_layouts(self._file)
        if self._known.value not in known:
            raise LayoutError(self._known.value, "there is none of this name")
        for field in self.telemetry.fields:
            self._remove(field)
        for field in known[self._known.value]:
            self._follow(field.removesuffix(" #"), field.endswith(" #"))
        return ""

    def _list_layouts(self) -> None:
        try:
            self._known.options = tuple(read_layouts(self._file)) or ("…",)
        except LayoutError:  # told when one is asked for
            self._known.options = ("…",)


def _axis(room: int) -> uplot.Axis:
    return uplot.Axis(
        stroke="#999", grid={"stroke": "#8883", "width": 1}, ticks={"stroke": "#8883", "width": 1}, size=room
    )


def _title(field: str, curves: tuple[FieldCurve, ...]) -> str:
    units = dict.fromkeys(curve.unit for curve in curves if curve.unit)
    return f"{field} [{', '.join(units)}]" if units else field


def _series(field: str, curve: FieldCurve, number: int) -> uplot.Series:
    label = curve.name.removeprefix(field).strip("[].") or field.rpartition(".")[2]
    return uplot.Series(label=label, stroke=COLORS[number % len(COLORS)], width=1.5, spanGaps=True)
