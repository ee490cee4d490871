"""The machine as its drive knows it: parameters, wheels, and what follows from them once and for all."""

import math
from dataclasses import dataclass, field

from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.steering.avoidance_types import Avoidance
from sojourn_mechanics.steering.key_frames import TerrainMatcher
from sojourn_mechanics.steering.params import DriveParams, SteeringGeometryParams
from sojourn_mechanics.steering.slip_estimation import SlipModel
from sojourn_mechanics.steering.stereo_eye import StereoEye
from sojourn_mechanics.steering.turning_limits import TurningLimits, turning_limits
from sojourn_mechanics.steering.way_round import Area


@dataclass(frozen=True, eq=False)
class DrivenMachine:
    """Parameters of one machine, validated and prepared for the kernels."""

    params: DriveParams
    geometry: SteeringGeometryParams
    eye: StereoEye | None = None
    """The hazard camera; without one there is no obstacle handling."""
    area: Area | None = None
    """Where a way round may lead; None for anywhere."""
    loads: FloatArray | None = None
    """Of the wheels, from `wheel_load_map`, shape (wheels, 3) [N]; None: slip is not estimated."""
    table: FloatArray = field(init=False)
    turn_radius: float = field(init=False)
    """Distance of the farthest wheel from base_link [m]."""
    turning: TurningLimits = field(init=False)
    """How sharply it can turn."""
    avoidance: Avoidance | None = field(init=False)
    """Obstacle handling, where it is asked for and there is a camera."""
    slip: SlipModel | None = field(init=False)
    terrain: TerrainMatcher | None = field(init=False)
    """Odometry from the camera, where it is asked for and there is one."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "table", self.geometry.table(self.params.track_ratio))
        slip, loads = self.params.slip, self.loads
        estimator = None if slip is None or loads is None else SlipModel.of(slip, self.table, loads)
        object.__setattr__(self, "slip", estimator)
        object.__setattr__(self, "turn_radius", max(math.hypot(w.x, w.y) for w in self.geometry.wheels))
        turning = turning_limits(self.table, self.params.limits, self.params.follower.max_curvature)
        object.__setattr__(self, "turning", turning)
        avoidance = None
        if self.params.obstacles is not None and self.eye is not None:
            avoidance = Avoidance(self.params.obstacles, self.params.follower, turning, self.eye, self.area)
        object.__setattr__(self, "avoidance", avoidance)
        matched, eye = self.params.terrain_match, self.eye
        object.__setattr__(self, "terrain", None if matched is None or eye is None else TerrainMatcher(matched, eye))
