"""The grid of time that everything keeps: stamps, rates, commands and the plant's steps."""

NANOSECONDS = 1_000_000_000
CONTROL_PERIOD_NS = 20_000_000
"""Length of a control period [ns]: 50 Hz. All rates of the contract are integer divisors of it."""
CONTROL_PERIOD_S = CONTROL_PERIOD_NS / NANOSECONDS


def period_stamp(time: float) -> int:
    """Stamp of the first control period at or after a time [s], also of a duration [ns]."""
    return -(-round(time * NANOSECONDS) // CONTROL_PERIOD_NS) * CONTROL_PERIOD_NS
