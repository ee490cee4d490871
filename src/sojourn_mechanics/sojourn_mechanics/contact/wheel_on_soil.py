"""Rigid wheel on deformable soil: stresses under the rim, integrated to forces (Wong-Reece, Janosi-Hanamoto).

Angles θ run along the rim from the contact normal, positive towards the direction of travel; θ1 is the entry,
θ2 the exit, θm the angle of greatest normal stress. With h(θ) = r (cos θ - cos θ1):

    σ(θ) = k h^n            for θm <= θ <= θ1, k = k_c/b + k_φ (Bekker form) or (k_c + b k_φ)/b^n (Reece form)
    σ(θ) = σ(θ'),  θ' = θ1 - (θ - θ2)(θ1 - θm)/(θm - θ2)     for θ2 <= θ < θm
    θm = (c1 + c2 s) θ1;  θ2 = 0, or θ2 = -acos(1 - λ z / r)
    τ = (c + σ tan φ)(1 - exp(-J)),  J^2 = (jx/Kx)^2 + (jy/Ky)^2, directed along (jx/Kx, jy/Ky)
    F_x = b ∫ (r_s τx cos θ - r σ sin θ) dθ,  F_z = b ∫ (r_s τx sin θ + r σ cos θ) dθ,  F_y = b r_s ∫ τy dθ,
    T = b r_s² ∫ τx dθ
    (Wong & Reece 1967, J. Terramechanics 4(1):81 and 4(2):7; Janosi & Hanamoto 1961; lateral stress as in
    Ishigami et al. 2007, J. Field Robotics 24(3):233, with one friction limit for both directions, not two.)

Shear displacement of steady rolling, slip s = (rω - v)/max(rω, v), lateral slip s_y = -v_y/max(rω, v):

    jx = r_s { [(θ1-θ) - (sin θ1 - sin θ)] + max(s,0)(sin θ1 - sin θ) + min(s,0)(θ1-θ) }
    jy = r_s s_y (θ1-θ)

which is Wong and Reece's integral for s >= 0, and stays finite down to the locked wheel, s = -1,
where a soil particle is sheared by the length of rim that has passed over it. r_s = r + grouser height:
behind grousers the soil shears on soil, on the circle through their tips.

D in -1..1 is the memory of the direction of travel (see `contact_set`): at D = 0 the wheel has been pressed
straight down, and the contact is symmetric, θ2 = -θ1, θm = 0 (static sinkage; Ishigami 2007 eq. 9), and all
of it has been sheared by the same displacement, jx = s L, jy = s_y L, L = 2 r sin θ1; at |D| = 1 it is the
rolling contact above. Both are blended linearly in |D|.

Assumes homogeneous soil, a plane ground over the length of one contact, and quasi-static stress. Valid for
sinkage up to about 0.7 r. Quadrature: Gauss-Legendre on each side of θm.
"""

import math

import numpy as np
from numba import njit

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.soil.params import SoilColumn
from sojourn_mechanics.soil.pressure_sinkage import sinkage_modulus

