"""Faults of the plant: what happens to a machine and its ground, each kind one module."""
