"""What joints to spare may be for, by name."""

from typing import Literal

SecondaryTask = Literal["centred", "manipulability", "clear"]
"""Joints near the middle of their ranges; manipulability; distance from obstacles."""
