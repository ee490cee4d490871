"""What stands round a power network for a control period, as far as stores and sources go by it."""

from typing import NamedTuple

import numpy as np

from sojourn_machine.params import FloatArray

UPRIGHT: FloatArray = np.array((0.0, 0.0, 1.0))


class PowerSurroundings(NamedTuple):
    """Light and warmth at the machine."""

    to_sun: FloatArray = -UPRIGHT
    """Unit vector to the Sun in base_link, shape (3,)."""
    direct: float = 0.0
    """Of the Sun's beam, on a surface square to it [W/m2]."""
    diffuse: float = 0.0
    """From the sky, on level ground [W/m2]."""
    up: FloatArray = UPRIGHT
    """Unit vector to the zenith in base_link, shape (3,)."""
    temperature: float | None = None
    """To which stores and sources lose heat [K]; None: that of their own parameters."""
    round_stores: tuple[float | None, ...] = ()
    """The same of each store, where they differ [K]."""


DARK = PowerSurroundings()
