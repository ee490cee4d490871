"""The physics of Sojourn: no ROS, no clock, no files, no prints. One folder a chapter of the field."""

from sojourn_mechanics.kernel_cache import use_versioned_cache

use_versioned_cache()
