"""What a dragged wheel does to the slip estimate, and what a slip means for a goal that gets nowhere.

Where a function takes `slip_error`, it is what the camera has found the way to be shorter than was told, over it [-].
"""

from sojourn_flight.odometry.slip_estimation import SlipModel, SlipState
from sojourn_flight.odometry.slip_status import further_slip, is_stuck, trouble

DRAGGING_SIGMA = 0.5
"""Part of the way over ground that is not known while a wheel without its motor is dragged along: the torques of the
others tell what they pull, not what it holds back [-]."""


UNSURE = 0.3
"""A slip with a greater standard deviation decides nothing [-]: of wheels that slow down after a long climb the
estimate may come to any."""


def dragging(found: SlipState) -> SlipState:
    """The slip of a machine that drags a wheel without its motor along."""
    return found._replace(sigma=max(found.sigma, DRAGGING_SIGMA * (1.0 - found.shared)))


def counted_slip(slip: SlipState | None, slip_error: float, least_pace: float) -> float | None:
    """Slip of the machine, with what the camera has found of it; None of wheels slower than `least_pace` [m/s], and
    where it is not known well.
    """
    if slip is None or slip.standing_for > 0.0 or slip.pace < least_pace or slip.sigma > UNSURE:
        return None
    return further_slip(slip.shared, slip_error)


def no_headway(model: SlipModel | None, slip: SlipState | None, slip_error: float, names: tuple[str, ...]) -> str:
    """Why a goal cannot be pursued any longer, in words; empty where it can.

    A wheel that spins does not end it while the machine gets on, as one with a dead motor does with much slip; nor does
    a slip that is not known well: then the follower's time-out does.
    """
    if model is None or slip is None or slip.sigma > UNSURE or not is_stuck(model.params, slip):
        return ""
    if further_slip(slip.shared, slip_error) < model.params.stuck_slip:
        return ""
    return trouble(model.params, slip, names)
