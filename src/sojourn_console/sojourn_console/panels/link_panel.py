"""The link to Earth: whether it is open and until when, how long light takes, what is on its way."""

from typing import Any, ClassVar

import viser

from sojourn_console.bag_feed import BagFeed
from sojourn_console.errors import GoalError
from sojourn_console.feed import FeedMessage
from sojourn_console.link_ahead import LinkAhead
from sojourn_console.link_words import link_rows
from sojourn_console.model import RunScene
from sojourn_console.panels.choice import Choice
from sojourn_console.panels.panel import QuietPanel, Workbench, put, table_html

NONE = [("link", "none: the operator stands beside the machine"), ("light takes", "0 s"), ("on its way", "nothing")]


class LinkPanel(QuietPanel):
    """What the Earth knows of the link of a run, and of its commands; that there is none where it has none."""

    title: ClassVar[str] = "Link"

    def __init__(self, bench: Workbench) -> None:
        self._bench, gui = bench, bench.server.gui
        scenario = bench.world.scenario
        self._ahead = (
            None if scenario.link is None else LinkAhead(scenario.link, scenario.link_sky, scenario.config.sun.time)
        )
        self._commands = self._ahead is not None and not isinstance(bench.feed, BagFeed)
        self._over: Any = gui.add_checkbox(
            "Over the link", bench.uplink.is_used, visible=self._commands, hint="Goals, STOP, Pause, Resume and Cancel"
        )
        self._which = Choice(gui, "Waits on Earth", visible=False)
        self._back = gui.add_button("Take back", icon=viser.Icon.ARROW_BACK_UP, visible=False)
        self._words = gui.add_html(table_html(NONE) if self._ahead is None else "")
        self._over.on_update(lambda event: self._switch(event.client))
        self._back.on_click(lambda event: bench.commanding(event.client, self._taken_back))

    def topics(self) -> frozenset[str]:
        return self._bench.uplink.topics

    def hear(self, heard: list[FeedMessage]) -> None:
        self._bench.uplink.hear(heard)

    def show(self, scene: RunScene) -> None:
        if self._ahead is None:
            return
        x, y = (0.0, 0.0) if scene.pose is None else scene.pose.position[:2].tolist()
        self._ahead.look(scene.stamp, x, y)
        put(self._words, table_html(link_rows(self._bench.uplink, scene.stamp, self._ahead)))
        waiting = self._bench.uplink.waiting() if self._commands else ()
        self._which.handle.visible = self._back.visible = bool(waiting)
        self._which.offer(waiting)

    def clear(self) -> None:
        self._bench.uplink.clear()
        if self._ahead is not None:
            self._ahead.forget()

    def _switch(self, client: Any) -> None:
        if client is not None:
            self._bench.commanding(client, self._switched)
            self._over.value = self._bench.uplink.is_used

    def _switched(self) -> str:
        if self._over.value and self._bench.sequences.is_under_way:
            raise GoalError("over the link", "a sequence is under way, which goes round it: abort it first")
        self._bench.uplink.is_used = self._over.value
        return "goals and stops go over the link" if self._over.value else "goals and stops go round the link, at once"

    def _taken_back(self) -> str:
        uplink, which = self._bench.uplink, self._which.chosen
        return uplink.take_back((which,) if which else uplink.waiting())
