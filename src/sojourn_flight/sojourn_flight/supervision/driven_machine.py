"""The machine as its drive knows it: parameters, wheels, and what follows from them once and for all."""

import math
from dataclasses import dataclass, field

import numpy as np

from sojourn_flight.hazards.stereo_camera import StereoCamera
from sojourn_flight.mobility.allowed_motion import Mobility
from sojourn_flight.mobility.turning_limits import TurningLimits, turning_limits
from sojourn_flight.odometry.key_frames import TerrainMatcher
from sojourn_flight.odometry.slip_estimation import SlipModel
from sojourn_flight.supervision.avoidance_types import Avoidance
from sojourn_flight.supervision.params import DriveParams, SteeringGeometryParams
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, eq=False)
class DrivenMachine:
    """Parameters of one machine, validated and prepared for the kernels."""

    params: DriveParams
    geometry: SteeringGeometryParams
    camera: StereoCamera | None = None
    """The hazard camera; without one there is no obstacle handling."""
    loads: FloatArray | None = None
    """Of the wheels, from `wheel_load_map`, shape (wheels, 3) [N]; None: slip is not estimated."""
    names: tuple[str, ...] = field(init=False)
    """Of the wheels, in the order of the table."""
    table: FloatArray = field(init=False)
    turn_radius: float = field(init=False)
    """Distance of the farthest wheel from base_link [m]."""
    turning: TurningLimits = field(init=False)
    """How sharply it can turn."""
    mobility: Mobility = field(init=False)
    """Which twists an operator may ask for."""
    avoidance: Avoidance | None = field(init=False)
    """Obstacle handling, where it is asked for and there is a camera."""
    slip: SlipModel | None = field(init=False)
    terrain: TerrainMatcher | None = field(init=False)
    """Odometry from the camera, where it is asked for and there is one."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", self.geometry.names)
        object.__setattr__(self, "table", self.geometry.table(self.params.track_ratio))
        slip, loads = self.params.slip, self.loads
        estimator = None if slip is None or loads is None else SlipModel.of(slip, self.table, loads)
        object.__setattr__(self, "slip", estimator)
        object.__setattr__(self, "turn_radius", max(math.hypot(w.x, w.y) for w in self.geometry.wheels))
        turning = turning_limits(self.table, self.params.limits, self.params.follower.max_curvature)
        object.__setattr__(self, "turning", turning)
        object.__setattr__(self, "mobility", Mobility(self.table, self.names))
        avoidance = None
        if self.params.obstacles is not None and self.camera is not None:
            wheels = np.array([(wheel.x, wheel.y) for wheel in self.geometry.wheels])
            avoidance = Avoidance(self.params.obstacles, self.params.follower, turning, self.camera, wheels)
        object.__setattr__(self, "avoidance", avoidance)
        matched, camera = self.params.terrain_match, self.camera
        object.__setattr__(
            self, "terrain", None if matched is None or camera is None else TerrainMatcher(matched, camera)
        )
