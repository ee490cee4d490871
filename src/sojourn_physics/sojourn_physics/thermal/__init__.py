"""Heat of the ground: temperatures of regolith over depth and day."""
