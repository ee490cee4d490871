"""Rough ground, and what the explorer's hazard camera sees of it."""

from pathlib import Path

import numpy as np

from sojourn_config.machine_reader import joined_machine
from sojourn_flight.hazards.stereo_camera import StereoCamera
from sojourn_flight.odometry.attitude import rotation_of
from sojourn_machine.mounting import mounting
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import hazcam
from sojourn_physics.sensors.hazcam import HazcamParams, HazcamView, hazcam_on
from sojourn_physics.sensors.noise import NoiseStream
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.params import RoughnessParams
from sojourn_physics.terrain.roughness import rough_surface

ROOT = Path(__file__).parents[3]
RIDE = 0.47
"""Height of base_link above the ground below it [m]."""
CELL, SIDE = 0.05, 16.0
EXPLORER = joined_machine("explorer")
URDF = EXPLORER.urdf.text
PARAMS: HazcamParams = EXPLORER.sensors.first(HazcamParams)
CAMERA = hazcam_on(PARAMS, URDF)
STEREO = StereoCamera(
    CAMERA.position,
    mounting(URDF, PARAMS.link)[0][:, 0],
    PARAMS.disparity_noise_px / (PARAMS.focal_length_px * PARAMS.baseline),
)


def ground(heights: FloatArray) -> HeightField:
    """A square round the origin; rows along y."""
    soil = np.zeros(heights.shape, dtype=np.uint8)
    return HeightField(heights, soil, CELL, -SIDE / 2, -SIDE / 2, ("sand",), "bilinear")


def nodes() -> tuple[FloatArray, FloatArray]:
    """x and y of the nodes of `ground`."""
    along = np.arange(-SIDE / 2, SIDE / 2 + CELL / 2, CELL)
    x, y = np.meshgrid(along, along)
    return x, y


def rough(seed: int, slope_deg: float = 2.0) -> HeightField:
    """Fractal ground as that of the lunar scenarios."""
    shape = nodes()[0].shape
    params = RoughnessParams(rms_slope_deg=slope_deg)
    return ground(rough_surface(params, shape, CELL, np.random.default_rng(seed)))


class NoisyCamera:
    """The camera with its noise."""

    def __init__(self, seed: int) -> None:
        self._noise: NoiseStream = hazcam.initial_state(CAMERA, seed)

    def cloud(
        self, field: HeightField, x: float, y: float, yaw: float = 0.0, tilt: tuple[float, float] = (0.0, 0.0)
    ) -> FloatArray:
        """The cloud in base_link, shape (n, 3)."""
        place = np.array((x, y, field.height(x, y) + RIDE))
        self._noise, cloud = hazcam.step(CAMERA, self._noise, HazcamView(field), place, rotation_of(*tilt, yaw))
        return cloud.astype(np.float64)
