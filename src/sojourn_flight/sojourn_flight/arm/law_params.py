"""What the laws of the arm take of its parameters: groups put together, with the settings of each law.

An arm's parameters are all of them: their keys stand side by side in the arm's file.
"""

from pydantic import Field

from sojourn_flight.arm.contact_params import ContactParams
from sojourn_flight.arm.param_groups import ArmDriveParams, ClearanceParams, NamedPoseParams, PoseGoalParams
from sojourn_machine.params import Params


class InverseKinematicsParams(Params):
    """Settings of the search for joint positions."""

    position_tolerance: float = Field(
        default=1.0e-5, gt=0.0, le=1.0e-2, description="accepted distance to the target [m]"
    )
    pointing_tolerance: float = Field(
        default=1.0e-4,
        gt=0.0,
        le=0.2,
        description="accepted angle between tool axis and wanted direction [rad]",
    )
    characteristic_length: float = Field(
        default=0.1, gt=0.0, le=100.0, description="weight of one radian of pointing against position [m]"
    )
    damping_bias: float = Field(
        default=1.0e-8, gt=0.0, le=1.0, description="smallest damping of the least squares [m2]"
    )
    max_step: float = Field(
        default=0.5, gt=0.0, le=3.2, description="largest change of a joint in one iteration [rad or m]"
    )
    max_iterations: int = Field(default=60, ge=1, le=10000, description="iterations from one start [-]")
    starts: int = Field(
        default=100, ge=1, le=1000, description="most starts of a search, the present position included [-]"
    )
    starts_when_solved: int = Field(
        default=20, ge=1, le=1000, description="starts after which one solution is enough [-]"
    )
    solutions: int = Field(default=6, ge=1, le=64, description="distinct solutions after which the search ends [-]")


class TipPathParams(Params):
    """Lines and arcs of the tip that an operator asks for."""

    speed: float = Field(default=0.05, gt=0.0, le=10.0, description="of the tip, where the joints allow it [m/s]")
    corner: float = Field(
        default=0.005, ge=0.0, le=1.0, description="a corner is rounded by at most this [m]; 0: the tip stops at each"
    )
    tolerance: float = Field(
        default=1.0e-4, gt=0.0, le=0.01, description="of the joints' way off the path [m], and of the tool's turn [rad]"
    )


class JogParams(Params):
    """Velocities of the tip by hand."""

    timeout: float = Field(default=0.2, gt=0.0, le=10.0, description="age at which a command is dropped [s]")
    speed: float = Field(default=0.05, gt=0.0, le=10.0, description="of the tip, at most [m/s]")
    turning: float = Field(default=0.2, gt=0.0, le=10.0, description="of the tool, at most [rad/s]")
    singular_stop: float = Field(
        default=0.1,
        ge=0.0,
        le=10.0,
        description="smallest singular value at which the tip rests on its way to a singular posture, in "
        "characteristic lengths of the inverse kinematics [-]",
    )
    pause: float = Field(
        default=0.5,
        ge=0.0,
        le=60.0,
        description="time without commands after which an arm that has met something can be jogged again [s]",
    )


class SearchParams(Params):
    """For laws that solve for joint positions, or rates, from those of the tip."""

    inverse_kinematics: InverseKinematicsParams = Field(
        InverseKinematicsParams(), description="settings of the inverse kinematics"
    )


class PoseSearchParams(NamedPoseParams, SearchParams):
    """For the inverse kinematics, which starts from the named poses, too."""


class LineParams(PoseSearchParams, ClearanceParams):
    """For straight lines of the tip that a task is to follow."""


class WayParams(NamedPoseParams, ClearanceParams):
    """For ways from posture to posture that collide with nothing."""

    planning_attempts: int = Field(default=8, ge=1, le=100, description="most ways that are tried for one goal [-]")
    contact: ContactParams = Field(default=ContactParams(), description="contacts in motions that are to touch nothing")


class TipPlanParams(PoseGoalParams, ClearanceParams):
    """For motions along a path of the tip."""

    tip_path: TipPathParams = Field(default=TipPathParams(), description="lines and arcs of the tip")


class JoggingParams(SearchParams, PoseGoalParams, ClearanceParams, ArmDriveParams):
    """For jogging."""

    jog: JogParams = Field(default=JogParams(), description="velocities of the tip by hand")


class PlanningParams(LineParams, WayParams, TipPlanParams, ArmDriveParams):
    """For motions to goals of every kind."""

    retime: bool = Field(
        default=True, description="stretch a timed trajectory that breaks a limit (true) or refuse it (false)"
    )
