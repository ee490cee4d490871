"""Simulation time. Stamps are integer nanoseconds since the start; the control period is their grid.

Stamp zero means "before the run" on heartbeats, and "now" on an operator's goal. The first period is stamped
one control period.
"""

from sojourn_machine.timing import CONTROL_PERIOD_NS, CONTROL_PERIOD_S, NANOSECONDS

__all__ = ["CONTROL_PERIOD_NS", "CONTROL_PERIOD_S", "NANOSECONDS"]


def from_cdr(data: bytes) -> int:
    """Stamp [ns] of a serialised message whose first field is a Time or a Header (every one of the
    contract's is).

    The encapsulation header is 4 bytes; its second byte says the byte order (1: little endian).
    """
    order = "little" if data[1] & 1 else "big"
    seconds = int.from_bytes(data[4:8], order, signed=True)  # type: ignore[arg-type]
    return seconds * NANOSECONDS + int.from_bytes(data[8:12], order)  # type: ignore[arg-type]


def seconds(stamp_ns: int) -> float:
    """Stamp [ns] in seconds."""
    return stamp_ns / NANOSECONDS
