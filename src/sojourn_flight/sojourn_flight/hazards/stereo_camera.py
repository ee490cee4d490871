"""The stereo camera as obstacle handling knows it: where it is, and how far off the height of one of its points is.

With depth z along the optical axis, focal length f [px], baseline b and a match that is sigma_d [px] off

    sigma_z = z^2 sigma_d / (f b),

and the point moves along its ray. On smooth ground it is not the whole way up or down of this motion that counts as
an error of height, but what is left of it over the ground where it comes to lie; for ground that is level

    sigma_h = sigma_z |u_z| / c = (sigma_d / (f b)) r^2 c |u_z|,      c = u . axis,

for a point at distance r along the unit vector u: at a height H under the camera about H r c sigma_d / (f b), so that
it grows with the distance and not with its square.

Source: Matthies & Shafer (1987), IEEE J. Robotics and Automation 3(3):239 (error of stereo). Assumptions: errors of
different points are independent and normal (first order in the error of the match); that of direction is left out.
"""

from dataclasses import dataclass

import numpy as np

from sojourn_machine.params import FloatArray


@dataclass(frozen=True, eq=False, slots=True)
class StereoCamera:
    """A stereo pair on the rover."""

    position: FloatArray
    """In base_link, shape (3,) [m]."""
    axis: FloatArray
    """Unit vector along the optical axis in base_link, shape (3,)."""
    depth_noise: float
    """Standard deviation of a depth over its square, sigma_d / (f b) [1/m]."""


def height_variances(camera: StereoCamera, points: FloatArray, up: FloatArray) -> FloatArray:
    """Variance of the height of each point [m^2], shape (n,).

    Args:
        points: in base_link, shape (n, 3) [m]. up: the vertical in base_link, a unit vector of shape (3,).
    """
    return np.asarray((along_rays(camera, points) @ up) ** 2)


def along_rays(camera: StereoCamera, points: FloatArray) -> FloatArray:
    """By which each point is off for one standard deviation of its match, in base_link, shape (n, 3) [m]."""
    rays = points - camera.position
    return np.asarray(camera.depth_noise * (rays @ camera.axis)[:, np.newaxis] * rays)