MAX_ENTRY_ANGLE = 1.4
"""Largest entry angle that is integrated [rad]; deeper contact goes on linearly in the sinkage."""
QUADRATURE_POINTS = 6
"""Points on each side of the angle of greatest stress; test_wheel_on_soil states the error."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(QUADRATURE_POINTS)
# On (0, 1), half the weight of the usual (-1, 1).
NODES: FloatArray = np.ascontiguousarray(0.5 * (_NODES + 1.0))
WEIGHTS: FloatArray = np.ascontiguousarray(0.5 * _WEIGHTS)

_FORM = int(SoilColumn.FORM)
_N = int(SoilColumn.N)
_K_C = int(SoilColumn.K_C)
_K_PHI = int(SoilColumn.K_PHI)
_COHESION = int(SoilColumn.COHESION)
_TAN_PHI = int(SoilColumn.TAN_PHI)
_K_X = int(SoilColumn.SHEAR_MODULUS_LONGITUDINAL)
_K_Y = int(SoilColumn.SHEAR_MODULUS_LATERAL)
_C1 = int(SoilColumn.THETA_M_C1)
_C2 = int(SoilColumn.THETA_M_C2)
_LAMBDA = int(SoilColumn.EXIT_LAMBDA)
_K_X_SLOPE = int(SoilColumn.SHEAR_MODULUS_LONGITUDINAL_PER_SLIP_ANGLE)
_K_Y_SLOPE = int(SoilColumn.SHEAR_MODULUS_LATERAL_PER_SLIP_ANGLE)


@njit(cache=True)
def pressure_modulus(soil: FloatArray, width: float) -> float:
    """k of p = k z^n under a plate or wheel of `width` [m], in N/m^(n+2).

    Zero where a negative k_c outweighs k_phi.
    """
    modulus: float = sinkage_modulus(soil[_FORM], soil[_N], soil[_K_C], soil[_K_PHI], width)
    return max(modulus, 0.0)


@njit(cache=True)
def contact_angles(
    radius: float, sinkage: float, slip: float, rolling: float, soil: FloatArray
) -> tuple[float, float, float]:
    """Entry, exit and greatest-stress angle [rad] at a sinkage [m]; `rolling` = |D| in 0..1."""
    entry = math.acos(min(max(1.0 - sinkage / radius, math.cos(MAX_ENTRY_ANGLE)), 1.0))
    exit_ratio = max(soil[_LAMBDA], 0.0)
    rolling_exit = -math.acos(min(max(1.0 - exit_ratio * (1.0 - math.cos(entry)), -1.0), 1.0))
    greatest = min(max((soil[_C1] + soil[_C2] * slip) * entry, 0.0), 0.95 * entry)
    return entry, rolling * rolling_exit - (1.0 - rolling) * entry, rolling * greatest


@njit(cache=True)
def rim_forces(
    radius: float,
    shear_radius: float,
    width: float,
    sinkage: float,
    slip: float,
    lateral_slip: float,
    rolling: float,
    soil: FloatArray,
    nodes: FloatArray,
    weights: FloatArray,
) -> tuple[float, float, float, float, float, float, float]:
    """Forces of the ground on one wheel that travels towards +x.

    Args:
        radius, shear_radius, width: of the rim, of the grouser tips, of the wheel [m].
        sinkage: of the lowest rim point under the ground plane [m].
        slip: -1..1. lateral_slip: s_y. rolling: |D| in 0..1.
        soil: kernel row. nodes, weights: quadrature on (0, 1), each shape (m,).

    Returns:
        F_x, F_y, F_z [N] through the wheel's centre, T [N m] that the motor must supply, moments of the
        lateral stress about x and z [N m], and the contact's length along the rim [m]. All zero without
        contact.
    """
    if sinkage <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    entry, exit_angle, greatest = contact_angles(radius, sinkage, slip, rolling, soil)
    if entry <= 0.0:  # a sinkage that is lost in the rounding of 1 - z/r
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    n = soil[_N]
    # The pressure is k r^n (cos θ - cos θ1)^n; beyond the last entry angle it goes on with the sinkage.
    depth = radius * (1.0 - math.cos(entry))
    scale = pressure_modulus(soil, width) * radius**n * max(sinkage / depth, 1.0)
    slip_angle = math.atan2(abs(lateral_slip), max(1.0 - rolling * max(slip, 0.0), 1e-3))
    modulus_x = soil[_K_X] + soil[_K_X_SLOPE] * slip_angle
    modulus_y = soil[_K_Y] + soil[_K_Y_SLOPE] * slip_angle
    cohesion = soil[_COHESION]
    tan_phi = soil[_TAN_PHI]
    cos_entry = math.cos(entry)
    sin_entry = math.sin(entry)
    drive_slip = max(slip, 0.0)
    brake_slip = min(slip, 0.0)
    front = entry - greatest
    rear = greatest - exit_angle
    pressed = 1.0 - rolling
    pressed_length = 2.0 * radius * sin_entry

    force_x = 0.0
    force_y = 0.0
    force_z = 0.0
    torque = 0.0
    moment_x = 0.0
    moment_z = 0.0
    for side in range(2):
        span = front if side == 0 else rear
        for i in range(nodes.shape[0]):
            # Substitution x -> x^2 at the free edge: the integrand's root there (n < 1) keeps the order.
            x = nodes[i] * nodes[i]
            measure = 2.0 * nodes[i] * weights[i] * span * width
            theta = entry - x * front if side == 0 else exit_angle + x * rear
            mirrored = entry - x * front
            rise = max(math.cos(mirrored) - cos_entry, 0.0)
            sigma = scale * (rise if n == 1.0 else rise**n)
            sin_theta = math.sin(theta)
            cos_theta = math.cos(theta)
            arc = entry - theta
            chord = sin_entry - sin_theta
            rolled = shear_radius * (arc - chord + drive_slip * chord + brake_slip * arc)
            jx = (rolling * rolled + pressed * slip * pressed_length) / modulus_x
            jy = lateral_slip * (rolling * shear_radius * arc + pressed * pressed_length) / modulus_y
            j = math.sqrt(jx * jx + jy * jy)
            # (1 - e^-j)/j without the loss of digits at zero
            gain = -math.expm1(-j) / j if j > 1e-9 else 1.0
            limit = (cohesion + sigma * tan_phi) * gain
            tau_x = limit * jx * shear_radius * measure
            tau_y = limit * jy * shear_radius * measure
            normal = sigma * radius * measure
            force_x += tau_x * cos_theta - normal * sin_theta
            force_z += tau_x * sin_theta + normal * cos_theta
            force_y += tau_y
            torque += tau_x * shear_radius
            moment_x += tau_y * shear_radius * cos_theta
            moment_z += tau_y * shear_radius * sin_theta
    # Cohesion before soil that bears nothing yet would pull a locked wheel down: soil does not do that.
    force_z = max(force_z, 0.0)
    return force_x, force_y, force_z, torque, moment_x, moment_z, radius * (entry - exit_angle)
