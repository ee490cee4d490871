"""What the grousers of a rigid wheel do to soil: where it shears, what it bears there, and what they carry away.

N grousers of height h and thickness t stand a pitch p = 2π r/N apart, their tips on the circle r_s = r + h. In front of
each a passive wedge reaches along the rim for l = h √N_φ, N_φ = tan²(45° + φ/2) (Rankine; Bekker 1969; Wong 2008, sec.
2.6), and stays with it.

**Strength.** The weakest of two surfaces counts. Through the tips, soil slides on soil: c, tan φ. Along the rim, soil
slides on metal where there is no wedge, and each grouser is held by the passive thrust of its face, F/b = 2 c h √N_φ
+ σ N_φ h; the rim bears on a wedge with what the face is held by, so its friction counts beside the wedges alone:

    c' = min(c, c_a + 2 c √N_φ h/p),   tan φ' = min(tan φ, (1 - min(l/p, 1)) tan δ + N_φ h/p)

less the share of the tips themselves, N t/(2π r_s), which is metal on soil. The two vertical sides of the soil block
between the tips add their cohesion, c' (1 + 2 h/b) (Bekker 1969); no friction (Bekker has one of 0.64 (h/b) acot(h/b)):
what presses on them from the side is not part of the load, and the weight of so shallow a wall is nothing beside it.

tan φ' is friction over the normal force, c' cohesion over the area of the tip circle: a force of the rim passes whole
through the soil between the grousers, σ r = σ_s r_s. So no wheel pulls more than W tan φ + c A, A with the sides.

**In skid** a wedge of soil forms ahead of the wheel and moves with it, a wheel of 100 % skid being a blade (Wong 2008,
sec. 2.5.1; Wong 1967, J. Terramechanics 4(2):7): it covers rim and grousers alike, and what a smooth wheel of the same
soil has been found to bear holds for both. What grousers add to strength fades with the skid, linearly (an estimate).

**Soil carried out.** Each grouser takes along what stands in front of its face, the wedge h l/2; where the next one is
nearer than the wedge reaches, what lies above its own plane stays stuck in the gap, and p²/(2 √N_φ) leaves it. Spread
over the pitch, that is a layer

    D = (h/2) min(l/p, p/l)

which moves with the rim, over r ω, where the wheel passes over v: it lowers the ground under the wheel by D s/(1 - s)
(digging of lugs as a part of the slip sinkage: Ding et al. 2010, J. Cent. South Univ. Technol. 17:129; the geometry of
the layer is ours). Soil runs back into the pit where its walls are steeper than the angle of repose, so that the pit is
no deeper than d_p = (L/2) tan φ, half the length of the contact being L/2 = r sin θ1:

    1/d = v'/(D s) + 1/d_p,   v'² = (1 - s)² + 0.01²

from nothing at s = 0 to nearly d_p for a wheel that spins on the spot (which gets on by a hundredth of its rim's way).

Range: grousers straight across the rim, wholly in the soil. `test/validation/test_lugged_wheels.py`: what it reaches.
"""

import math

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.rigid_rim import RigidRim
from sojourn_physics.soil.params import SoilColumn

LEAST_SPEED = 0.01
"""Speed over the ground, over that of the rim, below which a wheel digs as one that spins on the spot [-]."""


@kernel
def root_of_flow_value(tan_phi: float) -> float:
    """√N_φ = tan(45° + φ/2) [-]."""
    return float(tan_phi + math.sqrt(1.0 + tan_phi * tan_phi))


@kernel
def shear_strength(rim: RigidRim, skid: float, soil: FloatArray) -> tuple[float, float]:
    """c' over the area of the tip circle [Pa] and tan φ' over the normal force [-]; of a bare rim without grousers.

    Args:
        skid: 0..1, of a braked wheel [-]. soil: kernel row.
    """
    cohesion, tan_phi = soil[SoilColumn.COHESION], soil[SoilColumn.TAN_PHI]
    adhesion, tan_delta = soil[SoilColumn.INTERFACE_ADHESION], soil[SoilColumn.INTERFACE_TAN_PHI]
    radius, shear_radius, count = rim.radius, rim.shear_radius, rim.grouser_count
    height = shear_radius - radius
    if height <= 0.0:
        return adhesion, tan_delta
    root = root_of_flow_value(tan_phi)
    per_pitch = height * count / (2.0 * math.pi * radius)
    tips = min(max(count * rim.grouser_thickness / (2.0 * math.pi * shear_radius), 0.0), 1.0)
    beside = 1.0 - min(root * per_pitch, 1.0)
    between = min(cohesion, adhesion + 2.0 * cohesion * root * per_pitch) * (1.0 + 2.0 * height / rim.width)
    between_tan = min(tan_phi, beside * tan_delta + root * root * per_pitch)
    gain = (1.0 - tips) * (1.0 - skid)
    return adhesion + gain * max(between - adhesion, 0.0), tan_delta + gain * max(between_tan - tan_delta, 0.0)


@kernel
def dug_depth(rim: RigidRim, slip: float, half_length: float, tan_phi: float) -> float:
    """d, by which grousers lower the ground under a wheel that slips [m].

    Args:
        slip: at most 1; no digging below 0 [-]. half_length: L/2 of the contact along the ground [m].
    """
    count, height = rim.grouser_count, rim.shear_radius - rim.radius
    if height <= 0.0 or count <= 0.0 or slip <= 0.0:
        return 0.0
    pit = half_length * tan_phi
    reach = root_of_flow_value(tan_phi) * height * count / (2.0 * math.pi * rim.radius)  # l/p
    layer = 0.5 * height * min(reach, 1.0 / reach)
    dug = layer * slip
    # times D s d_p, for soil without friction and a contact without length
    return float(dug * pit / (math.sqrt((1.0 - slip) ** 2 + LEAST_SPEED**2) * pit + dug))
