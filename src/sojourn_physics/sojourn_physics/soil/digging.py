"""Force of soil on a blade or bucket that cuts it: McKyes' wedge and Balovnev's bucket.

McKyes 1985 (Soil Cutting and Tillage, ch. 3; the universal earth-moving equation of Reece 1965): a blade of width w and
rake angle α (between its face and the ground ahead, from the horizontal), sunk to the depth d, pushes up a plane wedge
at the angle β that takes the least force:

    P = w (γ d² N_γ + c d N_c + q d N_q + a d N_a + ρ v² d N_v)
    D = cos(α+δ) + sin(α+δ) cot(β+φ)
    N_γ = (cot α + cot β)/(2 D)       N_c = (1 + cot β cot(β+φ))/D        N_q = 2 N_γ
    N_a = (1 - cot α cot(β+φ))/D      N_v = (tan β + cot(β+φ))/(D (1 + tan β cot α))
    H = P sin(α+δ) + a d w cot α      V = P cos(α+δ) - a d w             of the blade on the soil, V up positive

γ = ρ g weight of the soil, c cohesion, φ internal friction, δ friction of soil on metal, a adhesion, q surcharge on the
ground, v speed. β minimises N_γ. A smooth upright blade is Rankine's wall: N_γ = K_p/2, N_c = 2 √K_p; with δ it is
Coulomb's. A narrow blade takes besides the two crescents that break out at its sides (McKyes & Ali 1977, J. Terramech.
14:43): the weight and cohesion terms grow by the factors

    1 + (2 r/(3 w)) sin η   and   1 + (r/w) sin η,      r = d (cot α + cot β),  cos η = d cot α / r

Balovnev 1983 (New Methods for Calculating Resistance to Cutting of Soil; as given by Wilkinson & DeGennaro 2007,
J. Terramech. 44:133): a bucket of width w with a blunt edge e_b thick under the angle α_b and two side walls s thick
and l long, its base raked by β; horizontal force

    H = w d (1 + cot β tan δ) A(β) (γ d/2 + c cot φ + q + B)  + w e_b (1 + tan δ cot α_b) A(α_b) (γ e_b/2 + c cot φ + q
        + d γ K_a) + (2 s + 4 l tan δ) d A(π/2) (γ d/2 + c cot φ + q + B_s)
    K_a = (1 - sin φ)/(1 + sin φ);  B = γ K_a (d - l sin β) where it is above 0: soil over a bucket that is buried
    A(x) = (1 - sin φ cos 2x)/(1 - sin φ)                                   below  x = (asin(sin δ/sin φ) - δ)/2, else
    A(x) = cos δ (cos δ + √(sin² φ - sin² δ)) e^((2x - π + δ + asin(sin δ/sin φ)) tan φ)/(1 - sin φ)

It is an upper estimate in cohesive soil: the pressure c cot φ that stands for cohesion is not taken off again.

Range of validity: dry soil that fails in shear, 0 < φ < 60°, δ <= φ, α + δ + β + φ < 180°; blades from 20° to 120°.
"""

import math
from typing import NamedTuple

from sojourn_machine.errors import InvalidValueError


class DiggingSoil(NamedTuple):
    """Soil as these laws see it."""

    unit_weight: float
    """γ = ρ g [N/m3]."""
    cohesion: float
    """[Pa]"""
    friction: float
    """Internal friction angle φ [rad]."""
    tool_friction: float
    """Friction angle δ of soil on the tool [rad]."""
    adhesion: float = 0.0
    """[Pa]"""


class CuttingForce(NamedTuple):
    """Of the blade on the soil."""

    forward: float
    """Along the way of the blade [N]."""
    lift: float
    """Out of the ground positive [N]: the soil draws the blade in by it."""
    wedge: float
    """Angle β of the wedge [rad]."""


def check_soil(soil: DiggingSoil) -> None:
    """Raise InvalidValueError for a soil that these laws do not hold for."""
    if not 0.0 < soil.friction < math.radians(60.0):
        raise InvalidValueError("friction angle [rad]", soil.friction, "above 0, below 60 degrees")
    if not 0.0 <= soil.tool_friction <= soil.friction:
        raise InvalidValueError("friction angle of soil on the tool [rad]", soil.tool_friction, "0 to that of the soil")
    if min(soil.unit_weight, soil.cohesion, soil.adhesion) < 0.0:
        raise InvalidValueError("unit weight, cohesion or adhesion", min(soil[:2] + soil[4:]), "0 or above")


