"""The part of an elevation model that a run has used, as its bag holds it: with it the run is replayed without the
model's file.

It is numpy's .npz. In the configuration of a replayed run it lies in `config/`, and stands for the terrain's file.
"""

import io

import numpy as np

from sojourn_config.paths import config_folder
from sojourn_physics.terrain.raster import Raster

ELEVATION_NAME = "elevation.npz"


def recorded_raster() -> Raster | None:
    """That of the run that is replayed; None where none is."""
    file = config_folder() / ELEVATION_NAME
    return raster_from(file.read_bytes()) if file.is_file() else None


def raster_bytes(raster: Raster) -> bytes:
    """As it goes into a bag."""
    file = io.BytesIO()
    soils = np.zeros((0, 0), dtype=np.int64) if raster.soils is None else raster.soils
    place = np.array([raster.resolution, raster.x, raster.y])
    np.savez_compressed(file, heights=raster.heights, place=place, soils=soils)
    return file.getvalue()


def raster_from(data: bytes) -> Raster:
    """As it comes out of a bag."""
    with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
        resolution, x, y = arrays["place"].tolist()
        soils = arrays["soils"]
        return Raster(arrays["heights"], resolution, x, y, soils if soils.size else None)
