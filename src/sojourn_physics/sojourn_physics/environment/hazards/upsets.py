"""How often cosmic rays turn over a bit of memory.

    R = 200 sigma / L^2 upsets a bit and day,   here scaled by the absorbed dose over that between the planets

sigma the saturated cross-section of a bit for heavy ions [cm2], L the linear energy transfer at which a quarter of it
is reached [MeV cm2/mg]. The constant is of a geostationary orbit in the minimum of the Sun's activity, behind 2.5 mm of
aluminium. Source: Petersen 1998, IEEE Trans. Nucl. Sci. 45:2550 (figure of merit). Good to a factor of about 3; scaling
by the dose is an estimate: upsets go with the heavier nuclei, which air and ground take out first.
"""

from typing import NamedTuple

from sojourn_physics.environment.hazards.radiation import INTERPLANETARY

_PER_BIT_DAY = 200.0


class MemoryPart(NamedTuple):
    """A memory as the beam test of its part number describes it. The default: a static RAM hardened by design."""

    bits: float = 2e9
    cross_section: float = 1e-8
    """Saturated, of one bit [cm2]."""
    quarter_transfer: float = 15.0
    """Linear energy transfer at a quarter of it [MeV cm2/mg]."""


def upsets_per_day(part: MemoryPart, absorbed: float) -> float:
    """Expected upsets of a whole memory in a day where so much dose is absorbed [uGy/day]."""
    merit = part.cross_section / part.quarter_transfer**2
    return _PER_BIT_DAY * merit * part.bits * absorbed / INTERPLANETARY.absorbed