def _cot(angle: float) -> float:
    return math.cos(angle) / math.sin(angle)


def weight_factor(rake: float, wedge: float, friction: float, tool_friction: float) -> float:
    """N_γ of a wedge at the angle β [rad]; infinite where it cannot slide."""
    turn = rake + tool_friction
    share = math.cos(turn) + math.sin(turn) * _cot(wedge + friction)
    return 0.5 * (_cot(rake) + _cot(wedge)) / share if share > 1e-9 else math.inf


def wedge_angle(rake: float, friction: float, tool_friction: float) -> float:
    """β that makes N_γ least [rad], by golden section."""
    low, high = 1e-3, math.pi - rake - tool_friction - friction - 1e-6
    if high <= low:
        raise InvalidValueError("rake + friction [rad]", rake + tool_friction + friction, "below 180 degrees")
    high = min(high, 0.5 * math.pi - 1e-6)
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    a, b = high - ratio * (high - low), low + ratio * (high - low)
    for _ in range(80):
        if weight_factor(rake, a, friction, tool_friction) < weight_factor(rake, b, friction, tool_friction):
            high = b
        else:
            low = a
        a, b = high - ratio * (high - low), low + ratio * (high - low)
    return 0.5 * (low + high)


def mckyes(
    soil: DiggingSoil,
    width: float,
    depth: float,
    rake: float,
    surcharge: float = 0.0,
    speed: float = 0.0,
    density: float = 0.0,
    sides: bool = False,
) -> CuttingForce:
    """Force on a blade by McKyes' wedge.

    Args:
        width, depth: of the cut [m]. rake: [rad]. surcharge: [Pa]. speed: [m/s], with the soil's density [kg/m3].
        sides: with the crescents at the sides of a narrow blade.

    Raises:
        InvalidValueError: a soil, width, depth or rake out of range.
    """
    check_soil(soil)
    if not (width > 0.0 and depth >= 0.0):
        raise InvalidValueError("width and depth [m]", (width, depth), "above 0, 0 or above")
    if not math.radians(15.0) <= rake <= math.radians(130.0):
        raise InvalidValueError("rake [rad]", rake, "15 to 130 degrees")
    wedge = wedge_angle(rake, soil.friction, soil.tool_friction)
    turn = rake + soil.tool_friction
    slip = _cot(wedge + soil.friction)
    share = math.cos(turn) + math.sin(turn) * slip
    n_gamma = 0.5 * (_cot(rake) + _cot(wedge)) / share
    n_c = (1.0 + _cot(wedge) * slip) / share
    n_a = (1.0 - _cot(rake) * slip) / share
    n_v = (math.tan(wedge) + slip) / (share * (1.0 + math.tan(wedge) * _cot(rake)))
    of_weight, of_cohesion = 1.0, 1.0
    if sides and depth > 0.0:
        run = depth * (_cot(rake) + _cot(wedge))
        spread = math.sqrt(max(1.0 - (depth * _cot(rake) / run) ** 2, 0.0))
        of_weight += 2.0 * run / (3.0 * width) * spread
        of_cohesion += run / width * spread
    force = width * (
        soil.unit_weight * depth * depth * n_gamma * of_weight
        + soil.cohesion * depth * n_c * of_cohesion
        + surcharge * depth * 2.0 * n_gamma * of_cohesion
        + soil.adhesion * depth * n_a
        + density * speed * speed * depth * n_v
    )
    stuck = soil.adhesion * depth * width
    return CuttingForce(force * math.sin(turn) + stuck * _cot(rake), force * math.cos(turn) - stuck, wedge)


class Bucket(NamedTuple):
    """A bucket as Balovnev sees it."""

    width: float
    """[m]"""
    side_length: float
    """Of its side walls along the cut [m]."""
    side_thickness: float
    """[m]"""
    edge_thickness: float
    """Of its blunt cutting edge [m]."""
    edge_angle: float
    """Of the face of that edge, from the horizontal [rad]."""


