"""Sunlight at a machine: what plant, Sun sensor and photovoltaic arrays are told of the Sun."""

from typing import NamedTuple

from sojourn_machine.params import FloatArray


class Sunlight(NamedTuple):
    """Light of the Sun at a place and a moment."""

    direction: FloatArray
    """Unit vector to the Sun in map, shape (3,)."""
    direct: float
    """Of the beam, on a surface square to it, less what is hidden of the disc [W/m2]."""
    diffuse: float
    """From the sky, on level ground [W/m2]."""
    elevation: float
    """Of the disc's centre over the level [rad]."""
    visible: float
    """Part of the disc that is seen, 0 to 1."""
