"""What the machine's eyes see, and where they look."""

from typing import Any, ClassVar

import numpy as np
import viser
from numpy.typing import NDArray

from sojourn_console.machine_shape import MachineShape
from sojourn_console.model import PIXELS, RunScene
from sojourn_console.views.view import YELLOW, Shown, wxyz
from sojourn_console.world import World
from sojourn_contract.values import Image
from sojourn_machine.params import FloatArray

LINK_TO_OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Columns: axes of the optical frame (x right, y down, z ahead; REP 103) in a camera's link (x ahead, z up)."""
FRUSTUM = 0.35
"""Length of a drawn frustum [m]."""
MOVED = 1e-4
"""Of where a frustum is [m], and of its axes: less is not seen, and not sent."""
WIDEST = 512
"""Columns of an image in the scene at most."""


class CloudView:
    """The newest points of the hazard camera, from where it saw them; the higher over the plane of the wheels, the
    redder.
    """

    title: ClassVar[str] = "hazard cloud"
    needs: ClassVar[tuple[str, ...]] = ("/hazcam/points",)
    starts_shown: ClassVar[bool] = True

    def __init__(self, server: viser.ViserServer, _world: World) -> None:
        self._server = server
        self._points, self._drawn = Shown(), np.zeros((0, 3))

    def show(self, scene: RunScene) -> None:
        if scene.cloud is self._drawn:
            return
        self._drawn = scene.cloud
        if not len(scene.cloud) or scene.cloud_pose is None:
            self._points.remove()
            return
        self._points.put(
            self._server.scene.add_point_cloud(
                "/cloud",
                scene.cloud.astype(np.float32),
                height_colors(scene.cloud[:, 2]),
                point_size=0.025,
                position=scene.cloud_pose.position,
                wxyz=wxyz(scene.cloud_pose.orientation),
            )
        )

    def hide(self) -> None:
        self._points.remove()
        self._drawn = np.zeros((0, 3))


class CameraView:
    """Frustums of the cameras on the machine, with the newest image in each that sends some."""

    title: ClassVar[str] = "cameras"
    needs: ClassVar[tuple[str, ...]] = ()
    starts_shown: ClassVar[bool] = True

    def __init__(self, server: viser.ViserServer, world: World) -> None:
        self._server, self._world = server, world
        self._shape = MachineShape(world.scenario.urdf_xml)
        self._frustums: dict[str, Any] = {}
        self._places: dict[str, FloatArray] = {}
        self._images: dict[str, Image] = {}

    def show(self, scene: RunScene) -> None:
        for camera in self._world.cameras:
            place = self._shape.link(camera.link, scene.joints)
            if place is None:
                continue
            image = scene.images.get(camera.topic)
            if camera.name not in self._frustums:
                self._frustums[camera.name] = self._server.scene.add_camera_frustum(
                    f"/machine/camera_{camera.name}",
                    fov=camera.view,
                    aspect=camera.aspect,
                    scale=FRUSTUM,
                    color=YELLOW,
                    thickness=0.006,
                    cast_shadow=False,
                )
            frustum = self._frustums[camera.name]
            self._put(camera.name, *place)
            frustum.visible = True
            if image is not None and image is not self._images.get(camera.name) and image.width and image.height:
                self._images[camera.name] = image
                frustum.image = pixels(image)

    def hide(self) -> None:
        for frustum in self._frustums.values():
            frustum.visible = False

    def _put(self, name: str, position: FloatArray, turn: FloatArray) -> None:
        """Where a camera's link is, if it has moved: to ask viser whether it has takes longer than to reckon it."""
        place, shown = np.column_stack([position, turn]), self._places.get(name)
        if shown is None or np.abs(place - shown).max() > MOVED:
            self._places[name] = place
            frustum = self._frustums[name]
            frustum.position, frustum.wxyz = position, quaternion(turn @ LINK_TO_OPTICAL)


def height_colors(heights: FloatArray) -> NDArray[np.uint8]:
    """Colours (n, 3) from blue over green to red, from half a metre below base_link to half a metre over the ground."""
    part = np.clip((heights + 0.8) / 0.8, 0.0, 1.0)[:, None]
    low, middle, high = (np.array(color, dtype=float) for color in ((60, 130, 255), (70, 220, 130), (255, 90, 60)))
    colors = np.where(part < 0.5, low + (middle - low) * 2.0 * part, middle + (high - middle) * (2.0 * part - 1.0))
    return colors.astype(np.uint8)


def pixels(image: Image) -> NDArray[np.uint8]:
    """An image that a scene has as rows, columns and red, green, blue; one of 16 bits from its least to its most."""
    size, numbers = PIXELS[image.encoding]
    kind = np.dtype(np.uint8 if size == 1 else ">u2" if image.is_bigendian else "<u2")
    rows = np.frombuffer(image.data, dtype=np.uint8, count=image.height * image.step).reshape(image.height, image.step)
    found = np.ascontiguousarray(rows[:, : image.width * numbers * size]).view(kind)
    step = -(-image.width // WIDEST)
    colors = found.reshape(image.height, image.width, numbers)[::step, ::step].astype(np.float64)
    if size > 1:
        known = colors[colors > 0]
        low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
        colors = np.clip((colors - low) / max(high - low, 1.0), 0.0, 1.0) * 255.0
    if image.encoding == "bgr8":
        colors = colors[:, :, ::-1]
    return np.broadcast_to(colors, (*colors.shape[:2], 3)).astype(np.uint8)


def quaternion(rotation: FloatArray) -> FloatArray:
    """A rotation (3, 3) as quaternion w x y z."""
    return np.asarray(viser.transforms.SO3.from_matrix(rotation).wxyz)
