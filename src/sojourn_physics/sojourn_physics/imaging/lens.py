"""Where a lens puts a direction on the image, and which direction a pixel sees.

Optical frame: z along the optical axis, x to the right of the image, y down (REP 103). With focal length f [px] and the
principal point (c_x, c_y) a direction (x, y, z) of angle θ to the axis falls on

    plumb_bob     u = f x'' + c_x,  v = f y'' + c_y,  with (x', y') = (x, y)/z,  r² = x'² + y'²,
                  x'' = x' (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x'y' + p2 (r² + 2x'²)
                  y'' = y' (1 + k1 r² + k2 r⁴ + k3 r⁶) + p1 (r² + 2y'²) + 2 p2 x'y'
    equidistant   (u, v) = f θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸) (x, y)/|(x, y)| + (c_x, c_y)

Integer (u, v) is the middle of a pixel. Sources: Brown (1971), Photogrammetric Engineering 37(8):855 (radial and
tangential distortion); Kannala & Brandt (2006), IEEE Trans. Pattern Anal. Mach. Intell. 28(8):1335 (fisheye). Names and
order of the coefficients: sensor_msgs/CameraInfo. The inverse has no closed form: Newton's method on the image plane.
"""

import math
from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, Params

COEFFICIENTS = {"plumb_bob": 5, "equidistant": 4}
ITERATIONS = 30
NEAR = 1e-9
"""A direction is found when it falls this near to its pixel, in units of the focal length [-]."""
CHECKED = 33
"""Places across an image at which a lens is checked when it is read [-]."""
STEP = 1e-6
"""Of the finite differences [-]."""


class LensParams(Params):
    """Image and lens of one camera."""

    columns: int = Field(ge=2, le=4096, description="width of the image [px]")
    rows: int = Field(ge=2, le=4096, description="height of the image [px]")
    horizontal_view_deg: float = Field(
        gt=0.0, lt=360.0, description="angle between the outer edges of the image [degree]"
    )
    model: Literal["plumb_bob", "equidistant"] = Field(
        default="plumb_bob", description="plumb_bob: perspective with distortion; equidistant: fisheye"
    )
    distortion: tuple[float, ...] = Field(
        default=(), description="coefficients as sensor_msgs/CameraInfo has them; left out: none [-]"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        count = COEFFICIENTS[self.model]
        if len(self.distortion) not in (0, count):
            raise ValueError(f"distortion has {len(self.distortion)} numbers: allowed are {count} for {self.model}")
        if self.model == "plumb_bob" and self.horizontal_view_deg >= 170.0:
            raise ValueError(
                f"horizontal_view_deg = {self.horizontal_view_deg:g}: allowed is less than 170 with plumb_bob; "
                "equidistant is for wider lenses"
            )
        self._check_corners()
        return self

    def _check_corners(self) -> None:
        """Raise ValueError where a distortion folds the image, or where pixels would see beyond straight behind."""
        if self.model == "plumb_bob" and not any(self.distortion):
            return
        (middle_u, middle_v), across = self.principal_point, np.linspace(-1.0, 1.0, CHECKED)
        u, v = np.meshgrid(middle_u * across, middle_v * across)
        with np.errstate(all="ignore"):  # what overflows is refused
            found = _undistorted(self, np.stack([u.ravel(), v.ravel()], axis=1) / self.focal_length)
        widest = float(np.hypot(found[:, 0], found[:, 1]).max())
        if self.model == "equidistant" and widest > math.pi:
            largest = math.floor(10.0 * self.horizontal_view_deg * math.pi / widest) / 10.0
            about = "about " if any(self.distortion) else ""
            raise ValueError(
                f"horizontal_view_deg = {self.horizontal_view_deg:g}: allowed is at most {about}{largest:g} with "
                f"{self.columns} x {self.rows} pixels, with which the corners of the image see straight behind"
            )

    @property
    def coefficients(self) -> FloatArray:
        """Of the distortion, all of them."""
        return np.array(self.distortion or (0.0,) * COEFFICIENTS[self.model])

    @property
    def focal_length(self) -> float:
        """With which the image's width has the angle asked, were there no distortion [px]."""
        half = 0.5 * math.radians(self.horizontal_view_deg)
        return 0.5 * self.columns / (math.tan(half) if self.model == "plumb_bob" else half)

    @property
    def principal_point(self) -> tuple[float, float]:
        """The middle of the image: u, v [px]."""
        return 0.5 * (self.columns - 1), 0.5 * (self.rows - 1)


def project(lens: LensParams, directions: FloatArray) -> FloatArray:
    """Where directions or points in the optical frame fall: shape (n, 3) to (n, 2), u and v [px]; NaN behind a
    perspective camera.
    """
    middle = np.array(lens.principal_point)
    return np.asarray(middle + lens.focal_length * _onto_plane(lens, np.asarray(directions, dtype=np.float64)))


def pixel_directions(lens: LensParams) -> FloatArray:
    """Unit vector in the optical frame that each pixel's middle sees, shape (rows, columns, 3).

    Raises:
        InvalidValueError: a distortion that folds the image over itself, so that a pixel sees nothing or two places.
    """
    u, v = np.meshgrid(np.arange(lens.columns, dtype=np.float64), np.arange(lens.rows, dtype=np.float64))
    middle_u, middle_v = lens.principal_point
    wanted = np.stack([(u - middle_u).ravel(), (v - middle_v).ravel()], axis=1) / lens.focal_length
    found = _undistorted(lens, wanted)
    return _rays(lens, found).reshape(lens.rows, lens.columns, 3)


def _rays(lens: LensParams, plane: FloatArray) -> FloatArray:
    """Unit vectors whose undistorted image is at `plane`, (n, 2)."""
    if lens.model == "plumb_bob":
        rays = np.column_stack([plane, np.ones(len(plane))])
        return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))
    angle = np.hypot(plane[:, 0], plane[:, 1])
    return np.column_stack([plane * np.sinc(angle / np.pi)[:, np.newaxis], np.cos(angle)])


