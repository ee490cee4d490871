"""Cameras that make images: one alone, or a stereo pair with the depth that it finds.

Frames: a camera sits on a link with x along the optical axis, z up in the image; its messages are in the optical frame
of that link (z ahead, x right, y down; REP 103), `LINK_optical`. The right camera of a pair is the baseline to the
right of the left one; as ROS has it for a rectified pair both are in the frame of the left one and the right one's
projection has the baseline. A camera without power says an image of no size.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sojourn_contract import stamps
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.values import CameraInfo, Image
from sojourn_machine.params import FloatArray
from sojourn_physics.imaging.camera import (
    LINK_TO_OPTICAL,
    DetectorParams,
    Optics,
    StereoParams,
    expose,
    exposure_for,
    optics,
    stereo_depth,
)
from sojourn_physics.imaging.lens import LensParams
from sojourn_physics.imaging.pixel_noise import pixel_noise
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_sensors.seeing import SeeingParams, SeeingSensor
from sojourn_sensors.sensor import SensorSite, Truth

SIZE = FieldRule("height width step", "px, byte", low=0.0, high=2.0**24)
EVERY = 50
"""Control periods from image to image."""


def _image(name: str, meaning: str) -> Topic:
    return Topic(f"/{{name}}/{name}", "sensor_msgs/Image", "sensors", (), EVERY, 3.0, meaning, (SIZE,))


def _info(name: str, meaning: str) -> Topic:
    lens = FieldRule("d k r p", "1, px", low=-1e6, high=1e6)
    return Topic(f"/{{name}}/{name}", "sensor_msgs/CameraInfo", "sensors", (), EVERY, 3.0, meaning, (lens,))


IMAGE = _image("image", "image of the camera, grey, 8 bits")
INFO = _info("camera_info", "lens and frame of the image")
LEFT = _image("left/image", "image of the left camera, grey, 8 bits")
LEFT_INFO = _info("left/camera_info", "lens and frame of the left image")
RIGHT = _image("right/image", "image of the right camera, grey, 8 bits")
RIGHT_INFO = _info("right/camera_info", "lens of the right image, and the baseline")
DEPTH = _image("depth", "depth along the axis for each pixel of the left image, 16 bits [mm]; 0 where it is not known")


class CameraSensorParams(SeeingParams):
    """One camera on its link: x of it along the optical axis, z up in the image."""

    kind: str = "camera"
    speaks_on: ClassVar[tuple[Any, ...]] = (IMAGE, INFO)
    lens: LensParams = Field(description="image and lens")
    detector: DetectorParams = Field(default=DetectorParams(), description="what makes an image of light")

    @property
    def optical_frames(self) -> tuple[tuple[str, str], ...]:
        return ((self.link, f"{self.link}_optical"),)

    @property
    def bytes_a_second(self) -> float:
        every = EVERY if self.timing is None else self.timing.every or EVERY
        return self.lens.rows * self.lens.columns * self.bytes_a_pixel / (every * stamps.CONTROL_PERIOD_S)

    @property
    def bytes_a_pixel(self) -> int:
        """Of all its images."""
        return 1

    def sensor(self, name: str, site: SensorSite) -> "Camera":
        """The camera of a machine."""
        return Camera(name, self, site)


class StereoCameraSensorParams(CameraSensorParams):
    """A pair of cameras; the left one is on the link."""

    kind: str = "stereo_camera"
    speaks_on: ClassVar[tuple[Any, ...]] = (LEFT, LEFT_INFO, RIGHT, RIGHT_INFO, DEPTH)
    stereo: StereoParams = Field(description="what the pair adds")

    @property
    def bytes_a_pixel(self) -> int:
        return 4

    def sensor(self, name: str, site: SensorSite) -> "CameraPair":
        """The pair of a machine."""
        return CameraPair(name, self, site)


@dataclass(frozen=True, eq=False, slots=True)
class Shot:
    """What one camera of a pair has taken."""

    image: NDArray[np.uint8]
    distance: NDArray[np.float32]
    """To what each pixel sees, infinite for the sky [m]."""


class Camera(SeeingSensor[CameraSensorParams, tuple[NDArray[Any], ...]]):
    """Its reading are its images."""

    every: ClassVar[int] = EVERY

    def __init__(self, name: str, params: CameraSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self.optics: Optics = optics(params.lens, params.detector)

    def read(self, ground: GroundMemory, truth: Truth) -> tuple[NDArray[Any], ...]:
        (shot,) = self.shoot(ground, truth, {self.name: 0.0})
        return (shot.image,)

    def shoot(self, ground: GroundMemory, truth: Truth, aside: Mapping[str, float]) -> list[Shot]:
        """Images from places so far to the right of the link [m], all with the exposure of the first, by the name of
        their noise.
        """
        here = self.outlook(truth)
        turn, place = here.turn @ LINK_TO_OPTICAL, here.place
        moment = self.site.scene.moment(truth.stamp, place, ground, here.body)
        seen = self.site.scene.scenery.see(self.optics, moment, turn, [place + x * turn[:, 0] for x in aside.values()])
        time = exposure_for(self.optics, seen[0][0])
        return [
            Shot(expose(self.optics, radiance, time, pixel_noise(self.site.seed, name, truth.stamp)), distance)
            for name, (radiance, distance) in zip(aside, seen, strict=True)
        ]

    def messages(self, stamp: int, reading: tuple[NDArray[Any], ...] | None) -> Iterator[tuple[str, Any]]:
        image, info = self.rows
        yield image.name, self.image(stamp, None if reading is None else reading[0])
        yield info.name, self.info(stamp, 0.0)

    def image(self, stamp: int, image: NDArray[Any] | None) -> Image:
        """The message of an image, of no size for None."""
        pixels: NDArray[Any] = np.zeros((0, 0), dtype=np.uint8) if image is None else image
        encoding = "16UC1" if pixels.dtype == np.uint16 else "mono8"
        rows, columns = pixels.shape
        return Image(stamp, self._frame, rows, columns, encoding, columns * pixels.itemsize, pixels.tobytes())

    def info(self, stamp: int, baseline: float) -> CameraInfo:
        """The message of the lens, of a camera so far to the right [m]."""
        lens = self.params.lens
        f, (u, v) = lens.focal_length, lens.principal_point
        matrix: FloatArray = np.array([[f, 0.0, u], [0.0, f, v], [0.0, 0.0, 1.0]])
        projection = np.column_stack([matrix, [-f * baseline, 0.0, 0.0]])
        flat = (matrix.ravel(), np.eye(3).ravel(), projection.ravel())
        return CameraInfo(stamp, self._frame, lens.rows, lens.columns, lens.model, lens.coefficients, *flat)

    @property
    def _frame(self) -> str:
        ((_, frame),) = self.params.optical_frames
        return frame


class CameraPair(Camera):
    """Its reading are the left image, the right one and the depth."""

    params: StereoCameraSensorParams

    def read(self, ground: GroundMemory, truth: Truth) -> tuple[NDArray[Any], ...]:
        pair = self.params.stereo
        left, right = self.shoot(ground, truth, {self.name: 0.0, f"{self.name}.right": pair.baseline})
        noise = pixel_noise(self.site.seed, f"{self.name}.depth", truth.stamp)
        return left.image, right.image, stereo_depth(self.optics, pair, (left.distance, left.image), noise)

    def messages(self, stamp: int, reading: tuple[NDArray[Any], ...] | None) -> Iterator[tuple[str, Any]]:
        left, left_info, right, right_info, depth = self.rows
        images = (None, None, None) if reading is None else reading
        for row, image in zip((left, right, depth), images, strict=True):
            yield row.name, self.image(stamp, image)
        yield left_info.name, self.info(stamp, 0.0)
        yield right_info.name, self.info(stamp, self.params.stereo.baseline)
