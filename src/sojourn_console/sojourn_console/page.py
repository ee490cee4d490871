"""The page: what is heard becomes a scene, the scene is drawn; panels beside it.

A further panel is one more row of `PANELS`: a class with a title that is made from the bench (`panels.panel.Panel`).
"""

import os
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import cast

import viser

from sojourn_console.alarm_board import AlarmBoard
from sojourn_console.bag_feed import BagFeed
from sojourn_console.desk import CommandDesk
from sojourn_console.earlier import EarlierTraces
from sojourn_console.failures import OutlivedView
from sojourn_console.feed import Feed
from sojourn_console.frames import PART, REALTIME_PART, Frames
from sojourn_console.gate import GuardedServer
from sojourn_console.model import STATUSES, RunScene, after_all
from sojourn_console.panels.alarms import AlarmsPanel
from sojourn_console.panels.goals import GoalsPanel
from sojourn_console.panels.head import HeadPanel
from sojourn_console.panels.link_panel import LinkPanel
from sojourn_console.panels.panel import Panel, Workbench
from sojourn_console.panels.scene_panel import ScenePanel
from sojourn_console.panels.sequence import SequencePanel
from sojourn_console.panels.telemetry_panel import TelemetryPanel
from sojourn_console.panels.time_line import TimeLinePanel
from sojourn_console.sequence_board import SequenceBoard
from sojourn_console.traces import LEFT_BY
from sojourn_console.uplink import Uplink
from sojourn_console.views.all_views import VIEWS
from sojourn_console.views.ground_view import GroundView
from sojourn_console.views.view import SceneView
from sojourn_console.world import World
from sojourn_operator.alarms.watch import Watch, limits_of

REST_S = 0.02
"""Wall time at least between two looks, however long they take. While a look is drawn nothing goes to the browsers, so
that they have whole ones, and viser sends 60 times a second: without a rest longer than that a page stands still on a
machine that is too slow for 30 scenes a second.
"""
SLOW = 6
"""Of so many scenes one is shown to the panels: text need not flicker."""
ALWAYS = ("/odom", "/joint_states", "/battery_state", "/diagnostics", *STATUSES)
"""Topics that are heard whatever is shown."""
PANELS: tuple[type[Panel], ...] = (GoalsPanel, SequencePanel, AlarmsPanel, TelemetryPanel, LinkPanel)
"""Tabs besides that of the scene, in their order."""
IN_FULL = ("/diagnostics", "/truth/ground")
"""Of them every message counts: all nodes beat at one time, and the ground tells what is new since the one before."""
IN_FULL_OF_A_BAG = (*IN_FULL, *LEFT_BY)
"""Of what leaves traces every message counts where time may jump."""


