"""One of several things that come and go, or all of them."""

from collections.abc import Sequence
from typing import Any

import viser

ALL = "all"


class Choice:
    """A list to choose from. What has been chosen stays so when it has gone, for whoever acts on it to refuse: viser
    would choose the first in its place, which is all of them.

    Args:
        gui: of the page. label: before it. visible: at first.
    """

    def __init__(self, gui: viser.GuiApi, label: str, visible: bool = True) -> None:
        self.handle: Any = gui.add_dropdown(label, (ALL,), visible=visible)

    def offer(self, keys: Sequence[str]) -> None:
        """What there is now."""
        gone = {self.handle.value} - {ALL, *keys}
        options = (ALL, *keys, *gone)
        if tuple(self.handle.options) != options:
            self.handle.options = options

    @property
    def chosen(self) -> str:
        """One of them, there or gone; "" for all."""
        value: str = self.handle.value
        return "" if value == ALL else value
