"""How large the machine is: what was asked for, the rest in the proportions of the rovers of config/machines."""

from dataclasses import dataclass

from sojourn_config.command_errors import UsageError

SMALLEST_MASS, LARGEST_MASS = 3.0, 5000.0
"""[kg]"""
SPEED_PER_WHEELBASE = 0.3
"""Of the derived limits, see `derived_flight` [1/s]."""


@dataclass(frozen=True)
class SizeWanted:
    """What was asked for; None: in proportion. Lengths [m], mass [kg]."""

    mass: float = 60.0
    wheel_radius: float | None = None
    wheel_width: float | None = None
    wheelbase: float | None = None
    track: float | None = None


@dataclass(frozen=True)
class StarterSize:
    """Of the machine.

    Args:
        axles: with two wheels each; one for two tracks. mass: [kg]. radius, width: of a wheel, or of the
            sprocket and the track [m]. wheelbase: from the first to the last axle, the flat run of a track [m].
        track: between the middles of the wheels of an axle [m]. gravity: that it is sized for [m/s^2].
    """

    axles: int
    mass: float
    radius: float
    width: float
    wheelbase: float
    track: float
    gravity: float

    @property
    def wheels(self) -> int:
        """How many things it rolls on."""
        return 2 * self.axles

    @property
    def load(self) -> float:
        """Weight on a wheel [N]."""
        return self.mass * self.gravity / self.wheels

    @property
    def axle_places(self) -> tuple[float, ...]:
        """Of each axle ahead of the last one, the first first [m]."""
        gap = self.wheelbase / max(self.axles - 1, 1)
        return tuple(gap * (self.axles - 1 - axle) for axle in range(self.axles))

    @property
    def rim_rate(self) -> float:
        """Largest rate of a drive joint: twice what the limit of speed, that follows from the wheelbase, asks for
        [rad/s].
        """
        return 2.0 * SPEED_PER_WHEELBASE * self.wheelbase / self.radius


def sized(wanted: SizeWanted, axles: int, gravity: float, on_tracks: bool) -> StarterSize:
    """The whole size. Raises UsageError for one that no such machine can have.

    Proportions: wheels of 0.18 m under 60 kg as on the skid rover, by the cube root of the mass; the sprocket of the
    tracked rover is 0.1 m under 120 kg.
    """
    if not SMALLEST_MASS <= wanted.mass <= LARGEST_MASS:
        raise UsageError(f"--mass {wanted.mass:g}: allowed is {SMALLEST_MASS:g} to {LARGEST_MASS:g} kg")
    scale = (wanted.mass / 60.0) ** (1.0 / 3.0)
    radius = wanted.wheel_radius or round((0.08 if on_tracks else 0.18 if axles < 4 else 0.14) * scale, 3)
    width = wanted.wheel_width or round((1.6 if on_tracks else 0.7) * radius, 3)
    apart = 7.0 if on_tracks else 3.3 if axles == 2 else 2.6
    wheelbase = wanted.wheelbase or round(apart * radius * max(axles - 1, 1), 3)
    track = wanted.track or round(max(wheelbase, 3.1 * radius, 2.5 * width), 3)
    size = StarterSize(axles, wanted.mass, radius, width, wheelbase, track, gravity)
    _check(size, on_tracks)
    return size


def _check(size: StarterSize, on_tracks: bool) -> None:
    """Whether its wheels have room."""
    gaps = max(size.axles - 1, 1)
    if size.wheelbase / gaps < 2.2 * size.radius:
        least = 2.2 * size.radius * gaps
        what = "the flat run is shorter than its wheels" if on_tracks else "neighbouring wheels would touch"
        raise UsageError(f"--wheelbase {size.wheelbase:g}: {what}, allowed is at least {least:.3g} m")
    if size.track < 1.5 * size.width + 0.05:
        least = 1.5 * size.width + 0.05
        raise UsageError(f"--track {size.track:g}: no room for a body between the wheels, allowed is {least:.3g} m")
    height = 1.8 * size.radius
    if size.track < 2.0 * height / 1.5:
        raise UsageError(
            f"--track {size.track:g}: it would tip over on wheels of {size.radius:g} m, "
            f"allowed is at least {2.0 * height / 1.5:.3g} m"
        )