def _onto_plane(lens: LensParams, directions: FloatArray) -> FloatArray:
    x, y, z = directions.T
    with np.errstate(divide="ignore", invalid="ignore"):
        if lens.model == "plumb_bob":
            plane = np.where(z > 0.0, directions[:, :2].T / z, np.nan).T
        else:
            across = np.hypot(x, y)
            angle = np.arctan2(across, z)
            plane = directions[:, :2] * np.where(across > 0.0, angle / across, 1.0)[:, np.newaxis]
    return _distorted(lens, plane)


def _distorted(lens: LensParams, plane: FloatArray) -> FloatArray:
    """Undistorted to distorted, (n, 2), in units of the focal length."""
    x, y = plane.T
    square, k = x * x + y * y, lens.coefficients
    if lens.model == "equidistant":
        radial = 1.0 + square * (k[0] + square * (k[1] + square * (k[2] + square * k[3])))
        return np.asarray(plane * radial[:, np.newaxis])
    radial = 1.0 + square * (k[0] + square * (k[1] + square * k[4]))
    return np.column_stack(
        [
            x * radial + 2.0 * k[2] * x * y + k[3] * (square + 2.0 * x * x),
            y * radial + k[2] * (square + 2.0 * y * y) + 2.0 * k[3] * x * y,
        ]
    )


def _undistorted(lens: LensParams, wanted: FloatArray) -> FloatArray:
    """The inverse of `_distorted` by Newton's method, from the distorted place itself."""
    if not lens.coefficients.any():
        return wanted
    found = wanted.copy()
    for _ in range(ITERATIONS):
        short = wanted - _distorted(lens, found)
        if np.abs(short).max() < NEAR:
            break
        (a, c), (b, d) = (
            ((_distorted(lens, found + step) - _distorted(lens, found - step)) / (2.0 * STEP)).T
            for step in (np.array([STEP, 0.0]), np.array([0.0, STEP]))
        )
        determinant = a * d - b * c
        if not (determinant > 0.0).all():  # the image turns back: what lies farther out falls farther in
            break
        found = found + np.column_stack(
            [
                (d * short[:, 0] - b * short[:, 1]) / determinant,
                (a * short[:, 1] - c * short[:, 0]) / determinant,
            ]
        )
    if not np.abs(wanted - _distorted(lens, found)).max() < NEAR:
        raise InvalidValueError("distortion", lens.distortion, "one that gives each pixel one direction")
    return found
