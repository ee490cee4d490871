"""Cameras that make images: one alone, or a stereo pair with the depth that it finds.

Frames: a camera sits on a link with x along the optical axis, z up in the image; its messages are in the optical frame
of that link (z ahead, x right, y down; REP 103), `LINK_optical`. The right camera of a pair is the baseline to the
right of the left one; as ROS has it for a rectified pair both are in the frame of the left one and the right one's
projection has the baseline. A camera without power says an image of no size.

Another thread makes the images of a moment while the run goes on; whoever asks for their pixels waits for them.

Dust on a lens stays where it is. It is far out of focus: behind a grain there is a soft patch, grey with light of the
whole scene that it scatters, and darker than that. A pair finds no depth where a grain hides the place from one of its
lenses.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sojourn_contract import stamps
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.unfinished import Unfinished, begun, shared
from sojourn_contract.unfinished_image import UnfinishedImage, finished
from sojourn_contract.values import CameraInfo, Image
from sojourn_machine.chance import mixed
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_faults import SensorFaultParams
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
from sojourn_physics.imaging.scenery import Moment
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_sensors.fault_hooks import SPECK, FaultNow
from sojourn_sensors.seeing import SeeingParams, SeeingSensor
from sojourn_sensors.sensor import SensorSite, Truth

SIZE = FieldRule("height width step", "px, byte", low=0.0, high=2.0**24)
EVERY = 50
"""Control periods from image to image."""
GREY = 0.5
"""Of the mean number of an image, what is behind dust: an estimate [-]."""
MONO, DEPTHS = "mono8", "16UC1"
BYTES = {MONO: 1, DEPTHS: 2}
"""Of a pixel."""
Images: TypeAlias = tuple[NDArray[Any], ...]
SOFT = 0.25
"""Spread of the edge of a grain's patch, of the width of a grain: an estimate [-]."""


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
    quantities: ClassVar[tuple[str, ...] | None] = ()
    has_lens: ClassVar[bool] = True
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
class CameraSight:
    """All that images follow from, as far as it changes."""

    stamp: int
    """[ns]"""
    turn: FloatArray
    """From the optical frame into map, (3, 3)."""
    place: FloatArray
    """Of the link in map, (3,) [m]."""
    moment: Moment


@dataclass(frozen=True, eq=False, slots=True)
class Shot:
    """What one camera of a pair has taken."""

    image: NDArray[np.uint8]
    radiance: NDArray[np.float32]
    """That each pixel sees [W/m2/sr]."""
    distance: NDArray[np.float32]
    """To what each pixel sees, infinite for the sky [m]."""
    time: float
    """Of exposure [s]."""


