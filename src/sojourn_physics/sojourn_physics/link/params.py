"""The link to Earth as a scenario says it."""

import math
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.chance import stream_of
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.site import SiteParams, site_frame
from sojourn_physics.environment.sun.earth_path import EarthPath
from sojourn_physics.environment.sun.instant import instant
from sojourn_physics.environment.sun.over import SunOver
from sojourn_physics.environment.sun.path import SunParams
from sojourn_physics.link.channel import Channel
from sojourn_physics.link.window import LinkWindow, Sky

LONGEST = 1e8


class LinkChannelParams(Params):
    """One direction."""

    bit_s: float | None = Field(default=None, gt=0.0, le=1e12, description="bandwidth [bit/s]; none: no limit")
    loss: float = Field(default=0.0, ge=0.0, le=1.0, description="share of messages that do not arrive [1]")

    def channel(self, seed: int, name: str) -> Channel:
        """The channel of a run's seed. name: of the direction."""
        return Channel(math.inf if self.bit_s is None else self.bit_s, self.loss, stream_of(seed, f"link {name}"))


class TelemetryParams(Params):
    """A topic of which the Earth hears."""

    topic: str = Field(pattern=r"^/", description="name in the topic table, one that comes at a rate")
    priority: int = Field(default=5, ge=1, le=9, description="1 goes first; acknowledgements go before all")
    keep: int = Field(default=1, ge=1, le=1000, description="messages that may wait; the oldest are dropped")
    every_s: float = Field(default=0.0, ge=0.0, le=LONGEST, description="shortest time from one to the next [s]")


STATUSES = ("/drive/status", "/arm/status", "/power/status", "/battery_state")
"""Of which the Earth hears where nothing else is said, as far as a run has them."""


class LinkParams(Params):
    """What stands between operators on Earth and a machine."""

    light_time_s: float | None = Field(
        default=None, ge=0.0, le=LONGEST, description="one way [s]; none: by the ephemeris, with a site and a date"
    )
    up: LinkChannelParams = Field(default_factory=LinkChannelParams, description="to the machine")
    down: LinkChannelParams = Field(default_factory=LinkChannelParams, description="to the Earth")
    expires_s: float | None = Field(
        default=None, gt=0.0, le=LONGEST, description="time in which a command has to arrive [s]; none: it may wait"
    )
    windows: tuple[LinkWindow, ...] = Field(
        default=(), description="when it is open: while one of them is; none: always"
    )
    telemetry: tuple[TelemetryParams, ...] | None = Field(
        default=None, description="what goes to the Earth; none: the statuses and the batteries"
    )

    @model_validator(mode="after")
    def _each_topic_once(self) -> Self:
        names = [one.topic for one in self.telemetry or ()]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"telemetry: {name} stands there twice: allowed is each topic once")
        return self

    def sky(self, body: BodyParams, site: SiteParams | None, sun: SunParams, over: SunOver | None = None) -> Sky:
        """What is over a site, as far as it is known. over: knows how high the ground stands there."""
        frame = None if site is None else site_frame(site, body.semi_axes)
        earth = None
        if frame is not None and sun.time is not None and (self.light_time_s is None or self.windows):
            try:
                earth = EarthPath(body.name, frame, instant(sun.time.timestamp()))
            except InvalidValueError:
                if self.light_time_s is None:
                    raise
        return Sky(body, frame, earth, over)

    def check(self, sky: Sky) -> None:
        """Raise InvalidValueError for what does not fit a site: with `name` the key."""
        if self.light_time_s is None and sky.earth is None:
            raise InvalidValueError("light_time_s", None, "a time, or a site with a date (sun.time): an ephemeris")
        for place, window in enumerate(self.windows):
            try:
                window.build(sky)
            except InvalidValueError as error:
                raise InvalidValueError(f"windows.{place}.{error.name}", error.value, error.allowed) from error
