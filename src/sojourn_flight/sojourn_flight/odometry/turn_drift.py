"""How a machine that turns on a slope goes down it: wheels that slide sideways bear no load beside their slide.

With c = turn_drift_per_grade of its odometry, the way downhill over the angle of a turn on the spot and the sine of the
slope, its velocity at a yaw rate w and a speed v_x is, in base_link,

    c |w| (c w)^2 / ((c w)^2 + v_x^2)   times   (sin pitch, -sin roll):

all of it in a turn on the spot, and little of it on a wide curve, on which wheels roll. Friction opposes the slide as a
whole, so that a load W sin(slope) leans the slide downhill by a part of its speed; that it goes with c |w| is this, and
how it fades on a curve is a fit. c is measured (`sojourn_studies.measure_turn_drift`): 1.6 to 1.9 m/rad on slopes of 2 to
8 degrees with the skid rover, from which the fade is taken, too. Range: slopes well below the angle of friction.
"""

import math


def slid_in_turn(scrubbed: float, v_x: float, roll: float, pitch: float) -> tuple[float, float]:
    """Velocity in base_link [m/s]. scrubbed: c |w| [m/s]."""
    if scrubbed == 0.0:
        return 0.0, 0.0
    rolled = v_x / scrubbed
    speed = scrubbed / (1.0 + rolled * rolled)
    return speed * math.sin(pitch), -speed * math.sin(roll)


def slide_of_turn(drift_per_grade: float, roll: float, pitch: float, yaw: float) -> tuple[float, float]:
    """Way in odom for each radian of a turn on the spot [m/rad], where the machine stands now. drift_per_grade: c."""
    ahead, left = slid_in_turn(drift_per_grade, 0.0, roll, pitch)
    ahead, left = ahead * math.cos(pitch), left * math.cos(roll)
    cosine, sine = math.cos(yaw), math.sin(yaw)
    return cosine * ahead - sine * left, sine * ahead + cosine * left
