"""A camera: from radiance to the numbers of an image, and from distance to the depth that a stereo pair finds.

Exposure t gathers in a pixel, for light of radiance L (the whole spectrum) that comes in at the angle θ to the axis,

    N = E + n,   E = g L t cos^v θ,   n normal of variance E + N_r²        (photons, then what reads them out)

electrons, v = 4 for a plain lens (the cosine-fourth law), which a number of 8 bits stands for, 255 (N/N_full)^γ with γ
= 1/2: the square root keeps the noise of photons the same in bright and dark. What is beyond the full well is cut off
last: a pixel with much too much light says 255, without noise. The exposure is set from the image itself, as automatic
ones settle: so that the brightest part of it, a percentile, comes to a part of the full well, within the shortest and
the longest: where it is dark the image stays dark.

Stereo: the depth z is found from the disparity d = f b/z with an error of σ_d pixels, as in `sensors/hazcam`; not
nearer than `nearest`, farther than `range`, nor where

- the light of the left pixel, without its noise, stands for less than `darkest` or for 255, or is less than DETECTED
  times what the read-out adds: E < 5 N_r. What noise alone has made bright is the same place in no other image;
- the place is beyond the edge of the right image: u - d < 0.

Sources: Healey & Kondepudy (1994), IEEE Trans. Pattern Anal. Mach. Intell. 16(3):267 (noise of a camera); Maki et al.
(2003), J. Geophys. Res. 108(E12):8071 (Navcam of the Mars Exploration Rovers: full well 170000 electrons, 25 of noise,
12 bits sent as the 8 of their square root); Rose (1948), J. Opt. Soc. Am. 38(2):196 (what is told from noise stands
above it by a factor of five). Assumptions: no dark current, no smear, no stray light; the noise of a pair's depth is
independent from pixel to pixel; what the left camera sees well the right one does too. So a strip beside what is near,
which that hides from the right camera, is matched all the same, where a real pair finds nothing or the depth of what is
near. A place is beyond the edge if it is beyond the outermost direction of its row: through a lens that distorts, whose
edge is bent, that is so by some pixels.
"""

import math
from dataclasses import dataclass
from typing import Self
from zlib import crc32

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray, Params
from sojourn_physics.imaging.lens import LensParams, pixel_directions
from sojourn_physics.imaging.pixel_noise import PixelNoise, fill_normals, room_for

