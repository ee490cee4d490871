"""A machine to begin with, for somebody who brings his own: its files from a few sizes. See `new_machine`."""
