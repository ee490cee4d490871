"""Laws 9 and 10, Magic Formula with relaxation lengths: measured forces of a pneumatic tyre on a road.

    y(x) = D sin(C atan(B φ)),   φ = (1 - E) x + (E/B) atan(B x),   x = X + S_h,   Y = y + S_v
    D = a1 Fz² + a2 Fz,   E = a6 Fz² + a7 Fz + a8
    B C D = a3 sin(a4 atan(a5 Fz))             lateral force
    B C D = (a3 Fz² + a4 Fz) exp(-a5 Fz)       longitudinal force, aligning moment
    camber:  S_h = a9 γ,  S_v = (a10 Fz² + a11 Fz) γ,  B -> B (1 - a12 |γ|),  E -> E/(1 - a13 |γ|)

Fz in kN, angles in degrees, longitudinal slip in per cent, forces in N, moment in N m (Bakker, Nyborg &
Pacejka 1987, SAE 870421, tables 1 and 2). Here the slip angle is positive for a positive force.

Both slips at once, by similarity (Pacejka 2012, Tire and Vehicle Dynamics, sec. 4.2): with the slips over
those at which the initial slope would reach the peak, ξ_x = κ (BCD)_x/D_x, ξ_y = α (BCD)_y/D_y, each force is
that of pure slip at |ξ|, times ξ_x/|ξ| or ξ_y/|ξ|. The aligning moment keeps its trail of pure side slip.

Relaxation (Pacejka 2012, sec. 7.2): u along and across follow the slip velocity, du/dt = w - |v_x| u/λ, with
κ = u_x/λ_x and tan α = u_y/λ_y, so that rest is a fixed point and stays one. Below CRAWL the u are held to
CRAWL_LIMIT times the slip of the peak (as Pacejka 2012, eq. 7.25 does): else a locked wheel that
turns back would give energy.

So that no steady motion takes energy out of the ground, the lateral force acts a trail t = -M_z/F_y behind the
centre, with the slip of that point. What camber adds to force and moment acts as far as the wheel rolls, and is
paid for by a torque on the axle.

Range of validity: loads of 1 to 8 kN of the measured tyre, slip angle to 30 degrees; outside the load at
which D is greatest the force goes on with that D; E is held to 1 at most (beyond, the force would turn its sign).
"""

import math
from enum import IntEnum
from typing import Any, Literal

from pydantic import Field

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.bristle_friction import bristle_lead
from sojourn_physics.contact.contact_law import MotionColumn, OutColumn, StateColumn, WheelColumn
from sojourn_physics.contact.firm_wheel import (
    CompliantWheelParams,
    FirmColumn,
    Shear,
    finish_firm,
    firm_load,
    firm_slip,
    half_length,
)

CRAWL = 0.2
"""Below about this speed along the wheel the displacements are limited [m/s]."""
CRAWL_LIMIT = 3.0
ROLLING_SPEED = 0.01
"""Camber counts by half at this speed [m/s]."""
TRAIL_FORCE = 1e-3
"""Side force, over the load, below which no trail can be told."""
MAX_SLIP = 1e3
"""Largest longitudinal slip that is looked up [-]."""
SMALL = 1e-12
LATERAL_FORM = 0
EXPONENTIAL_FORM = 1

_LATERAL_FORCE = (-22.1, 1011.0, 1078.0, 1.82, 0.208, 0.0, -0.354, 0.707, 0.028, 0.0, 14.8, 0.022, 0.0)
_ALIGNING_MOMENT = (-2.72, -2.28, -1.86, -2.73, 0.110, -0.070, 0.643, -4.04, 0.015, -0.066, 0.945, 0.030, 0.070)
_LONGITUDINAL_FORCE = (-21.3, 1144.0, 49.6, 226.0, 0.069, -0.006, 0.056, 0.486)
CURVE_SIZE = 14
"""C and a1 to a13."""

Lateral = tuple[float, float, float, float, float, float, float, float, float, float, float, float, float]
Longitudinal = tuple[float, float, float, float, float, float, float, float]


