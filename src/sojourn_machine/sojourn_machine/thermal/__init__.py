"""The thermal network of a machine: nodes, conductors, heaters, and its step."""
