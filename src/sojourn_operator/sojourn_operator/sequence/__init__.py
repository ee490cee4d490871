"""Sequences of commands: a file, checked before anything is sent; then a state and a step. No ROS in here."""
