"""Configuration: YAML and URDF files to validated parameter sets; every problem is told before a start."""
