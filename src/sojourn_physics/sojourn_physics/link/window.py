"""When a link is open: kinds of windows, found by their names, and the sky that they look at.

A kind is one module: parameters derived from `WindowChoice` that make a `Window` for a site. It is registered by an
entry point of the group `sojourn.link_windows` under the name that a file says as `kind`. All times are simulation
time where the machine is: what comes from the Earth has to arrive in a window, and what goes there to leave in one.
"""

import math
from collections.abc import Sequence
from typing import Annotated, NamedTuple, Protocol, TypeAlias

import numpy as np
from pydantic import Field, SerializeAsAny

from sojourn_machine.choice import kinds_of
from sojourn_machine.params import FloatArray, Params
from sojourn_machine.registry import Registry
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.site import SiteFrame
from sojourn_physics.environment.sun.earth_path import EarthPath
from sojourn_physics.environment.sun.over import SunOver

WINDOWS: "Registry[type[WindowChoice]]" = Registry("sojourn.link_windows", "kind of window")
"""Parameter sets of the kinds of windows, by their names."""
NEVER = 2**62
"""A time later than all others [ns]."""


class Sky(NamedTuple):
    """What is over a site. None: not known, as a date or a site is missing."""

    body: BodyParams
    frame: SiteFrame | None = None
    earth: EarthPath | None = None
    sun: SunOver | None = None
    """Which knows how high the ground stands before the sky."""

    def is_over_horizon(self, towards: FloatArray, x: float, y: float, least: float) -> bool:
        """Whether what stands in a direction of map, shape (3,), of any length, is seen from (x, y) in map [m].

        Args:
            least: elevation over the level that it has besides [rad].
        """
        east, north, up = towards.tolist()
        elevation = math.atan2(up, math.hypot(east, north))
        if elevation < least or self.sun is None:
            return elevation >= least
        azimuth = math.atan2(east, north)
        return elevation >= float(self.sun.horizon(x, y, np.array((azimuth,)))[0])


class Window(Protocol):
    """When a link is open, for a machine that stands at (x, y) in map [m]."""

    def at(self, time: int, x: float, y: float) -> tuple[bool, int]:
        """Whether it is open at a time [ns], and until when that stays as it is at least, later than that time [ns]."""
        ...


class WindowChoice(Params):
    """One window, or a row of them. Each kind has a subclass with its words, whose default of `kind` is its name."""

    kind: str = Field(description="kind of window")

    def build(self, sky: Sky) -> Window:
        """The windows of a site. Raises InvalidValueError for one that lacks what they go by."""
        raise NotImplementedError


LinkWindow: TypeAlias = Annotated[SerializeAsAny[WindowChoice], *kinds_of(WINDOWS, "kind")]
"""A field that is a window of any kind."""


class AnyOf:
    """Open while one of several is, and always where there is none."""

    def __init__(self, windows: Sequence[Window]) -> None:
        self._windows = tuple(windows)

    def at(self, time: int, x: float, y: float) -> tuple[bool, int]:
        """See Window."""
        if not self._windows:
            return True, NEVER
        found = [window.at(time, x, y) for window in self._windows]
        until = [end for is_open, end in found if is_open]
        return (True, max(until)) if until else (False, min(end for _, end in found))


def on_grid(time: int, every: int) -> tuple[int, int]:
    """The multiples of a duration [ns] before a time, or at it, and after it [ns]."""
    begin = time // every * every
    return begin, begin + every
