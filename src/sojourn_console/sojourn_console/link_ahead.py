"""The windows of a link, seen ahead: whether it is open over the machine, and when that changes.

It goes by the scenario, as those do who plan passes: by its times, orbits and the ephemeris of the Earth. Windows tell
for how long at least they stay as they are, for an ephemeris 10 s; the search goes on from there, some looks at a time,
so that no one look of the page waits for it.
"""

from datetime import UTC, datetime, timedelta

from sojourn_contract.stamps import NANOSECONDS, seconds
from sojourn_physics.link.params import LinkParams
from sojourn_physics.link.window import NEVER, AnyOf, Sky

LOOKS = 40
"""At a time."""
FARTHEST = 60 * 86_400 * NANOSECONDS
"""It is looked ahead so far at most [ns]."""
MOVED = 50.0
"""A machine that has gone so far sees another horizon [m]."""


class LinkAhead:
    """Of one run.

    Args:
        link: as the scenario has it. sky: over the site. begin: date of the start of the run, where it has one.

    Raises:
        InvalidValueError: a window does not fit the site.
    """

    def __init__(self, link: LinkParams, sky: Sky, begin: datetime | None = None) -> None:
        self._sky, self._light_time_s = sky, link.light_time_s
        self.link, self._begin = link, begin
        self._windows = AnyOf([window.build(self._sky) for window in link.windows])
        self.is_open = False
        self.changes_at: int | None = None
        """When it is not so any more [ns]; None as long as that is not known."""
        self.is_over = False
        """Whether the search is over."""
        self._at: int | None = None
        self._place = (0.0, 0.0)

    def light_time_s(self, now: int) -> float:
        """One way, at a time [ns]."""
        if self._light_time_s is None and self._sky.earth is not None:
            return self._sky.earth.light_time(now / NANOSECONDS)
        return self._light_time_s or 0.0

    def look(self, now: int, x: float, y: float) -> None:
        """Search on from a time [ns] for a machine at (x, y) in map [m]."""
        moved = max(abs(x - self._place[0]), abs(y - self._place[1])) > MOVED
        if self._at is None or moved or (self.changes_at is not None and now >= self.changes_at):
            self.forget()
            self._place = x, y
            self.is_open, self._at = self._windows.at(now, x, y)
        for _ in range(LOOKS):
            if self.is_over:
                return
            if self._at >= NEVER or self._at - now > FARTHEST:
                self.is_over = True
                return
            is_open, until = self._windows.at(self._at, *self._place)
            if is_open != self.is_open:
                self.changes_at, self.is_over = self._at, True
            else:
                self._at = until

    def lasts(self, now: int) -> int:
        """For how long at least it stays as it is from a time on, as far as has been looked [ns]."""
        return max((self._at or now) - now, 0)

    def date(self, time: int) -> str:
        """Of a time of the run [ns], in UTC; empty where the run has none."""
        if self._begin is None:
            return ""
        return f"{self._begin.astimezone(UTC) + timedelta(seconds=seconds(time)):%Y-%m-%d %H:%M:%S} UTC"

    def forget(self) -> None:
        """Time has jumped."""
        self._at = self.changes_at = None
        self.is_over = False