class Camera(SeeingSensor[CameraSensorParams, Unfinished[Images] | Images]):
    """Its reading are its images; those of a checkpoint are whole."""

    every: ClassVar[int] = EVERY
    encodings: ClassVar[tuple[str, ...]] = (MONO,)
    """Of its images."""

    def __init__(self, name: str, params: CameraSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self.optics: Optics = optics(params.lens, params.detector)
        self._grains = lru_cache(maxsize=4)(self._grains_of)  # they stay where they are

    def read(self, ground: GroundMemory, truth: Truth) -> Unfinished[Images]:
        return begun(partial(self.images, self.view(ground, truth)))

    def view(self, ground: GroundMemory, truth: Truth) -> CameraSight:
        """Of the truth, over ground to which so much has been done."""
        here = self.outlook(truth)
        moment = self.site.scene.moment(truth.stamp, here.place, ground, here.body)
        return CameraSight(truth.stamp, here.turn @ LINK_TO_OPTICAL, here.place, moment)

    def images(self, view: CameraSight) -> Images:
        """Made in whatever thread calls it."""
        return tuple(shot.image for shot in self.shoot(view, {self.name: 0.0}))

    def shoot(self, view: CameraSight, aside: Mapping[str, float]) -> list[Shot]:
        """Images from places so far to the right of the link [m], all with the exposure of the first, by the name of
        their noise.
        """
        places = [view.place + x * view.turn[:, 0] for x in aside.values()]
        seen = self.site.scene.scenery.see(self.optics, view.moment, view.turn, places, shared)
        time = exposure_for(self.optics, seen[0][0])
        exposed = [
            partial(self._exposed, name, view.stamp, radiance, time)
            for name, (radiance, _) in zip(aside, seen, strict=True)
        ]
        return [Shot(image, *both, time) for image, both in zip(shared(exposed), seen, strict=True)]

    def _exposed(self, name: str, stamp: int, radiance: NDArray[np.float32], time: float) -> NDArray[np.uint8]:
        return expose(self.optics, radiance, time, pixel_noise(self.site.seed, name, stamp))

    def faulted(self, reading: Unfinished[Images] | Images, fault: FaultNow) -> Unfinished[Images] | Images:
        """Dust on the lens; an image has no numbers that other faults change."""
        if fault.params.dust == 0.0:
            return super().faulted(finished(reading), fault)
        behind = partial(self._behind, fault)
        return reading.then(behind) if isinstance(reading, Unfinished) else behind(reading)

    def _behind(self, fault: FaultNow, images: Images) -> Images:
        """What is seen of images behind dust."""
        (image,) = images
        return (self._dimmed(image, self.cover(fault)),)

    def cover(self, fault: FaultNow) -> NDArray[np.float32]:
        """Part of the light of each pixel that dust on the lens takes, (rows, columns) [-]."""
        return self._grains(fault.stream, fault.params.dust)

    def _grains_of(self, stream: int, dust: float) -> NDArray[np.float32]:
        from scipy.ndimage import gaussian_filter  # here: a camera without dust need not wait for it to load

        lens, fault = self.params.lens, FaultNow(SensorFaultParams(dust=dust), 0.0, stream, 0)
        hidden = fault.hidden(self.optics.rays.reshape(-1, 3) @ LINK_TO_OPTICAL.T)
        soft = SOFT * SPECK / self.optics.pixel
        grains = gaussian_filter(hidden.reshape(lens.rows, lens.columns).astype(np.float32), soft, mode="nearest")
        return np.asarray(np.clip(grains, 0.0, 1.0))

    @staticmethod
    def _dimmed(image: NDArray[np.uint8], cover: NDArray[np.float32]) -> NDArray[np.uint8]:
        """What of an image is seen behind dust."""
        return np.asarray(np.rint(image + cover * (GREY * image.mean() - image)), dtype=np.uint8)

    def messages(self, stamp: int, reading: Unfinished[Images] | Images | None) -> Iterator[tuple[str, Any]]:
        image, info = self.rows
        yield image.name, self.image(stamp, reading, 0)
        yield info.name, self.info(stamp, 0.0)

    def image(self, stamp: int, reading: Unfinished[Images] | Images | None, place: int) -> Image:
        """The message of one of the images of a reading, of no size without power."""
        lens, encoding = self.params.lens, self.encodings[place]
        if reading is None:
            return Image(stamp, self._frame, 0, 0, MONO, 0, b"")
        head = (stamp, self._frame, lens.rows, lens.columns, encoding, lens.columns * BYTES[encoding])
        if isinstance(reading, Unfinished):
            return UnfinishedImage(*head, reading.then(lambda images: images[place].tobytes()))  # type: ignore[arg-type]
        return Image(*head, reading[place].tobytes())

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
    encodings: ClassVar[tuple[str, ...]] = (MONO, MONO, DEPTHS)

    def images(self, view: CameraSight) -> Images:
        pair = self.params.stereo
        left, right = self.shoot(view, {self.name: 0.0, f"{self.name}.right": pair.baseline})
        noise = pixel_noise(self.site.seed, f"{self.name}.depth", view.stamp)
        depth = stereo_depth(self.optics, pair, (left.radiance, left.distance), left.time, noise)
        return left.image, right.image, depth

    def _behind(self, fault: FaultNow, images: Images) -> Images:
        """Dust is on both lenses, on each in other places; where it hides a place from one there is no depth."""
        left, right, depth = images
        on_left, on_right = self.cover(fault), self.cover(replace(fault, stream=mixed(fault.stream)))
        rows, columns = np.nonzero(depth)
        scale = 1000.0 * self.params.lens.focal_length * self.params.stereo.baseline
        there = np.clip(np.rint(columns - scale / depth[rows, columns]).astype(int), 0, None)
        hidden = (on_left[rows, columns] > 0.5) | (on_right[rows, there] > 0.5)
        depth = depth.copy()
        depth[rows[hidden], columns[hidden]] = 0
        return self._dimmed(left, on_left), self._dimmed(right, on_right), depth

    def messages(self, stamp: int, reading: Unfinished[Images] | Images | None) -> Iterator[tuple[str, Any]]:
        left, left_info, right, right_info, depth = self.rows
        for place, row in enumerate((left, right, depth)):
            yield row.name, self.image(stamp, reading, place)
        yield left_info.name, self.info(stamp, 0.0)
        yield right_info.name, self.info(stamp, self.params.stereo.baseline)
