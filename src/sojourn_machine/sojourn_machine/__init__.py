"""What a machine is: joints and their drives, supports, tools, battery and loads, mountings. Plain values with units.

Known by the physics and by what would fly; knows neither. No ROS, no clock, no files.
"""

from sojourn_machine.arithmetic import pin

pin()  # before anything loads numpy or numba
