"""Motor and joint as two masses with the gear's play and give between them, for one step of the plant.

    twist x = q_m - q (motor over the gear, joint)
    teeth: dead-band spring of `gear.py`, T = k (x - h) + c x' on one flank, k (x + h) + c x' on the other

with x at the end of the step, so that the stiff spring is implicit. The motor's equation is solved here for the change
of its rate, its torque and friction being linear in it, and put into the joint's: what remains is a torque on the joint
that is linear in the joint's rate, as `joint_drive` wants it:

    J du/dt = R - (s + kt) du + kt dv,   R = torque + friction - T0,   T = T0 + kt (du - dv),   kt = k dt + c
    D = J/dt + s + kt:    T = (T0 + kt R/D) - kt (1 - kt/D) dv

du, dv: changes of the rates of motor and joint in the step. s: slope of the motor's torque and friction.
Assumptions: whether a flank is touched is decided at the start of the step; one stiffness for both flanks.
Range: any stiffness (implicit); what is faster than the step is damped, not resolved.
"""

from sojourn_machine.kernels import kernel


@kernel
def tooth_torque(
    twist: float, twist_rate: float, half_gap: float, stiffness: float, damping: float, dt: float
) -> tuple[float, float]:
    """T0 [N m] and kt [N m s/rad]: torque through the teeth if the rates stay, and its slope. Zero off the flanks."""
    end = twist + dt * twist_rate
    over = max(end - half_gap, 0.0) + min(end + half_gap, 0.0)
    torque = stiffness * over + damping * twist_rate
    if torque * over <= 0.0:  # in the gap, or a flank that would pull
        return 0.0, 0.0
    return torque, stiffness * dt + damping


@kernel
def on_joint(
    drive: float, slope: float, inertia: float, tooth: float, tooth_slope: float, dt: float
) -> tuple[float, float, float, float]:
    """The motor's equation solved.

    Args:
        drive: torque and friction of the motor [N m], of slope `slope` [N m s/rad] (positive: they fall with the rate).
        inertia: of the rotor over the gear [kg m^2]. tooth, tooth_slope: from `tooth_torque`.

    Returns:
        torque on the joint at its present rate [N m] and its slope [N m s/rad]; change of the motor's rate if the
        joint's stays [rad/s], and the part of a change of the joint's rate that the motor takes on [-].
    """
    give = inertia / dt + slope + tooth_slope
    change, share = (drive - tooth) / give, tooth_slope / give
    return tooth + tooth_slope * change, tooth_slope * (1.0 - share), change, share