class Page:
    """Of one run.

    Args:
        server: where it is served. world: of the run. feed: to it; closed with the page.
        limits: of alarms over those of the machine, a file. who: commands and acknowledges.

    Raises:
        ConfigError, UnknownFieldNameError: the limits are wrong.
    """

    def __init__(
        self, server: GuardedServer, world: World, feed: Feed, limits: Path | None = None, who: str = "operator"
    ) -> None:
        self._first = RunScene()
        alarms = AlarmBoard(Watch(limits_of(world.scenario, limits), world.table), who)
        sequences = SequenceBoard(world, feed, who)
        uplink = Uplink(feed, world.scenario.link, world.table)
        desk = CommandDesk(uplink)
        self.bench = Workbench(server, world, feed, desk, alarms, sequences, uplink, scene=self._first)
        server.gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False, control_width="medium")
        self._views = tuple(view(server, world) for view in VIEWS)
        outlived = (cast(SceneView, OutlivedView(view, self.bench.failures)) for view in self._views)
        self._head: list[Panel] = [HeadPanel(self.bench)]
        if isinstance(feed, BagFeed):
            self._head.append(TimeLinePanel(self.bench, feed))
        tabs = server.gui.add_tab_group()
        self._tabs: list[Panel] = []
        for panel in PANELS:
            if not (panel.commands and isinstance(feed, BagFeed)):
                with tabs.add_tab(panel.title):
                    self._tabs.append(panel(self.bench))
        with tabs.add_tab(ScenePanel.title):
            self._scene_panel = ScenePanel(self.bench, tuple(outlived))
        self._fold_all = frozenset(IN_FULL_OF_A_BAG if isinstance(feed, BagFeed) else IN_FULL)
        self._images = tuple(camera.topic for camera in world.cameras if camera.topic)
        self._earlier = EarlierTraces(world.run.folder if world.run is not None else None)
        self._count = 0
        server.on_client_disconnect(self._gone)

    def run(self, goes_on: Callable[[], bool]) -> None:
        """Show what comes, as often as the machine has room for (`frames`), for so long as that says."""
        bag = self.bench.feed if isinstance(self.bench.feed, BagFeed) else None
        part = REALTIME_PART if bag is not None or self.bench.world.is_in_real_time else PART
        frames = Frames(part * len(os.sched_getaffinity(0)))
        due = before = time.monotonic()
        while goes_on():
            now = time.monotonic()
            if bag is not None:
                with self.bench.lock:
                    bag.advance(now - before)
            before = now
            spent = time.thread_time()
            self.look()
            due = max(due + frames.interval_s(time.thread_time() - spent), now)
            time.sleep(max(due - time.monotonic(), REST_S))

    def look(self) -> None:
        """Take what has come, and show it: what of the page cannot do so is left out."""
        bench, failures = self.bench, self.bench.failures
        with bench.lock:
            panels = [*self._head, *self._tabs]
            self._want(panels)
            if bench.feed.has_jumped():
                self._clear()
            heard = bench.feed.poll()
            newest = {one.row.name: place for place, one in enumerate(heard)}
            folded = self._fold_all
            kept = (one for place, one in enumerate(heard) if newest[one.row.name] == place or one.row.name in folded)
            bench.scene = after_all(bench.scene, kept)
            with failures.of("what the run left behind before it was heard"):
                bench.scene = self._earlier.under(bench.scene, time.monotonic())
            scene = bench.scene
            for panel in panels:
                with failures.of(_part(panel)):
                    panel.hear(heard)
            bench.another_run.look(time.monotonic(), scene.stamp > 0)
            self._count += 1
            with bench.server.atomic():
                for panel in [self._scene_panel, *(panels if self._count % SLOW == 0 else ())]:
                    with failures.of(_part(panel)):
                        panel.show(scene)
            with failures.of("the way that was sent"):
                bench.desk.look(scene)

    def close(self) -> None:
        """End it, and the feed."""
        for panel in self._tabs:
            with self.bench.failures.of(_part(panel)):
                panel.close()
        self._earlier.close()
        self.bench.feed.close()
        self.bench.server.stop()

    def _want(self, panels: Sequence[Panel]) -> None:
        """Have the feed hear what is looked at, as far as the run has it."""
        in_full, looked_at = set(self._fold_all), {*ALWAYS, *self._scene_panel.topics(), *self._images}
        for panel in panels:
            with self.bench.failures.of(_part(panel)):
                in_full |= panel.topics_in_full()
                looked_at |= panel.topics()
        known = {row.name for row in self.bench.world.table}
        self.bench.feed.want(looked_at & known, in_full & known)

    def _clear(self) -> None:
        self.bench.scene = self._first
        self.bench.desk.forget()
        if not isinstance(self.bench.feed, BagFeed):
            self.bench.another_run.begins()
            self._earlier.begin_anew()
        for view in self._views:
            if isinstance(view, GroundView):
                with self.bench.failures.of("the ground"):
                    view.clear()
        for panel in (*self._head, *self._tabs):
            with self.bench.failures.of(_part(panel)):
                panel.clear()

    def _gone(self, client: viser.ClientHandle) -> None:
        with self.bench.lock:
            self.bench.control = self.bench.control.without(client.client_id)


def _part(panel: Panel) -> str:
    """What a panel is called where it fails."""
    return f"the tab {panel.title}" if panel.title else type(panel).__name__
