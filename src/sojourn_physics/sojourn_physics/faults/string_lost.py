"""Strings of a battery that are lost: a cell or a joint between two of them is open, and no current flows there.

What is left has its charge, and as much less capacity and as much more resistance (`power.battery`).
"""

from typing import ClassVar

from pydantic import Field

from sojourn_physics.faults.supply import BatteryFault


class StringLost(BatteryFault):
    """See the module."""

    taken: ClassVar[str] = "strings"
    number: ClassVar[str] = "cells_parallel"
    kind: str = "string_lost"
    strings: int = Field(default=1, ge=1, le=1000, description="that are lost [1]")
