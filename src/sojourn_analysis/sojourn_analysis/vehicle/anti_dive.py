"""Anti-dive and anti-squat: how much of the load transfer the suspension's links carry instead of its springs.

Seen from the side, a suspension turns about an instant centre, ahead of or behind its wheel by d and above the ground
by e (for an outboard brake or a hub motor, whose torque the links feel; e is taken above the wheel's centre for a
driveshaft or an inboard brake). A part k of the longitudinal force acts at this axle, load transfer is m a h/l:

    anti-dive of the front (brakes)       k (e/d) l/h          1 is "100 %": no dive at all
    anti-lift of the rear (brakes)        (1 - k) (e/d) l/h
    anti-squat of the rear (drive)        (e/d) l/h of the part that drives there
    change of an axle's spring force      (m a h/l) (1 - anti)
    pitch angle (nose down)               m a h/l [(1 - a_f)/k_f + (1 - a_r)/k_r]/l
(Gillespie 1992, ch. 7; Milliken and Milliken 1995, sec. 17.) Assumptions: quasi-static, small travel, force at the
ground.
"""

from sojourn_machine.errors import InvalidValueError


def anti_fraction(force_share: float, rise: float, run: float, wheelbase: float, height: float) -> float:
    """Part of the load transfer of an axle that its links carry [-]; 1 is all, negative makes the motion larger.

    Args:
        force_share: part of the longitudinal force at this axle [-]. rise, run: height and distance of the instant
        centre [m];
            the run is positive towards the other axle. wheelbase, height: of the vehicle [m].
    """
    if run == 0.0:
        raise InvalidValueError("run", run, "a distance that is not 0 m")
    if not (wheelbase > 0.0 and height > 0.0):
        raise InvalidValueError("wheelbase, height", (wheelbase, height), "more than 0 m")
    if not 0.0 <= force_share <= 1.0:
        raise InvalidValueError("force_share", force_share, "0 to 1")
    return force_share * rise / run * wheelbase / height


def pitch_under(
    acceleration: float,
    mass: float,
    wheelbase: float,
    height: float,
    rates: tuple[float, float],
    anti: tuple[float, float] = (0.0, 0.0),
) -> float:
    """Steady pitch [rad], nose up positive, under an acceleration [m/s^2] (negative: braking).

    Args:
        rates: of front and rear axle, both wheels [N/m]. anti: fractions of front and rear.
    """
    transfer = mass * acceleration * height / wheelbase
    return transfer * ((1.0 - anti[0]) / rates[0] + (1.0 - anti[1]) / rates[1]) / wheelbase
