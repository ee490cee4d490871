"""Rigid wheel on deformable soil: stresses under the rim, integrated to forces (Wong-Reece, Janosi-Hanamoto).

Angles θ run along the rim from the contact normal, positive towards the direction of travel; θ1 is the entry,
θ2 the exit, θm the angle of greatest normal stress. With h(θ) = r (cos θ - 1) + z:

    σ(θ) = k (h/S)^n        for θm <= θ <= θ1, k = k_c/b + k_φ (Bekker form) or (k_c + b k_φ)/b^n (Reece form)
    σ(θ) = σ(θ'),  θ' = θ1 - (θ - θ2)(θ1 - θm)/(θm - θ2)     for θ2 <= θ < θm
    θm = (c1 + c2 s + c3 e) θ1;  θ2 = 0, or θ2 = -acos(1 - λ z / r)
    τ = τ_max f(J),  J^2 = (jx/Kx)^2 + (jy/Ky)^2, directed along (jx/Kx, jy/Ky), f(J) = 1 - exp(-J) or Wong's hump
    F_x = b ∫ (r_s τx cos θ - r σ sin θ) dθ,  F_z = b ∫ (r_s τx sin θ + r σ cos θ) dθ,  F_y = b r_s ∫ τy dθ,
    T = b r_s² ∫ τx dθ
    (Wong & Reece 1967, J. Terramechanics 4(1):81 and 4(2):7; Janosi & Hanamoto 1961; lateral stress as in
    Ishigami et al. 2007, J. Field Robotics 24(3):233, with one friction limit for both directions, not two.)

Shear displacement of steady rolling, slip s = (rω - v)/max(rω, v), lateral slip s_y = -v_y/max(rω, v):

    jx = r_s { [(θ1-θ) - (sin θ1 - sin θ)] + max(s,0)(sin θ1 - sin θ) + min(s,0)(θ1-θ) }
    jy = r_s s_y (θ1-θ)

which is Wong and Reece's integral for s >= 0, and stays finite down to the locked wheel, s = -1,
where a soil particle is sheared by the length of rim that has passed over it. Slip is that of the rim.

**What slip and sideslip do to the sinkage** (S, and e; `soil` parameters, zero in a plain soil). Soil that is sheared
bears less, and is carried out of the contact, so a pressure is reached only at a greater depth:

    S = 1 + (1 - e)(m_d max(s',0) + m_b min(s',0)²) + m_y e,     s' = (rω - |v|)/max(rω, |v|),    e = 1 - v_x/|v|

m_d is Lyasko's slip sinkage (2010, J. Terramechanics 47(1):21: sinkage grows by a factor of the slip), m_b the same in
skid, where pushing soil ahead of the wheel grows with the square, m_y the loss of the fresh ground that rolling onto it
gives: e is 0 straight ahead and 1 for a wheel that goes sideways. One that spins on the spot, |v| << V = max(rω, |v|),
goes nowhere: there e fades to 0, as (|v| - v_x)/sqrt(v² + (0.01 V)²), and the slip alone counts. (Ding et al. 2010 let
the exponent n grow instead; a factor of z has no units to go wrong.) c3 moves θm for the same reason.

**Bare rim and grousers.** On a bare rim the soil slides on metal, τ_max = c_a + σ tan δ (Potyondy 1961, Géotechnique
11(4):339: sand on steel, δ = 0.5 to 0.8 φ). Behind grousers it shears on soil, on the circle through their tips, r_s =
r + h, which the rim's force reaches whole, σ_s = σ r/r_s; and they dig: S grows by (1 - e) d/z. `grousers` has both.

**Soil pushed by the wheel** (optional). Ahead, Bekker's bulldozing resistance R_b (`soil.bearing`), against v_x. By the
side, the passive pressure on the sunk segment of the side face (Hegedus 1960; Terzaghi's factors at a vertical wall):

    N = m ∫ (γ h² K_γ/2 + c K_c h) dx,  m = 1 - exp(-|v_y| L /(K_b v_t)),  v_t² = v_x² + (0.04 V)²

against v_y, and its friction N tan δ on the turning face, against the velocity of the face's middle, r - z/2 below the
axle, softened by the flow of soil up the face at half of v_y. L is the contact's length.

D in -1..1 is the memory of the direction of travel (see `contact_set`): at D = 0 the wheel has been pressed
straight down, and the contact is symmetric, θ2 = -θ1, θm = 0, S = 1 (static sinkage; Ishigami 2007 eq. 9), and all
of it has been sheared by the same displacement, jx = s L, jy = s_y L, L = 2 r sin θ1; at |D| = 1 it is the
rolling contact above. Both are blended linearly in |D|.

Steady motion gives no energy: the pressure never pushes ahead (it would for λ > 1), and where soil that springs back
under a lightly braked wheel would give more than the pressure takes (2 % of the power exchanged at most), the shear is
reduced to that.

Assumes homogeneous soil, a plane ground over the length of one contact, and quasi-static stress. Valid for
sinkage up to about 0.7 r; beyond the axle (z > r) the rim under it goes on to bear, the rest does not. Quadrature:
Gauss-Legendre on each side of θm, and, braked, on each side of the angle where the shear turns.
"""

