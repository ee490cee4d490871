"""Images of a stereo pair as the drive's input: both of one moment, rectified."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sojourn_config.known_machine import KnownMachine
from sojourn_contract import stamps
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.stereo_pair import PairTopics, pair_in_use
from sojourn_contract.values import CameraInfo, Image
from sojourn_flight.odometry.stereo_geometry import PinholePair
from sojourn_flight.odometry.visual_state import StereoImages

MODELS = ("plumb_bob", "equidistant")


class StereoInput:
    """Takes each pair once.

    Args:
        known: the machine; of one whose drive goes by no images there are none.
    """

    def __init__(self, known: KnownMachine) -> None:
        self._topics: PairTopics | None = pair_in_use(known)

    def images(self, stamp: int, inputs: Mapping[str, Any], last: int) -> tuple[StereoImages | None, int]:
        """The pair that belongs to this period [ns], None where there is none, it is late, or it has been taken before;
        and the stamp of the last that was looked at [ns].

        What is compared with it is where the machine is now: a pair that comes later than by a period is not used.

        Raises:
            RefusedMessageError: images or lenses that are none of a rectified pair.
        """
        if self._topics is None:
            return None, last
        left, left_info, right, right_info = (inputs.get(name) for name in self._topics)
        if left is None or right is None or left_info is None or right_info is None or left.stamp <= last:
            return None, last
        moments = {left.stamp, right.stamp}
        if len(moments) > 1 or not 0 <= stamp - left.stamp <= stamps.CONTROL_PERIOD_NS:
            return None, left.stamp
        both = [_pixels(name, image) for name, image in ((self._topics.left, left), (self._topics.right, right))]
        pair = pinhole_pair(self._topics.right_info, left_info, right_info)
        if both[0].shape != both[1].shape:
            raise RefusedMessageError(
                self._topics.right, "height width", both[1].shape, f"{both[0].shape}, as the left one"
            )
        if left_info.distortion.any() and both[0].size:
            both = [_rectified(image, info) for image, info in zip(both, (left_info, right_info), strict=True)]
        return StereoImages(both[0], both[1], pair), left.stamp


def pinhole_pair(topic: str, left: CameraInfo, right: CameraInfo) -> PinholePair:
    """The lenses of a rectified pair. Raises RefusedMessageError for what is none."""
    f, u, v = (float(left.intrinsic[place]) for place in (0, 2, 5))
    if not (np.isfinite(left.intrinsic).all() and f > 0.0):
        raise RefusedMessageError(topic, "k", f, "a finite focal length above 0 px")
    if not np.array_equal(left.intrinsic, right.intrinsic) or not np.array_equal(left.distortion, right.distortion):
        raise RefusedMessageError(
            topic, "k d", right.intrinsic.tolist(), "that of the left camera: the pair is not one"
        )
    baseline = -float(right.projection[3]) / f
    if not (np.isfinite(baseline) and baseline > 0.0):
        raise RefusedMessageError(topic, "p[3]", float(right.projection[3]), "below 0: the right camera to the right")
    return PinholePair(f, (u, v), baseline)


def _pixels(topic: str, image: Image) -> NDArray[np.uint8]:
    """Shape (rows, columns)."""
    if image.encoding != "mono8":
        raise RefusedMessageError(topic, "encoding", image.encoding, "mono8")
    rows, columns = image.height, image.width
    if image.step < columns or len(image.data) != rows * image.step:
        raise RefusedMessageError(topic, "data", f"{len(image.data)} bytes", f"{rows} rows of {image.step} bytes")
    return np.frombuffer(image.data, dtype=np.uint8).reshape(rows, image.step)[:, :columns]


def _rectified(image: NDArray[np.uint8], info: CameraInfo) -> NDArray[np.uint8]:
    """As a lens without distortion would have made it."""
    import cv2  # here: most drives go by no images

    matrix = info.intrinsic.reshape(3, 3)
    size = image.shape[::-1]
    if info.distortion_model == "plumb_bob":
        maps = cv2.initUndistortRectifyMap(matrix, info.distortion, np.eye(3), matrix, size, cv2.CV_32FC1)
    elif info.distortion_model == "equidistant":
        maps = cv2.fisheye.initUndistortRectifyMap(matrix, info.distortion, np.eye(3), matrix, size, cv2.CV_32FC1)
    else:
        raise RefusedMessageError(
            "camera_info", "distortion_model", info.distortion_model, "one of " + ", ".join(MODELS)
        )
    return np.asarray(cv2.remap(image, *maps, cv2.INTER_CUBIC), dtype=np.uint8)