class MagicColumn(IntEnum):
    """Own parameters after `FirmColumn`; each curve has CURVE_SIZE columns, C and then a1 to a13."""

    RELAXATION_LONGITUDINAL = FirmColumn.NEXT
    RELAXATION_LATERAL = FirmColumn.NEXT + 1
    LATERAL = FirmColumn.NEXT + 2
    ALIGNING = FirmColumn.NEXT + 2 + CURVE_SIZE
    LONGITUDINAL = FirmColumn.NEXT + 2 + 2 * CURVE_SIZE


class MagicFormulaParams(CompliantWheelParams):
    """Laws 9 and 10. The coefficients that are the default are those of the tyre of Bakker et al. 1987."""

    model: Literal["magic_formula"] = Field(description="contact model")
    relaxation_longitudinal: float = Field(default=0.1, gt=0.0, le=5.0, description="relaxation length along [m]")
    relaxation_lateral: float = Field(default=0.3, gt=0.0, le=5.0, description="relaxation length across [m]")
    lateral_c: float = Field(default=1.30, gt=0.0, le=2.0, description="C of the lateral force [-]")
    lateral: Lateral = Field(default=_LATERAL_FORCE, description="a1 to a13 of the lateral force")
    aligning_c: float = Field(default=2.40, gt=0.0, le=4.0, description="C of the aligning moment [-]")
    aligning: Lateral = Field(default=_ALIGNING_MOMENT, description="a1 to a13 of the aligning moment")
    longitudinal_c: float = Field(default=1.65, gt=0.0, le=2.0, description="C of the longitudinal force [-]")
    longitudinal: Longitudinal = Field(default=_LONGITUDINAL_FORCE, description="a1 to a8 of the longitudinal force")

    def fill(self, row: FloatArray) -> None:
        """The columns of this set."""
        super().fill(row)
        row[MagicColumn.RELAXATION_LONGITUDINAL] = self.relaxation_longitudinal
        row[MagicColumn.RELAXATION_LATERAL] = self.relaxation_lateral
        for start, c, coefficients in (
            (MagicColumn.LATERAL, self.lateral_c, self.lateral),
            (MagicColumn.ALIGNING, self.aligning_c, self.aligning),
            (MagicColumn.LONGITUDINAL, self.longitudinal_c, self.longitudinal),
        ):
            row[start] = c
            row[start + 1 : start + 1 + len(coefficients)] = coefficients

    @classmethod
    def law(cls) -> Any:
        """See `ContactLawParams`."""
        return magic_formula


@kernel
def curve(coefficients: FloatArray, form: int, load: float, camber: float) -> tuple[float, float, float, float]:
    """B, C, D, E of one curve. coefficients: (CURVE_SIZE,). load: [kN]. camber: [degree]."""
    a1, a2, a5 = coefficients[1], coefficients[2], coefficients[5]
    if a1 < 0.0 < a2:
        load = min(load, -0.5 * a2 / a1)
    c = coefficients[0]
    d = (a1 * load + a2) * load
    if form == LATERAL_FORM:
        slope = coefficients[3] * math.sin(coefficients[4] * math.atan(a5 * load))
    else:
        exponent = min(max(-a5 * load, -50.0), 50.0)
        slope = (coefficients[3] * load + coefficients[4]) * load * math.exp(exponent)
    tilt = abs(camber)
    b = slope / (c * d) if c * d != 0.0 else 0.0
    b *= max(1.0 - coefficients[12] * tilt, 0.0)
    e = (coefficients[6] * load + coefficients[7]) * load + coefficients[8]
    e /= max(1.0 - coefficients[13] * tilt, 0.1)
    return max(b, 0.0), c, d, min(e, 1.0)


@kernel
def formula(b: float, c: float, d: float, e: float, x: float) -> float:
    """y(x)."""
    stretched = b * x
    bent = (1.0 - e) * stretched + e * math.atan(stretched)
    return d * math.sin(c * math.atan(bent))


