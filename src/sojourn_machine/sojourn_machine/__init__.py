"""What a machine is: joints and their drives, supports, tools, battery and loads, mountings. Plain values with units.

Known by the physics and by what would fly; knows neither. No ROS, no clock, no files.
"""

from sojourn_machine.arithmetic import pin

pin()  # before anything loads numpy

import numba  # noqa: E402

from sojourn_machine.kernel_cache import use_versioned_cache  # noqa: E402

numba.config.reload_config()  # here, or one that was there before us would at its next compilation, and lose the folder
use_versioned_cache()