import math

import numpy as np

from sojourn_machine.kernels import kernel, small_kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.grousers import dug_depth, shear_strength
from sojourn_physics.contact.pushed_soil import front_push, side_push
from sojourn_physics.contact.rigid_rim import Quadrature, RigidRim, RimContact, Travel
from sojourn_physics.soil.params import SoilColumn
from sojourn_physics.soil.pressure_sinkage import sinkage_modulus

MAX_ENTRY_ANGLE = 0.5 * math.pi
"""Largest entry angle [rad]: that of a wheel sunk to its axle."""
SPINNING_SPEED = 0.01
"""Speed over the ground, over max(rω, v), below which a wheel counts as one that spins on the spot [-]."""
STEADY = 0.9
"""|D| beyond which the motion counts as steady, so that its power is what the slips say [-]."""
QUADRATURE_POINTS = 6
"""Points on each side of θm: to 1e-4 of the force as a rule, 5e-3 at worst, 3e-2 where θm > 0.7 θ1."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(QUADRATURE_POINTS)
# On (0, 1), half the weight of the usual (-1, 1).
QUADRATURE = Quadrature(np.ascontiguousarray(0.5 * (_NODES + 1.0)), np.ascontiguousarray(0.5 * _WEIGHTS))


@small_kernel
def pressure_modulus(soil: FloatArray, width: float) -> float:
    """k of p = k z^n under a plate or wheel of `width` [m], in N/m^(n+2).

    Zero where a negative k_c outweighs k_phi.
    """
    modulus: float = sinkage_modulus(
        soil[SoilColumn.FORM], soil[SoilColumn.N], soil[SoilColumn.K_C], soil[SoilColumn.K_PHI], width
    )
    return max(modulus, 0.0)


@small_kernel
def contact_angles(
    radius: float, sinkage: float, slip: float, rolling: float, soil: FloatArray, sideways: float = 0.0
) -> tuple[float, float, float]:
    """Entry, exit and greatest-stress angle [rad] at a sinkage [m]; `rolling` = |D| and `sideways` = e in 0..1."""
    entry = math.acos(min(max(1.0 - sinkage / radius, 0.0), 1.0))
    exit_ratio = max(soil[SoilColumn.EXIT_LAMBDA], 0.0)
    rolling_exit = -math.acos(min(max(1.0 - exit_ratio * (1.0 - math.cos(entry)), -1.0), 1.0))
    share = soil[SoilColumn.THETA_M_C1] + soil[SoilColumn.THETA_M_C2] * slip + soil[SoilColumn.THETA_M_C3] * sideways
    greatest = min(max(share * entry, 0.0), 0.95 * entry)
    return entry, rolling * rolling_exit - (1.0 - rolling) * entry, rolling * greatest


@small_kernel
def travel(slip: float, lateral_slip: float) -> Travel:
    """Motion behind a slip and lateral slip."""
    ahead = 1.0 - slip
    if slip >= 0.0 and ahead * ahead + lateral_slip * lateral_slip <= 1.0:
        rim = 1.0
        speed = math.sqrt(ahead * ahead + lateral_slip * lateral_slip)
        total_slip = 1.0 - speed
    else:
        ahead = math.sqrt(max(1.0 - lateral_slip * lateral_slip, 0.0))
        rim = min(max(slip + ahead, 0.0), 1.0)
        speed = 1.0
        total_slip = rim - 1.0
    sideways = (speed - ahead) / math.sqrt(speed * speed + SPINNING_SPEED * SPINNING_SPEED)
    return Travel(rim, ahead, total_slip, sideways)


@small_kernel
def turning_angle(entry: float, slip: float, shift: float) -> float:
    """Angle θ at which the shear along a braked rim turns from ahead to back, jx = 0; beyond every rim if it does not.

    (1 + s)(θ1 - θ) - (sin θ1 - sin θ) + shift = 0, by Newton from the mirror image of θ1 about the extreme.

    Args:
        entry: θ1 [rad]. slip: s. shift: of the shear, over r_s, as it is for a wheel that does not yet roll [-].
    """
    if slip >= 0.0 or slip <= -1.0:
        return math.inf
    extreme = math.acos(1.0 + slip)
    sin_entry = math.sin(entry)
    highest = (1.0 + slip) * (entry - extreme) - (sin_entry - math.sin(extreme)) + shift
    if extreme >= entry or highest <= 0.0:
        return math.inf
    theta = 2.0 * extreme - entry
    for _ in range(4):
        slope = math.cos(theta) - 1.0 - slip
        if abs(slope) < 1e-9:
            break
        theta -= ((1.0 + slip) * (entry - theta) - (sin_entry - math.sin(theta)) + shift) / slope
    left = (1.0 + slip) * (entry - theta) - (sin_entry - math.sin(theta)) + shift
    if abs(theta) <= extreme and abs(left) < 1e-6:
        return theta
    # Near a level stretch Newton leaps away. The shear rises all the way from -extreme to extreme: halve that.
    low, high = -extreme, extreme
    if (1.0 + slip) * (entry - low) - (sin_entry - math.sin(low)) + shift >= 0.0:
        return math.inf
    for _ in range(30):
        theta = 0.5 * (low + high)
        if (1.0 + slip) * (entry - theta) - (sin_entry - math.sin(theta)) + shift < 0.0:
            low = theta
        else:
            high = theta
    return theta


@kernel
def rim_forces(
    radius: float,
    shear_radius: float,
    width: float,
    contact: RimContact,
    soil: FloatArray,
    quadrature: Quadrature,
) -> tuple[float, float, float, float, float, float, float]:
    """Forces as `wheel_forces` gives them, of a wheel whose grousers stand close together, where soil has no weight.

    Returns:
        the first seven values of `wheel_forces`.
    """
    rim = RigidRim(radius, shear_radius, width, 1e9 if shear_radius > radius else 0.0, 0.0)
    found = wheel_forces(rim, 0.0, contact, soil, quadrature)
    return found[0], found[1], found[2], found[3], found[4], found[5], found[6]


@kernel
def wheel_forces(
    rim: RigidRim, gravity: float, contact: RimContact, soil: FloatArray, quadrature: Quadrature
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """Forces of the ground on one wheel that travels towards +x.

    Args:
        gravity: [m/s^2]. soil: kernel row.

    Returns:
        F_x, F_y, F_z [N] through the wheel's centre, T [N m] that the motor must supply, moments of the
        lateral stress about x and z [N m], the contact's length along the rim [m], and the resistances of compaction
        and bulldozing [N], parts of F_x, at least 0. All zero without contact.
    """
    radius, shear_radius, width = rim.radius, rim.shear_radius, rim.width
    sinkage, slip, lateral_slip, rolling = contact.depth, contact.slip, contact.lateral_slip, contact.rolling
    nodes, weights = quadrature.nodes, quadrature.weights
    if sinkage <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    motion = travel(slip, lateral_slip)
    ahead, total_slip, sideways = motion.ahead, motion.total_slip, motion.sideways
    entry, exit_angle, greatest = contact_angles(radius, sinkage, slip, rolling, soil, sideways)
    if entry <= 0.0:  # a sinkage that is lost in the rounding of 1 - z/r
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    n = soil[SoilColumn.N]
    # The pressure is k r^n (cos θ - cos θ1)^n, with the cosine going on below zero for a wheel sunk beyond its axle.
    scale = pressure_modulus(soil, width) * radius**n
    driven = (
        soil[SoilColumn.SLIP_SINKAGE] * max(total_slip, 0.0) + soil[SoilColumn.SKID_SINKAGE] * min(total_slip, 0.0) ** 2
    )
    growth = rolling * ((1.0 - sideways) * driven + sideways * soil[SoilColumn.SIDE_SINKAGE])
    sin_entry = math.sin(entry)
    if total_slip > 0.0 and shear_radius > radius:
        dug = dug_depth(rim, total_slip, radius * sin_entry, soil[SoilColumn.TAN_PHI])
        growth += rolling * (1.0 - sideways) * dug / sinkage
    if growth > 0.0:
        scale *= (1.0 + growth) ** -n
    slip_angle = math.atan2(abs(lateral_slip), max(1.0 - rolling * max(slip, 0.0), 1e-3))
    modulus_x = soil[SoilColumn.SHEAR_MODULUS] + soil[SoilColumn.SHEAR_MODULUS_PER_SLIP_ANGLE] * slip_angle
    modulus_y = (
        soil[SoilColumn.SHEAR_MODULUS_LATERAL] + soil[SoilColumn.SHEAR_MODULUS_LATERAL_PER_SLIP_ANGLE] * slip_angle
    )
    brake_slip = min(slip, 0.0)
    cohesion, tan_phi = shear_strength(rim, -rolling * brake_slip, soil)
    tan_phi *= radius / shear_radius  # of the normal stress on the tip circle, which is wider than the rim
    residual, hump = soil[SoilColumn.RESIDUAL], soil[SoilColumn.HUMP]
    cos_entry = 1.0 - sinkage / radius
    drive_slip = max(slip, 0.0)
    front = entry - greatest
    rear = greatest - exit_angle
    pressed = 1.0 - rolling
    pressed_length = 2.0 * radius * sin_entry

    shear_x = 0.0
    shear_y = 0.0
    shear_z = 0.0
    torque = 0.0
    moment_x = 0.0
    moment_z = 0.0
    normal_x = 0.0
    normal_z = 0.0
    turn = turning_angle(entry, slip, pressed * slip * pressed_length / (max(rolling, 1e-9) * shear_radius))
    for piece in range(4):
        # Each side of θm, and each of these again at the angle where the shear turns, if that is inside.
        span = front if piece < 2 else rear
        split = (entry - turn) / span if piece < 2 else (turn - exit_angle) / span if span > 0.0 else 1.0
        if not 0.0 < split < 1.0:
            split = 1.0
        if split == 1.0 and piece % 2 == 1:
            continue
        for i in range(nodes.shape[0]):
            if piece % 2 == 0:
                # Substitution x -> x^2 at the free edge: the integrand's root there (n < 1) keeps the order.
                x = split * nodes[i] * nodes[i]
                measure = 2.0 * split * nodes[i] * weights[i] * span * width
            else:
                x = split + (1.0 - split) * nodes[i]
                measure = (1.0 - split) * weights[i] * span * width
            theta = entry - x * front if piece < 2 else exit_angle + x * rear
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
            mobilised = -math.expm1(-j)
            gain = (mobilised / j if j > 1e-9 else 1.0) * (residual + hump * (1.0 - mobilised))
            limit = (cohesion + sigma * tan_phi) * gain
            tau_x = limit * jx * shear_radius * measure
            tau_y = limit * jy * shear_radius * measure
            normal = sigma * radius * measure
            shear_x += tau_x * cos_theta
            shear_z += tau_x * sin_theta
            normal_x -= normal * sin_theta
            normal_z += normal * cos_theta
            shear_y += tau_y
            torque += tau_x * shear_radius
            moment_x += tau_y * shear_radius * cos_theta
            moment_z += tau_y * shear_radius * sin_theta

    normal_x = min(normal_x, 0.0)
    # Power into the ground over V: what the motor gives, less what the wheel's motion takes out.
    shear_power = torque * motion.rim_speed / radius - shear_x * ahead + shear_y * lateral_slip
    normal_power = -normal_x * ahead
    if shear_power < 0.0 and -shear_power > normal_power:
        steady = min(max((rolling - STEADY) / (1.0 - STEADY), 0.0), 1.0)
        share = 1.0 - steady * (1.0 - normal_power / -shear_power)
        shear_x *= share
        shear_y *= share
        shear_z *= share
        torque *= share
        moment_x *= share
        moment_z *= share
    length = radius * (entry - exit_angle)
    ground_length = radius * (sin_entry - math.sin(exit_angle))
    ahead_push = rolling * front_push(radius, width, gravity, sinkage, soil)
    side_x, side_y, side_torque, side_moment_x, side_moment_z = side_push(
        rim, gravity, contact, motion, ground_length, soil
    )
    return (
        shear_x + normal_x - ahead_push + side_x,
        shear_y + side_y,
        # Cohesion before soil that bears nothing yet would pull a locked wheel down: soil does not do that.
        max(shear_z + normal_z, 0.0),
        torque + side_torque,
        moment_x + side_moment_x,
        moment_z + side_moment_z,
        length,
        -normal_x,
        ahead_push,
    )
