"""The machine as its drive knows it: parameters, what it moves on, and what follows from them once and for all."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from sojourn_flight.hazards.keep_out import NO_ZONES, KeepOut
from sojourn_flight.hazards.stereo_camera import StereoCamera
from sojourn_flight.mobility.mobility import Mobility
from sojourn_flight.odometry.key_frames import TerrainMatcher
from sojourn_flight.odometry.stereo_geometry import CameraPlace
from sojourn_flight.supervision.avoidance_types import Avoidance
from sojourn_flight.supervision.params import DriveParams

if TYPE_CHECKING:
    from sojourn_flight.odometry.visual_odometry import VisualOdometer


@dataclass(frozen=True, eq=False)
class DrivenMachine:
    """Parameters of one machine, validated and prepared for the kernels."""

    params: DriveParams
    mobility: Mobility[Any]
    """What it moves on."""
    camera: StereoCamera | None = None
    """The hazard camera; without one there is no obstacle handling."""
    stereo: CameraPlace | None = None
    """Of the pair whose images visual odometry goes by."""
    keep_out: KeepOut = NO_ZONES
    """Where its operators let it not go."""
    avoidance: Avoidance | None = field(init=False)
    """Obstacle handling, where it is asked for and there is a camera."""
    terrain: TerrainMatcher | None = field(init=False)
    """Odometry from the camera, where it is asked for and there is one."""
    visual: "VisualOdometer | None" = field(init=False)
    """Odometry from images, likewise."""

    def __post_init__(self) -> None:
        obstacles, matched, camera = self.params.obstacles, self.params.terrain_match, self.camera
        avoidance = terrain = None
        if obstacles is not None and camera is not None:
            ability = self.mobility.ability
            avoidance = Avoidance(
                obstacles, self.params.follower, ability.turning, camera, ability.supports, self.keep_out
            )
        if matched is not None and camera is not None:
            terrain = TerrainMatcher(matched, camera)
        object.__setattr__(self, "avoidance", avoidance)
        object.__setattr__(self, "terrain", terrain)
        object.__setattr__(self, "visual", self._visual())

    @property
    def key_frames(self) -> int:
        """That its odometry knows: one of each camera."""
        return sum(one is not None for one in (self.terrain, self.visual))

    def _visual(self) -> "VisualOdometer | None":
        if self.params.visual_odometry is None or self.stereo is None:
            return None
        from sojourn_flight.odometry.visual_odometry import VisualOdometer  # here: it loads OpenCV, for this alone

        return VisualOdometer(self.params.visual_odometry, self.stereo, 0 if self.terrain is None else 1)
