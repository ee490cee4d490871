"""Grounds and looks for the tests of obstacle handling."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sojourn_config.bundle import read_machine
from sojourn_flight.hazards.obstacle_map import ObstacleMap, empty_map, with_cloud
from sojourn_flight.hazards.obstacle_params import ObstacleParams
from sojourn_flight.hazards.stereo_camera import StereoCamera
from sojourn_physics.sensors import hazcam
from sojourn_physics.sensors.hazcam import HazcamParams, HazcamView
from sojourn_physics.terrain.height_field import HeightField

ROOT = Path(__file__).parents[3]
EXPLORER = read_machine("explorer", "moon", "lunar_nominal")
PARAMS: ObstacleParams = EXPLORER.drive.obstacles
RIDE = PARAMS.outline.ride_height
CAMERA = hazcam.hazcam_on(EXPLORER.sensors.first(HazcamParams), EXPLORER.urdf_xml)
STEREO = StereoCamera(
    CAMERA.position,
    CAMERA.directions[len(CAMERA.directions) // 2],
    CAMERA.params.disparity_noise_px / (CAMERA.params.focal_length_px * CAMERA.params.baseline),
)
Heights = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


def ground(heights: Heights) -> HeightField:
    """20 m square round the origin, nodes 5 cm apart."""
    nodes = np.arange(-10.0, 10.01, 0.05)
    x, y = np.meshgrid(nodes, nodes)
    return HeightField(
        heights(x, y) + 0.0 * x, np.zeros(x.shape, dtype=np.uint8), 0.05, -10.0, -10.0, ("sand",), "bilinear"
    )


def dense(heights: Heights, reach: float = 4.0) -> NDArray[np.float64]:
    """Points on all of the ground round the rover, two centimetres apart, in a level base_link at the origin."""
    side = np.arange(-reach, reach, 0.03)
    x, y = (axis.ravel() for axis in np.meshgrid(side, side))
    return np.stack([x, y, heights(x, y) + 0.0 * x - RIDE], axis=1)


def mapped(points: NDArray[np.float64], map_: ObstacleMap | None = None, driven: float = 0.0) -> ObstacleMap:
    """A map with one more look of points without noise, from a level base_link at the origin of odom."""
    known = empty_map(PARAMS, 0.0, 0.0) if map_ is None else map_
    return with_cloud(PARAMS, known, points, replace(STEREO, depth_noise=0.0), np.zeros(3), np.eye(3), driven)


def driven_over(heights: Heights, way: float, seed: int = 1, pitch: float = 0.0) -> ObstacleMap:
    """The map of a rover that has driven `way` along x, looking every 0.1 m, from the origin, by its camera."""
    field, map_ = ground(heights), empty_map(PARAMS, 0.0, 0.0)
    state = hazcam.initial_state(CAMERA, seed)
    rotation = np.array(
        [[math.cos(pitch), 0.0, math.sin(pitch)], [0.0, 1.0, 0.0], [-math.sin(pitch), 0.0, math.cos(pitch)]]
    )
    for x in np.arange(0.0, way + 0.05, 0.1):
        position = np.array([x, 0.0, field.height(x, 0.0)]) + RIDE * rotation[:, 2]
        state, points = hazcam.step(CAMERA, state, HazcamView(field), position, rotation)
        map_ = with_cloud(PARAMS, map_, points.astype(float), STEREO, position, rotation, float(x))
    return map_