@kernel
def magic_forces(
    wheel: FloatArray, load: float, slip: float, angle: float, camber: float
) -> tuple[float, float, float]:
    """F_x, F_y [N] and M_z [N m] for travel ahead.

    Args:
        wheel: row with `MagicColumn`. load: [N]. slip: κ [-]. angle: slip angle [rad], positive for positive F_y.
        camber: [rad], positive for positive F_y.
    """
    kilonewtons = load * 1e-3
    tilt = math.degrees(camber)
    lateral, aligning = (
        wheel[MagicColumn.LATERAL : MagicColumn.LATERAL + CURVE_SIZE],
        wheel[MagicColumn.ALIGNING : MagicColumn.ALIGNING + CURVE_SIZE],
    )
    along = wheel[MagicColumn.LONGITUDINAL : MagicColumn.LONGITUDINAL + CURVE_SIZE]
    b_x, c_x, d_x, e_x = curve(along, EXPONENTIAL_FORM, kilonewtons, 0.0)
    b_y, c_y, d_y, e_y = curve(lateral, LATERAL_FORM, kilonewtons, tilt)
    b_z, c_z, d_z, e_z = curve(aligning, EXPONENTIAL_FORM, kilonewtons, tilt)
    x = 100.0 * min(max(slip, -MAX_SLIP), MAX_SLIP)
    alpha = math.degrees(angle)
    shifted = alpha + lateral[9] * tilt
    xi_x, xi_y = b_x * c_x * x, b_y * c_y * shifted
    xi = math.sqrt(xi_x * xi_x + xi_y * xi_y)
    force_x = force_y = 0.0
    if xi > SMALL:
        if b_x > 0.0:
            force_x = formula(b_x, c_x, d_x, e_x, xi / (b_x * c_x)) * xi_x / xi
        if b_y > 0.0:
            force_y = formula(b_y, c_y, d_y, e_y, xi / (b_y * c_y)) * xi_y / xi
    limited = min(kilonewtons, -0.5 * lateral[2] / lateral[1]) if lateral[1] < 0.0 < lateral[2] else kilonewtons
    force_y += (lateral[10] * limited + lateral[11]) * limited * tilt
    # the moment at the resultant slip, by the part of the side slip in it
    turned = alpha + aligning[9] * tilt
    xi_z = math.sqrt(xi_x * xi_x + (b_y * c_y * turned) ** 2)
    moment = 0.0
    if xi_z > SMALL and b_y > 0.0:
        moment = formula(b_z, c_z, d_z, e_z, xi_z / (b_y * c_y)) * b_y * c_y * turned / xi_z
    moment += (aligning[10] * limited + aligning[11]) * limited * tilt
    return force_x, force_y, moment


@kernel
def _hold_slips(wheel: FloatArray, load: float, speed: float, state: FloatArray) -> None:
    """At a crawl, hold the displacements to what a sliding contact can store."""
    kilonewtons = load * 1e-3
    b_x, c_x, _, _ = curve(
        wheel[MagicColumn.LONGITUDINAL : MagicColumn.LONGITUDINAL + CURVE_SIZE], EXPONENTIAL_FORM, kilonewtons, 0.0
    )
    b_y, c_y, _, _ = curve(
        wheel[MagicColumn.LATERAL : MagicColumn.LATERAL + CURVE_SIZE], LATERAL_FORM, kilonewtons, 0.0
    )
    xi_x = b_x * c_x * 100.0 * state[StateColumn.SHEAR_ALONG] / wheel[MagicColumn.RELAXATION_LONGITUDINAL]
    xi_y = b_y * c_y * math.degrees(1.0) * state[StateColumn.SHEAR_SIDE] / wheel[MagicColumn.RELAXATION_LATERAL]
    xi = math.sqrt(xi_x * xi_x + xi_y * xi_y)
    largest = CRAWL_LIMIT * (1.0 + (speed / CRAWL) ** 4)
    if xi > largest:
        state[StateColumn.SHEAR_ALONG] *= largest / xi
        state[StateColumn.SHEAR_SIDE] *= largest / xi


