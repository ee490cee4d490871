"""The closed forms of the field and what tools print: no ROS, no clock, no files."""

import sojourn_machine  # noqa: F401 - holds the arithmetic before numpy is loaded
