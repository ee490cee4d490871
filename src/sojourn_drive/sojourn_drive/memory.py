"""What the drive's role remembers from period to period, as one value."""

from dataclasses import dataclass, field
from typing import NamedTuple

from sojourn_drive.goals import GoalStatus, QuestionStatus
from sojourn_drive.placing import PlaceStatus
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.odometry.visual_state import StereoImages
from sojourn_flight.planning.energy_forecast import EnergyLeft
from sojourn_flight.planning.goal import Goal
from sojourn_flight.supervision.drive_types import DriveOutput, DriveState
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True)
class Asked:
    """What operators want."""

    last: GoalStatus = field(default_factory=GoalStatus)
    pending: Goal | None = None
    """A goal that waits for the first period whose measurements can be used."""
    twist: tuple[int, PlanarTwist] | None = None
    """The last velocity command and its stamp [ns]."""
    abandoned: str = ""
    """Why the goal has been given up for want of measurements, until the drive has heard of it."""
    question: Goal | None = None
    """One that waits likewise."""
    questioned: QuestionStatus = field(default_factory=QuestionStatus)
    placed: PlaceStatus = field(default_factory=PlaceStatus)


class Views(NamedTuple):
    """What cameras have seen that is new."""

    cloud: FloatArray | None
    """Points in base_link, shape (n, 3) [m]."""
    images: StereoImages | None


@dataclass(frozen=True, slots=True)
class Heard:
    """What others have said last."""

    power_limit: float = 1.0
    """Factor of the power manager on all speeds [-]."""
    dark: bool = False
    """The power manager has switched off the load of the IMU."""
    off: float = 0.0
    """What the loads would draw that are switched off [W]."""
    supply: EnergyLeft | None = None
    """Of energy; None until the first reading of the battery."""
    interlock: str = ""
    """Why the rover may not drive, in words; empty where it may."""
    sun: int = 0
    cloud: int = -1
    images: int = -1
    """Stamps of the last sighting, cloud and stereo pair that were taken [ns]."""
    usable_at: int | None = None
    """When its measurements could last be used [ns]."""


@dataclass(frozen=True, slots=True)
class DriveAppState:
    """What the role remembers."""

    drive: DriveState
    output: DriveOutput
    """Of the last period whose measurements could be used."""
    asked: Asked = field(default_factory=Asked)
    heard: Heard = field(default_factory=Heard)
    stepped_at: int | None = None
    """Stamp of that period [ns]; None where it is not known."""
    tilt_rates: tuple[float, float] = (0.0, 0.0)
    """Angular velocity of base_link about its x and y axes, as last measured [rad/s]."""
    alarm: str = ""
    """What operators have to know of it for the rest of the run: that it was started again."""
    is_lost: bool = False
    """It does not know where it is."""
