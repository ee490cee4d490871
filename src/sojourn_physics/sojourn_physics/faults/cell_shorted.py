"""Cells of a battery that are shorted inside: each is one less in series, at once.

Of a pack of several strings it is a cell of every string: cells side by side share a short, as in a pack whose strings
are joined between all cells. What was in them is lost, as heat that is not followed.
"""

from typing import ClassVar

from pydantic import Field

from sojourn_physics.faults.supply import BatteryFault


class CellShorted(BatteryFault):
    """See the module."""

    taken: ClassVar[str] = "cells"
    number: ClassVar[str] = "cells_series"
    kind: str = "cell_shorted"
    cells: int = Field(default=1, ge=1, le=1000, description="in series that are shorted [1]")
