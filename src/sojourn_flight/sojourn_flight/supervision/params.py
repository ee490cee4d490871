"""Parameters of the drive: how a machine is driven, whatever it moves on."""

from pydantic import Field

from sojourn_flight.hazards.obstacle_params import ObstacleParams
from sojourn_flight.mobility.choice import ChosenMobility
from sojourn_flight.mobility.motion_limits import MotionLimits
from sojourn_flight.odometry.odometry_params import HeadingFixParams, OdometryParams
from sojourn_flight.odometry.terrain_match_params import TerrainMatchParams
from sojourn_flight.odometry.visual_params import VisualOdometryParams
from sojourn_flight.planning.energy_params import EnergyParams
from sojourn_flight.planning.follower_params import GoalFollowerParams
from sojourn_flight.supervision.slip_policy import SlipPolicyParams
from sojourn_machine.params import Params


class DriveParams(Params):
    """Everything the drive node's model needs besides the machine itself."""

    cmd_vel_timeout: float = Field(..., gt=0.0, le=10.0, description="age at which a twist command is dropped [s]")
    limits: MotionLimits = Field(..., description="what the machine may be asked to do")
    mobility: ChosenMobility = Field(..., description="what the machine moves on, by its kind")
    odometry: OdometryParams = Field(..., description="trust in wheels or legs, and gyro")
    heading_fix: HeadingFixParams | None = Field(None, description="trust in the sun sensor; none: it is not used")
    slip_policy: SlipPolicyParams | None = Field(None, description="what slip means for a goal; none: only the stop")
    terrain_match: TerrainMatchParams | None = Field(
        None, description="odometry from the hazard camera; none: its clouds are for obstacles only"
    )
    visual_odometry: VisualOdometryParams | None = Field(
        None, description="odometry from the images of a stereo pair; none: they are for people only"
    )
    follower: GoalFollowerParams = Field(..., description="approach to goals")
    obstacles: ObstacleParams | None = Field(None, description="obstacle handling; left out: it avoids nothing")
    energy: EnergyParams | None = Field(None, description="what driving costs; none: no forecast")
