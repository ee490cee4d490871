"""Where a bed for tests of single wheels stands, if nothing else is said."""

GRAVITY = 9.80665
"""On Earth [m/s^2]."""