@kernel
def _trail(wheel: FloatArray, load: float, state: FloatArray, half: float) -> float:
    """-M_z/F_y of pure and combined slip without camber [m], at most half the contact's length; 0 at no slip."""
    slip, angle = (
        state[StateColumn.SHEAR_ALONG] / wheel[MagicColumn.RELAXATION_LONGITUDINAL],
        math.atan(state[StateColumn.SHEAR_SIDE] / wheel[MagicColumn.RELAXATION_LATERAL]),
    )
    _, force_y, moment = magic_forces(wheel, load, slip, angle, 0.0)
    small = TRAIL_FORCE * load
    return float(min(max(-moment * force_y / (force_y * force_y + small * small + SMALL), -half), half))


@kernel
def magic_formula(
    wheel: FloatArray, soil: FloatArray, motion: FloatArray, dt: float, state: FloatArray, out: FloatArray
) -> None:
    """The law; arguments as in `contact_law`."""
    load = firm_load(wheel, soil, motion, out)
    rolling_slip = firm_slip(wheel, motion, out)
    slip_y, rim_speed = rolling_slip.side, rolling_slip.rim_speed
    length = 2.0 * half_length(wheel[WheelColumn.RADIUS], motion[MotionColumn.PENETRATION])
    relax_x, relax_y = wheel[MagicColumn.RELAXATION_LONGITUDINAL], wheel[MagicColumn.RELAXATION_LATERAL]
    speed = abs(motion[MotionColumn.V_ALONG])
    moved = dt * rim_speed / length
    state[StateColumn.TRAVEL] = (state[StateColumn.TRAVEL] + moved) / (1.0 + abs(moved))
    yaw_rate = motion[MotionColumn.YAW_RATE]
    trail = state[StateColumn.TRAVEL] * _trail(wheel, load, state, 0.5 * length)
    slip_there = slip_y + trail * yaw_rate  # where the force acts
    before_x, before_y = state[StateColumn.SHEAR_ALONG], state[StateColumn.SHEAR_SIDE]
    state[StateColumn.SHEAR_ALONG] = (state[StateColumn.SHEAR_ALONG] + dt * rolling_slip.along) / (
        1.0 + dt * speed / relax_x
    )
    state[StateColumn.SHEAR_SIDE] = (state[StateColumn.SHEAR_SIDE] + dt * slip_there) / (1.0 + dt * speed / relax_y)
    _hold_slips(wheel, load, speed, state)

    ahead = bristle_lead(max(speed, abs(rim_speed))) / dt
    slip = (state[StateColumn.SHEAR_ALONG] + ahead * (state[StateColumn.SHEAR_ALONG] - before_x)) / relax_x
    angle = math.atan((state[StateColumn.SHEAR_SIDE] + ahead * (state[StateColumn.SHEAR_SIDE] - before_y)) / relax_y)
    force_x, force_y, upright = magic_forces(wheel, load, slip, angle, 0.0)
    moment = -trail * force_y
    owed = 0.0
    if motion[MotionColumn.CAMBER] != 0.0:
        # a wheel that leans to the left has its axle's left end down
        camber = -math.asin(min(max(motion[MotionColumn.CAMBER], -1.0), 1.0))
        swept = max(speed, abs(slip_y), abs(rim_speed), abs(yaw_rate) * length)
        rolling = rim_speed * rim_speed / (swept * swept + ROLLING_SPEED * ROLLING_SPEED)
        force_x, leaning, leaning_moment = magic_forces(wheel, load, slip, angle, camber * rolling)
        more, more_moment = leaning - force_y, (leaning_moment - upright) * state[StateColumn.TRAVEL]
        owed = max(more_moment * yaw_rate - more * slip_y, 0.0)
        force_y, moment = leaning, moment + more_moment
    finish_firm(wheel, motion, rolling_slip, Shear(force_x, force_y, moment), length, dt, state, out)
    if owed > 0.0 and rim_speed != 0.0:
        out[OutColumn.TORQUE] += owed * rolling_slip.rolling_radius / rim_speed
