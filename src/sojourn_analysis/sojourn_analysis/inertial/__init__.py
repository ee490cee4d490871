"""Curves of inertial sensors: what a data sheet says, what the model has, what a record shows."""
