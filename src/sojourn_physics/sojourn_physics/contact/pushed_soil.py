"""Soil that a wheel pushes ahead of its front and before its side face: see `wheel_on_soil` and `soil.bearing`.

Both are passive earth pressure with Terzaghi's factors for the failure that the soil's file names, general or local.
On the side face, a vertical wall, the shape factor sin(α + φ)/(sin α cos φ) of Bekker's blade is one. The sunk segment
of the face, h(x) deep at x ahead of the axle, has closed integrals: with θ1 the entry angle of a wheel sunk to its axle
at most, s = sin θ1, c = cos θ1, and d = max(z - r, 0) what is sunk beyond that,

    ∫ h dx  = r² (θ1 - s c) + 2 r d,       ∫ h² dx = r³ (2 s - 2 s³/3 - 2 c θ1) + π r² d + 2 r d²
"""

import math

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.rigid_rim import RigidRim, RimContact, Travel
from sojourn_physics.soil.params import SoilColumn

STANDING_SPEED = 0.04
"""Speed over the ground, over max(rω, v), below which the push on the side face no longer grows [-]."""
FACE_FLOW = 0.5
"""Speed of the soil up the side face, over the speed of the wheel to that side [-]."""


@kernel
def front_push(radius: float, width: float, gravity: float, sinkage: float, soil: FloatArray) -> float:
    """Bekker's bulldozing resistance [N] (`soil.bearing`); zero where the soil does not ask for it."""
    if soil[SoilColumn.FRONT_BULLDOZING] <= 0.0 or sinkage <= 0.0:
        return 0.0
    depth = min(sinkage, radius)
    unit_weight = soil[SoilColumn.DENSITY] * gravity
    cohesion, tan_phi = soil[SoilColumn.BULLDOZING_COHESION], soil[SoilColumn.BULLDOZING_TAN_PHI]
    phi = math.atan(tan_phi)
    active = math.tan(0.25 * math.pi - 0.5 * phi)
    cos_approach = 1.0 - depth / radius
    sin_approach = math.sqrt(max(1.0 - cos_approach * cos_approach, 1e-300))
    wedge = depth * active * active
    # sin(α + φ)/(sin α cos φ) = 1 + tan φ / tan α
    shape = 0.5 * (1.0 + tan_phi * cos_approach / sin_approach)
    passive = (
        2.0 * depth * cohesion * soil[SoilColumn.BULLDOZING_K_C]
        + unit_weight * depth * depth * soil[SoilColumn.BULLDOZING_K_GAMMA]
    )
    side = wedge**3 * unit_weight / 3.0 * (0.5 * math.pi - phi) + cohesion * wedge * wedge * (1.0 + 1.0 / active)
    return float(soil[SoilColumn.FRONT_BULLDOZING] * (width * shape * passive + side))


@kernel
def side_push(
    rim: RigidRim, gravity: float, contact: RimContact, travel: Travel, length: float, soil: FloatArray
) -> tuple[float, float, float, float, float]:
    """Push on the side face that leads a sideslip, and its friction.

    Args:
        gravity: [m/s^2]. length: of the contact along the ground [m]. soil: kernel row.

    Returns:
        F_x, F_y [N], torque about the axle, moments about x and z [N m], as `wheel_forces`.
    """
    radius, sinkage, lateral_slip, ahead = rim.radius, contact.depth, contact.lateral_slip, travel.ahead
    if soil[SoilColumn.SIDE_BULLDOZING] <= 0.0 or lateral_slip == 0.0 or sinkage <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    cos_entry = max(1.0 - sinkage / radius, 0.0)
    sin_entry = math.sqrt(1.0 - cos_entry * cos_entry)
    entry = math.acos(cos_entry)
    beyond = max(sinkage - radius, 0.0)
    first = radius * radius * (entry - sin_entry * cos_entry) + 2.0 * radius * beyond
    second = radius**3 * (2.0 * sin_entry - 2.0 / 3.0 * sin_entry**3 - 2.0 * cos_entry * entry)
    second += math.pi * radius * radius * beyond + 2.0 * radius * beyond * beyond
    # at nanometres the differences are rounding, of either sign
    first, second = max(first, 0.0), max(second, 0.0)
    wall = (
        0.5 * soil[SoilColumn.DENSITY] * gravity * soil[SoilColumn.BULLDOZING_K_GAMMA] * second
        + soil[SoilColumn.BULLDOZING_COHESION] * soil[SoilColumn.BULLDOZING_K_C] * first
    )
    sideslip = abs(lateral_slip)
    transit = 1.0 + contact.rolling * (math.sqrt(ahead * ahead + STANDING_SPEED * STANDING_SPEED) - 1.0)
    push = (
        soil[SoilColumn.SIDE_BULLDOZING]
        * wall
        * -math.expm1(-sideslip * length / (soil[SoilColumn.BULLDOZING_MODULUS] * transit))
    )
    arm = radius - 0.5 * min(sinkage, radius)
    sliding = ahead - travel.rim_speed * arm / radius
    flow = FACE_FLOW * sideslip
    face_speed = math.hypot(sliding, flow)  # squares of tiny speeds would vanish
    friction = contact.rolling * soil[SoilColumn.INTERFACE_TAN_PHI]
    drag = -friction * push * sliding / face_speed if face_speed > 0.0 else 0.0
    sense = 1.0 if lateral_slip > 0.0 else -1.0
    # The face that leads is at y = -sense b/2: the wheel moves towards -s_y.
    return drag, sense * push, drag * arm, sense * push * arm, sense * 0.5 * rim.width * drag
