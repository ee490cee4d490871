"""The time line of a bag: play, stand still, step, go anywhere, faster or slower."""

from typing import Any, ClassVar

from sojourn_console.bag_feed import BagFeed
from sojourn_console.model import RunScene
from sojourn_console.panels.panel import QuietPanel, Workbench

SPEEDS = {"1/4×": 0.25, "1×": 1.0, "2×": 2.0, "5×": 5.0, "20×": 20.0}


class TimeLinePanel(QuietPanel):
    """Of a bag.

    Args:
        bench: what it works on. feed: the bag.
    """

    title: ClassVar[str] = ""

    def __init__(self, bench: Workbench, feed: BagFeed) -> None:
        self._bench, self._feed = bench, feed
        gui = bench.server.gui
        begin, end = feed.begin * 1e-9, max(feed.end, feed.begin + 1_000_000_000) * 1e-9
        self._slider: Any = gui.add_slider("Time [s]", begin, end, 0.02, begin)
        self._buttons = gui.add_button_group("Play", ("▶ / ❚❚", "◀ step", "step ▶"))
        self._speed = gui.add_dropdown("Speed", tuple(SPEEDS), initial_value="1×")
        self._told = begin
        self._slider.on_update(lambda event: self._slid(event.client is not None))
        self._buttons.on_click(lambda _: self._pressed())
        self._speed.on_update(lambda _: self._hastened())

    def show(self, scene: RunScene) -> None:
        now = round(self._feed.now * 1e-9, 2)
        if abs(now - self._told) >= 0.2 or (not self._feed.is_playing and now != self._told):
            self._told = now
            self._slider.value = now

    def _slid(self, by_hand: bool) -> None:
        if by_hand and self._slider.value != self._told:
            with self._bench.lock:
                self._told = self._slider.value
                self._feed.jump(round(self._slider.value * 1e9))

    def _pressed(self) -> None:
        with self._bench.lock:
            if self._buttons.value == "▶ / ❚❚":
                if self._feed.now >= self._feed.end:
                    self._feed.jump(self._feed.begin)
                    self._feed.is_playing = True
                else:
                    self._feed.is_playing = not self._feed.is_playing
            else:
                self._feed.step(1 if self._buttons.value == "step ▶" else -1)

    def _hastened(self) -> None:
        with self._bench.lock:
            self._feed.speed = SPEEDS[self._speed.value]
