"""How much of the Sun's disc is seen past a horizon or another body, and how large the disc is.

Below a straight edge that the centre of a disc of radius rho stands d above, x = d/rho within -1 and 1:

    seen = 1 - (acos x - x sqrt(1 - x^2)) / pi

Behind a disc of radius R whose centre is theta away, the two overlap in a lens of area

    A = rho^2 (a - sin a cos a) + R^2 (b - sin b cos b),  seen = 1 - A / (pi rho^2)
    tan a = w / (theta^2 + rho^2 - R^2),  tan b = w / (theta^2 + R^2 - rho^2)
    w^2 = (R + rho - theta)(theta + rho - R)(theta - rho + R)(theta + rho + R)

By tangents, as the cosines of a and b lose all digits where one disc is far the larger. Angles as lengths in a plane,
and the disc as evenly bright. Source: the lens of two circles, as in Montenbruck and Gill (2000), Satellite Orbits,
sec. 3.4.2 (eclipse conditions); the shadow is the cone of umbra and penumbra. The air of an eclipsing planet bends no
light.
"""

import math

SOLAR_RADIUS = 6.957e8
"""Nominal radius of the Sun (IAU 2015, resolution B3) [m]."""


def disc_radius(radius: float, distance: float) -> float:
    """Angular radius of a sphere seen from a distance of its centre; a right angle on it [rad]."""
    return math.asin(min(radius / distance, 1.0))


def seen_over_edge(above: float, disc: float) -> float:
    """Part of a disc that is seen over a straight edge, 0 to 1.

    Args:
        above: how far its centre stands over the edge [rad]. disc: its radius, more than zero [rad].
    """
    x = max(-1.0, min(1.0, above / disc))
    return 1.0 - (math.acos(x) - x * math.sqrt(1.0 - x * x)) / math.pi


def seen_past_disc(apart: float, disc: float, cover: float) -> float:
    """Part of a disc that is seen past another one before it, 0 to 1.

    Args:
        apart: between the centres [rad]. disc: radius of the hidden disc, more than zero. cover: of the other [rad].
    """
    if apart >= disc + cover:
        return 1.0
    if apart <= cover - disc:
        return 0.0
    if apart <= disc - cover:
        return 1.0 - (cover / disc) ** 2
    product = (cover + disc - apart) * (apart + disc - cover) * (apart - disc + cover) * (apart + disc + cover)
    root = math.sqrt(max(product, 0.0))
    lens = _segment(disc, math.atan2(root, (apart - cover) * (apart + cover) + disc * disc))
    lens += _segment(cover, math.atan2(root, (apart - disc) * (apart + disc) + cover * cover))
    return max(0.0, min(1.0, 1.0 - lens / (math.pi * disc * disc)))


def _segment(radius: float, half_angle: float) -> float:
    """Area that a chord cuts from a circle which it is seen in under twice this angle."""
    return 0.5 * radius * radius * (2.0 * half_angle - math.sin(2.0 * half_angle))
