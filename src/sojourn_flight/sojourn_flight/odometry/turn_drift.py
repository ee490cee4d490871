"""How a machine that turns on a slope goes down it: wheels that slide sideways bear no load beside their slide.

With c = turn_drift_per_grade of its odometry, the way downhill over the angle of a turn on the spot and the sine of the
slope, it goes at a yaw rate w and a speed v_x with

    c |w| (c w)^2 / ((c w)^2 + v_x^2)   times   d,        d = (sin pitch, -sin roll) turned into odom:

all of it in a turn on the spot, and little of it on a wide curve, on which wheels roll. Friction opposes the slide as a
whole, so that a load W sin(slope) leans the slide downhill by a part of its speed; that it goes with c |w| is this, and
how it fades on a curve is a fit. c is measured (`sojourn_studies.measure_turn_drift`): 1.6 to 1.9 m/rad on slopes of 2
to 8 degrees with the skid rover, from which the fade is taken, too. Range: slopes well below the angle of friction.

d is that of the ground over which it has come (`SLOPE_LENGTH`), and stays while it turns: a body on springs, or one
whose wheels dig in, leans in a turn though its ground is level (Lunokhod by three degrees).
"""

import math
from typing import TypeAlias

from sojourn_flight.odometry.attitude import turned_in_plane

Downhill: TypeAlias = tuple[float, float]
"""Sines of the slope along x and y of odom, positive downhill [-]."""
SLOPE_LENGTH = 0.5
"""Way over which the slope of the ground is smoothed [m]."""


def downhill_of(roll: float, pitch: float, yaw: float) -> Downhill:
    """Of a machine that leans as its ground does [rad]."""
    return turned_in_plane(math.sin(pitch), -math.sin(roll), yaw)


def smoothed(before: Downhill, now: Downhill, way: float) -> Downhill:
    """After a way [m] on which the machine has leaned so."""
    part = way / (way + SLOPE_LENGTH)
    return before[0] + part * (now[0] - before[0]), before[1] + part * (now[1] - before[1])


def slid_in_turn(scrubbed: float, v_x: float, downhill: Downhill, yaw: float) -> tuple[float, float]:
    """Velocity in base_link [m/s]. scrubbed: c |w| [m/s]. yaw: in odom."""
    if scrubbed == 0.0:
        return 0.0, 0.0
    rolled = v_x / scrubbed
    speed = scrubbed / (1.0 + rolled * rolled)
    ahead, left = turned_in_plane(*downhill, -yaw)
    return speed * ahead, speed * left