FULL = 255
"""The largest number of an image."""
DETECTED = 5.0
"""Least light that is told from the noise of the read-out, in standard deviations of it [-]."""
LINK_TO_OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""From the optical frame (z ahead, x right, y down) to that of a link (x ahead, y left, z up)."""


class DetectorParams(Params):
    """What makes an image of light."""

    sensitivity: float = Field(
        default=5e4, gt=0.0, le=1e12, description="g: electrons of a pixel for each W/m2/sr and second [-]"
    )
    full_well: float = Field(default=170_000.0, gt=1.0, le=1e9, description="most electrons of a pixel [-]")
    read_noise: float = Field(default=25.0, ge=0.0, le=1e6, description="N_r: standard deviation in the dark [-]")
    vignetting: float = Field(default=4.0, ge=0.0, le=8.0, description="v: power of the cosine of the angle [-]")
    shortest_exposure: float = Field(default=1e-4, gt=0.0, le=1e3, description="[s]")
    longest_exposure: float = Field(default=5.0, gt=0.0, le=1e3, description="[s]")
    gamma: float = Field(default=0.5, gt=0.1, le=1.0, description="power by which numbers stand for electrons [-]")
    bright_part: float = Field(
        default=0.98, gt=0.0, le=1.0, description="part of the pixels that are darker than ... [-]"
    )
    aim: float = Field(default=0.8, gt=0.0, le=1.0, description="... this part of the full well [-]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.shortest_exposure <= self.longest_exposure:
            raise ValueError(
                f"shortest_exposure = {self.shortest_exposure}: "
                f"allowed is at most longest_exposure = {self.longest_exposure}"
            )
        return self


class StereoParams(Params):
    """What a pair adds to a camera."""

    baseline: float = Field(gt=0.0, le=5.0, description="of the right camera to the right of the left [m]")
    nearest: float = Field(default=0.3, ge=0.0, le=10.0, description="shortest depth that is matched [m]")
    range: float = Field(default=30.0, gt=0.0, le=65.0, description="longest depth that is matched [m]")
    disparity_noise_px: float = Field(default=0.25, ge=0.0, le=10.0, description="standard deviation of a match [px]")
    darkest: int = Field(default=6, ge=0, le=FULL, description="least number of a pixel that can be matched [-]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.nearest < self.range:
            raise ValueError(f"nearest = {self.nearest}: allowed is less than range = {self.range}")
        return self


@dataclass(frozen=True, eq=False, slots=True)
class Optics:
    """A lens and detector, ready for the kernels."""

    lens: LensParams
    detector: DetectorParams
    directions: NDArray[np.float32]
    """Unit vectors in the optical frame, one part after another, (3, rows, columns)."""
    dimming: NDArray[np.float32]
    """cos^v of each pixel, (rows, columns)."""

    @property
    def rays(self) -> NDArray[np.float32]:
        """The directions, pixel by pixel, (rows, columns, 3)."""
        return np.moveaxis(self.directions, 0, 2)

    @property
    def pixel(self) -> float:
        """Angle of a pixel in the middle of the image [rad]."""
        return 1.0 / self.lens.focal_length


def optics(lens: LensParams, detector: DetectorParams) -> Optics:
    """Raises InvalidValueError as `pixel_directions`."""
    directions = np.moveaxis(pixel_directions(lens), 2, 0)
    dimming = np.clip(directions[2], 0.0, 1.0) ** detector.vignetting
    return Optics(lens, detector, np.ascontiguousarray(directions, dtype=np.float32), dimming.astype(np.float32))


def noise_of(seed: int, name: str, stamp: int) -> np.random.Generator:
    """Random numbers of one reading: the same for the same sensor and stamp [ns] whatever went before."""
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, crc32(name.encode()), stamp])))


def exposure_for(eye: Optics, radiance: NDArray[np.float32]) -> float:
    """Time of exposure for a scene [s]; radiance: (rows, columns) [W/m2/sr]."""
    detector = eye.detector
    bright = float(np.quantile(radiance[::4, ::4] * eye.dimming[::4, ::4], detector.bright_part))
    wanted = detector.aim * detector.full_well / (detector.sensitivity * bright) if bright > 0.0 else math.inf
    return min(max(wanted, detector.shortest_exposure), detector.longest_exposure)


def expose(eye: Optics, radiance: NDArray[np.float32], time: float, noise: PixelNoise) -> NDArray[np.uint8]:
    """An image, (rows, columns); radiance likewise [W/m2/sr]; time of exposure [s]."""
    detector = eye.detector
    gain = detector.sensitivity * time
    image: NDArray[np.uint8] = _expose(
        radiance, eye.dimming, noise, np.array([gain, detector.full_well, detector.read_noise, detector.gamma])
    )
    return image


@njit(cache=True, nogil=True)
def _expose(
    radiance: NDArray[np.float32], dimming: NDArray[np.float32], noise: PixelNoise, detector: FloatArray
) -> NDArray[np.uint8]:
    image = np.empty(radiance.shape, dtype=np.uint8)
    words, normals = room_for(radiance.shape[1])
    gain, well, dark = np.float32(detector[0]), np.float32(detector[1]), np.float32(detector[2] * detector[2])
    gamma, full = np.float32(detector[3]), np.float32(FULL)
    for i in range(radiance.shape[0]):
        fill_normals(noise, i, words, normals)
        for j in range(radiance.shape[1]):
            electrons = gain * radiance[i, j] * dimming[i, j]
            electrons += normals[j] * np.float32(math.sqrt(electrons + dark))
            part = min(max(electrons / well, np.float32(0.0)), np.float32(1.0))
            part = math.sqrt(part) if gamma == np.float32(0.5) else part**gamma  # a power costs ten times a root
            image[i, j] = np.uint8(full * part + np.float32(0.5))
    return image


def stereo_depth(
    eye: Optics,
    pair: StereoParams,
    seen: tuple[NDArray[np.float32], NDArray[np.float32]],
    time: float,
    noise: PixelNoise,
) -> NDArray[np.uint16]:
    """Depth along the optical axis that the pair finds, (rows, columns) [mm]; 0 where it finds none.

    Args:
        seen: by the left camera, without noise: radiance [W/m2/sr] and distance [m], each (rows, columns).
        time: of exposure [s].
    """
    radiance, distance = seen
    gain = eye.detector.sensitivity * time
    least, most = _matched_light(eye.detector, pair)
    scale = eye.lens.focal_length * pair.baseline
    light = [least / gain, most / gain]
    numbers = np.array([scale, pair.nearest, pair.range, pair.disparity_noise_px, pair.baseline, *light])
    depth: NDArray[np.uint16] = _stereo_depth(distance, radiance, eye.directions, eye.dimming, noise, numbers)
    return depth


def _matched_light(detector: DetectorParams, pair: StereoParams) -> tuple[float, float]:
    """Least light that is matched, and what is too much, in electrons: those that stand for the numbers, rounded."""

    def standing_for(number: float) -> float:
        return detector.full_well * math.pow(max(number - 0.5, 0.0) / FULL, 1.0 / detector.gamma)

    return max(standing_for(pair.darkest), DETECTED * detector.read_noise), standing_for(FULL)


@njit(cache=True, nogil=True, error_model="numpy")
def _stereo_depth(
    distance: NDArray[np.float32],
    radiance: NDArray[np.float32],
    directions: NDArray[np.float32],
    dimming: NDArray[np.float32],
    noise: PixelNoise,
    pair: FloatArray,
) -> NDArray[np.uint16]:
    depth = np.zeros(distance.shape, dtype=np.uint16)
    words, normals = room_for(distance.shape[1])
    right, ahead = directions[0], directions[2]
    scale, nearest, farthest, sigma, baseline = pair[0], pair[1], pair[2], pair[3], pair[4]
    least, most = np.float32(pair[5]), np.float32(pair[6])
    for i in range(distance.shape[0]):
        fill_normals(noise, i, words, normals)
        edge = right[i, 0] / ahead[i, 0] if ahead[i, 0] > 0.0 else np.float32(-np.inf)
        for j in range(distance.shape[1]):
            true = distance[i, j] * ahead[i, j]
            if not (nearest <= true <= farthest and least <= radiance[i, j] * dimming[i, j] < most):
                continue
            if distance[i, j] * right[i, j] - baseline < edge * true:  # the right camera does not see it
                continue
            disparity = scale / true + sigma * normals[j]
            if disparity * farthest >= scale:
                depth[i, j] = np.uint16(1000.0 * scale / disparity + 0.5)
    return depth
