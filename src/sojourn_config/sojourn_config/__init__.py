"""Configuration: YAML and URDF files to validated parameter sets; every problem is told before a start."""

import sojourn_machine  # noqa: F401 - holds the arithmetic before numpy is loaded
