"""What would fly: it knows the machine and what it measures, never the truth. No ROS, no clock, no files."""

import sojourn_machine  # noqa: F401 - holds the arithmetic before numpy is loaded
