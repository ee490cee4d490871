"""Friction that remembers: bristles between wheel and ground, bent along, across and by a twist.

Displacements u = (u_x, u_y) of the bristles and their twist ψ about the normal (r_ψ u: arm r times ψ),
with the slip velocity w of the wheel's lowest point over the ground and the rate of yaw ω:

    du_x/dt = w_x - V u_x/λ_x,   du_y/dt = w_y - V u_y/λ_y,   dψ/dt = -ω - V ψ/λ_y,   V = |r_e ω_wheel|
    ξ = (k_x u_x, k_y u_y, k_y r ψ)/(3 μ N),   x = min(|ξ|, 1)
    (F_x, F_y, M_z/r) = μ N (3 x - 3 x² + x³) ξ/|ξ|

(Fromm 1941 and Pacejka 2012, Tire and Vehicle Dynamics, ch. 3, for the brush; ch. 7 for the relaxation
lengths λ; the ellipsoid of force and moment: Howe & Cutkosky 1996, Int. J. Robotics Research 15:557). In
steady rolling u/λ is the theoretical slip, and k λ the slip stiffness; at rest nothing of u is given up, so
that what is parked stays parked. Beyond full sliding, |ξ| = 1, bristles slip and are not bent further: only
what they store can come back.

Near rest the rate of bending leads the displacement (as in `shear_memory`), which damps the swing of a parked
machine; in steady rolling nothing bends, and it adds nothing. With k_x = k_y the force is the gradient of a
convex potential of u: no motion takes energy out of it.
"""

import math
from typing import NamedTuple

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.contact_law import StateColumn
from sojourn_physics.contact.shear_memory import LEAD_SPEED

BRISTLE_LEAD = 0.02
"""Time by which the rate leads the displacement of bristles at rest [s]: shorter than in soil, for they are
stiffer and damp less (estimate)."""


class Sliding(NamedTuple):
    """Motion of a wheel's lowest point over the ground."""

    along: float
    """w_x [m/s]."""
    side: float
    """w_y [m/s]."""
    yaw_rate: float
    """ω [rad/s]."""
    rim_speed: float
    """At which the contact is renewed, V without its sign [m/s]."""


class Bristles(NamedTuple):
    """What a contact's bristles bear."""

    stiffness_x: float
    """k_x [N/m]."""
    stiffness_y: float
    arm: float
    """r, of the twist [m]."""
    limit: float
    """μ N [N]."""
    relaxation_x: float
    """λ_x, more than 0 [m]."""
    relaxation_y: float


@kernel
def bristle_lead(speed: float) -> float:
    """Lead [s] at a speed of the rim [m/s]."""
    ratio = speed / LEAD_SPEED
    return BRISTLE_LEAD / (1.0 + ratio * ratio)


@kernel
def bristle_forces(
    sliding: Sliding, bristles: Bristles, dt: float, state: FloatArray
) -> tuple[float, float, float, float]:
    """Advance the bristles by dt [s] and give their force.

    Returns:
        F_x, F_y [N], M_z [N m], and x, the part of full sliding (0..1).
    """
    arm, limit = bristles.arm, bristles.limit
    if limit <= 0.0:
        state[StateColumn.SHEAR_ALONG] = state[StateColumn.SHEAR_SIDE] = state[StateColumn.TWIST] = 0.0
        return 0.0, 0.0, 0.0, 0.0
    speed = abs(sliding.rim_speed)
    u_x = (state[StateColumn.SHEAR_ALONG] + dt * sliding.along) / (1.0 + dt * speed / bristles.relaxation_x)
    u_y = (state[StateColumn.SHEAR_SIDE] + dt * sliding.side) / (1.0 + dt * speed / bristles.relaxation_y)
    twist = (state[StateColumn.TWIST] - dt * sliding.yaw_rate) / (1.0 + dt * speed / bristles.relaxation_y)
    scale_x, scale_y = bristles.stiffness_x / (3.0 * limit), bristles.stiffness_y / (3.0 * limit)
    bent = math.sqrt((scale_x * u_x) ** 2 + scale_y * scale_y * (u_y * u_y + (arm * twist) ** 2))
    if bent > 1.0:
        u_x, u_y, twist = u_x / bent, u_y / bent, twist / bent
    ahead = bristle_lead(speed) / dt
    xi_x = scale_x * (u_x + ahead * (u_x - state[StateColumn.SHEAR_ALONG]))
    xi_y = scale_y * (u_y + ahead * (u_y - state[StateColumn.SHEAR_SIDE]))
    xi_z = scale_y * arm * (twist + ahead * (twist - state[StateColumn.TWIST]))
    state[StateColumn.SHEAR_ALONG], state[StateColumn.SHEAR_SIDE], state[StateColumn.TWIST] = u_x, u_y, twist
    x = math.sqrt(xi_x * xi_x + xi_y * xi_y + xi_z * xi_z)
    gain = limit * (3.0 - 3.0 * x + x * x) if x < 1.0 else limit / x
    return gain * xi_x, gain * xi_y, gain * xi_z * arm, min(x, 1.0)
