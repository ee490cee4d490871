"""Grounds and scenes for the tests of cameras."""

import math
from dataclasses import dataclass

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_machine.shapes import Shapes
from sojourn_physics.imaging.camera import LINK_TO_OPTICAL, DetectorParams, Optics, optics
from sojourn_physics.imaging.lens import LensParams
from sojourn_physics.imaging.photometry import Illumination
from sojourn_physics.imaging.scenery import GroundLook, Moment, Scenery, sun_of
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.memory import GroundMemory

NO_BODY = Shapes(np.zeros((0, 6)), np.zeros((0, 3, 3)), np.zeros((0, 3)), np.zeros(4))
UNTOUCHED = GroundMemory(0.0, 0.0, 0.0)
MOON = GroundLook(0.12, True, math.inf, (1.0,))
NOON = Illumination(1361.0, 0.0)


def ground(heights: FloatArray, resolution: float = 0.05, interpolation: str = "bilinear") -> HeightField:
    """A height field about the origin."""
    rows, columns = heights.shape
    origin = -0.5 * resolution * (columns - 1), -0.5 * resolution * (rows - 1)
    soil = np.zeros(heights.shape, dtype=np.uint8)
    return HeightField(heights, soil, resolution, *origin, ("soil",), interpolation)  # type: ignore[arg-type]


def flat(size: float = 20.0, resolution: float = 0.05) -> HeightField:
    nodes = round(size / resolution) + 1
    return ground(np.zeros((nodes, nodes)), resolution)


def rough(seed: int, size: int = 161, height: float = 0.4) -> HeightField:
    """Hills of several sizes, and some narrow towers."""
    random = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(size), np.arange(size))
    heights = np.zeros((size, size))
    for wave in (120.0, 50.0, 20.0, 8.0):
        phase = random.uniform(0.0, 2.0 * np.pi, 3)
        turn = random.uniform(0.0, np.pi)
        heights += height * wave / 200.0 * np.sin((x * np.cos(turn) + y * np.sin(turn)) * 2 * np.pi / wave + phase[0])
    for _ in range(12):
        i, j = random.integers(4, size - 6, 2)
        heights[i : i + 4, j : j + 4] += random.uniform(0.1, 0.5)
    return ground(heights)


def sun(elevation_deg: float, azimuth_deg: float = 0.0, disc: float = 0.00465) -> FloatArray:
    """`Moment.sun`; azimuth from x towards y."""
    e, a = math.radians(elevation_deg), math.radians(azimuth_deg)
    return sun_of(np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)]), disc)


def camera(columns: int = 160, rows: int = 120, view: float = 60.0, **lens: object) -> Optics:
    fields = {"columns": columns, "rows": rows, "horizontal_view_deg": view} | lens
    return optics(LensParams.model_validate(fields), DetectorParams())


def looking(yaw_deg: float, down_deg: float) -> FloatArray:
    """From the optical frame into map."""
    yaw, down = math.radians(yaw_deg), math.radians(down_deg)
    about_z = np.array([[math.cos(yaw), -math.sin(yaw), 0.0], [math.sin(yaw), math.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
    about_y = np.array([[math.cos(down), 0.0, math.sin(down)], [0.0, 1.0, 0.0], [-math.sin(down), 0.0, math.cos(down)]])
    return np.asarray(about_z @ about_y @ LINK_TO_OPTICAL)


@dataclass
class Shooting:
    """A scene of a ground under a Sun."""

    field: HeightField
    sun: FloatArray
    place: GroundLook = MOON
    light: Illumination = NOON
    body: Shapes = NO_BODY
    memory: GroundMemory = UNTOUCHED

    def __post_init__(self) -> None:
        self.scenery = Scenery(self.field, self.place)

    def see(self, eye: Optics, turn: FloatArray, at: FloatArray):  # type: ignore[no-untyped-def]
        """Radiance and distance."""
        (seen,) = self.scenery.see(eye, Moment(self.sun, self.light, self.memory, self.body), turn, [at])
        return seen