def pressure_factor(angle: float, friction: float, tool_friction: float) -> float:
    """Balovnev's A of a face under an angle to the horizontal [rad]."""
    sine = math.sin(friction)
    bend = math.asin(math.sin(tool_friction) / sine)
    if angle < 0.5 * (bend - tool_friction):
        return (1.0 - sine * math.cos(2.0 * angle)) / (1.0 - sine)
    cosine = math.cos(tool_friction)
    root = math.sqrt(max(sine * sine - math.sin(tool_friction) ** 2, 0.0))
    fan = (2.0 * angle - math.pi + tool_friction + bend) * math.tan(friction)
    return cosine * (cosine + root) / (1.0 - sine) * math.exp(fan)


class CutCoefficients(NamedTuple):
    """Horizontal force of a cut as a polynomial of its depth: linear d + quadratic d² + cubic d³, and what a weight W
    of soil adds that lies on the wedge: W (of_pile + of_pile_by_depth d).
    """

    linear: float
    """[N/m]"""
    quadratic: float
    """[N/m2]"""
    cubic: float
    """[N/m3]"""
    of_pile: float
    """[-]"""
    of_pile_by_depth: float
    """[1/m]"""


def cut_coefficients(soil: DiggingSoil, width: float, rake: float) -> CutCoefficients:
    """McKyes' force with the crescents at the sides, without speed, for a kernel. Raises as `mckyes`.

    Soil that is pushed ahead is a surcharge on the wedge: its weight over the area w d (cot α + cot β) of the ground
    that the wedge lifts (as Luengo, Singh & Cannon 1998, IEEE/RSJ IROS, take the soil that a bucket has swept up).
    """

    def forward(depth: float) -> float:
        return mckyes(soil, width, depth, rake, sides=True).forward

    # three depths determine a polynomial of three terms
    one, two, three = forward(1.0), forward(2.0) / 2.0, forward(3.0) / 3.0
    cubic = 0.5 * (three - 2.0 * two + one)
    quadratic = two - one - 3.0 * cubic

    def by_pile(depth: float) -> float:
        bare = mckyes(soil, width, depth, rake, sides=True)
        surcharge = 1.0 / (width * depth * (_cot(rake) + _cot(bare.wedge)))
        return mckyes(soil, width, depth, rake, surcharge, sides=True).forward - bare.forward

    of_pile_by_depth = by_pile(2.0) - by_pile(1.0)
    of_pile = by_pile(1.0) - of_pile_by_depth
    return CutCoefficients(one - quadratic - cubic, quadratic, cubic, of_pile, of_pile_by_depth)


def balovnev(soil: DiggingSoil, bucket: Bucket, depth: float, rake: float, surcharge: float = 0.0) -> float:
    """Horizontal force on a bucket [N].

    Args:
        depth: of the cut [m]. rake: of the bucket's base [rad]. surcharge: [Pa].

    Raises:
        InvalidValueError: a soil, a depth or a rake out of range.
    """
    check_soil(soil)
    if depth < 0.0 or not math.radians(5.0) <= rake <= 0.5 * math.pi:
        raise InvalidValueError("depth [m] and rake [rad]", (depth, rake), "0 or above, and 5 to 90 degrees")
    phi, delta = soil.friction, soil.tool_friction
    active = (1.0 - math.sin(phi)) / (1.0 + math.sin(phi))
    bound = soil.cohesion * _cot(phi) + surcharge
    pressure = 0.5 * soil.unit_weight * depth + bound
    buried = soil.unit_weight * active * max(depth - bucket.side_length * math.sin(rake), 0.0)
    slope = math.tan(delta)
    base = bucket.width * depth * (1.0 + _cot(rake) * slope) * pressure_factor(rake, phi, delta) * (pressure + buried)
    edge_pressure = 0.5 * soil.unit_weight * bucket.edge_thickness + bound + depth * soil.unit_weight * active
    edge = bucket.width * bucket.edge_thickness * (1.0 + slope * _cot(bucket.edge_angle))
    edge *= pressure_factor(bucket.edge_angle, phi, delta) * edge_pressure
    walls = (2.0 * bucket.side_thickness + 4.0 * bucket.side_length * slope) * depth
    return base + edge + walls * pressure_factor(0.5 * math.pi, phi, delta) * (pressure + buried)
