"""What a replay may be asked for: its roles, and what stands where nothing is asked."""

ROLES_TO_REPLAY = ("plant", "sensors", "drive", "arm", "power")
"""Roles to which a bag can be played."""
PREFIX = "/replay"
"""Of the replayed topics beside the recorded ones."""
DEFAULT_TIMEOUT_S = 10.0
