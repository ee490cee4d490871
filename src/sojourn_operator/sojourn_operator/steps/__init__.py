"""Kinds of steps of a scenario, one a module."""
