"""What `scripts/tune` measures of a machine's drive, and the file beside machine.yaml that it is written into."""

from collections.abc import Mapping

MEASURED = "measured.yaml"
"""Stands for what the table `drive` of flight.yaml leaves out."""
UNMEASURED_SLIP: Mapping[str, float] = {"mean_slip": 0.1, "slip_per_grade": 1.0, "side_slip_per_grade": 0.7}
"""Of wheels on loose soil: keys of `drive.odometry` that are measured, and what is taken before that [-]."""
