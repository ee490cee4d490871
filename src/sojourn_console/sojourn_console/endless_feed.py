"""A bag that begins anew when it is over, while its time goes on: a run without an end, for endurance."""

from sojourn_console.bag_feed import BagFeed
from sojourn_console.feed import FeedMessage


class EndlessFeed(BagFeed):
    """As a bag that is played. Messages keep their own stamps; the time at which they come goes on."""

    laps = 0
    """So often it has begun anew."""

    def advance(self, wall_s: float) -> None:
        """So much wall time is over [s]."""
        super().advance(wall_s)
        if not self.is_playing:
            self.now, self.is_playing = self.begin, True
            self._said.clear()
            self.laps += 1

    def poll(self) -> list[FeedMessage]:
        offset = self.laps * (self.end - self.begin)
        return [one._replace(time=one.time + offset) for one in super().poll()]
