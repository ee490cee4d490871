"""The world as it is simulated: no ROS, no clock, no files, no prints. One folder a chapter of the field."""

import sojourn_machine  # noqa: F401 - holds the arithmetic before numpy is loaded
