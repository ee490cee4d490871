"""What moves a machine: the interface between the drive and wheels, tracks, or legs.

Goals, planning, the fusion of odometry and supervision know a machine by this alone: how fast and how sharply it can
go, which motions it allows, what its joints say of its motion, which references of its joints make a motion wanted, and
how it is. A kind of mobility is one class; its state is a value that holds all that it remembers.

A period has two calls: `motion`, then, with what the drive has made of it, `command`.
"""

from abc import ABC, abstractmethod
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from sojourn_flight.mobility.ability import Ability
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_machine.params import FloatArray

Triple = tuple[float, float, float]
"""Along x, y, z."""
State = TypeVar("State")
NOT_MEASURED: FloatArray = np.empty(0)
"""Efforts of joints that do not tell them."""


class MobilityJoints(NamedTuple):
    """The joints of a mobility, in its order."""

    position: FloatArray
    """Shape (joints,) [rad or m]."""
    velocity: FloatArray
    """Shape (joints,) [rad/s or m/s]."""
    effort: FloatArray = NOT_MEASURED
    """Shape (joints,) [N m or N]; (0,) where they are not measured."""


class JointReferences(NamedTuple):
    """Commands to the joints of a mobility, in its order."""

    position: FloatArray
    """Shape (joints,) [rad or m]; 0 for a joint that is commanded by its rate."""
    velocity: FloatArray
    """Shape (joints,) [rad/s or m/s]."""

    def stopped(self) -> "JointReferences":
        """Nothing moves: rates are zero, and positions are held."""
        return JointReferences(self.position, np.zeros_like(self.velocity))


class InertialMeasurement(NamedTuple):
    """What an inertial measurement unit tells of base_link, in base_link. None: not measured."""

    gyro: Triple | None = None
    """Angular velocity [rad/s]."""
    specific_force: Triple | None = None
    """What the accelerometers feel [m/s^2]."""
    roll_pitch: tuple[float, float] | None = None
    """[rad], pitch positive nose down; None to take the ground as level."""
    accelerometer_ahead: float = 0.0
    """How far the accelerometers are before the origin of base_link [m]."""


NOTHING_FELT = InertialMeasurement()
"""Of a machine without such a unit."""


class MotionInput(NamedTuple):
    """What is known at the start of a period."""

    joints: MobilityJoints
    felt: InertialMeasurement
    gyro_bias: float
    """Estimated bias of the gyro's z axis [rad/s]."""
    standing: bool
    """The machine stood in the last period: what its joints move adds up, until it counts as motion."""
    powered: bool
    """False while the power manager holds it: it learns nothing of its motors meanwhile."""
    new_goal: bool
    """What has failed gets another try."""


class BodyMotion(NamedTuple):
    """What the joints say that base_link did in a period, in base_link, as if nothing slipped."""

    v_x: float
    v_y: float
    """[m/s]"""
    yaw_rate: float
    """[rad/s]"""
    residual: float
    """What the supports disagree by [m/s]."""
    fastest: float
    """Speed of the support that moves fastest; below the odometry's threshold the machine stands [m/s]."""
    commanded_still: bool
    """Nothing is commanded to move."""
    jumps: int = 0
    """Readings that cannot be, in whose place something else was taken [-]."""
    slip: float | None = None
    """Part of the way that is lost, as estimated by the mobility itself; None to take the expected one [-]."""
    slip_sigma: float = 0.0
    """Standard deviation of that, a part of the way of the supports [-]."""
    turn_sigma: float = 0.0
    """Error of the position in a turn beside the usual one [m/rad^0.5]."""


class Conditions(NamedTuple):
    """Under which a motion is commanded."""

    power: float
    """Factor of the power manager on all speeds, 0 to 1 [-]."""
    pitch: float
    """Of base_link, positive nose down [rad]."""


class Moves(NamedTuple):
    """Commands of a period, and how they come off."""

    references: JointReferences
    cut: float = 1.0
    """Factor by which the limits of the machine cut the motion wanted, 0 to 1 [-]."""
    waits: str = ""
    """For what it waits before it moves, in words; empty while it moves."""
    stuck: str = ""
    """Why a goal is to be given up, for it has waited too long; in words."""
    detail: Any = None
    """What the kind makes its status of."""


class MobilityHealth(NamedTuple):
    """Why a goal cannot be pursued, in words; empty where it can."""

    shortcoming: str = ""
    """With the motors that are left."""
    no_headway: str = ""
    """What should move it moves, and it does not get on."""
    lost: str = ""
    """How far it gets is not known any more."""


class Mobility(ABC, Generic[State]):
    """What one machine moves on."""

    joints: tuple[str, ...]
    """That it measures and commands."""
    ability: Ability

    @abstractmethod
    def initial_state(self) -> State:
        """At rest, before the first period."""

    def in_motion(self, state: State) -> State:
        """The state of a drive that goes on while the machine may move already, as after one that has died."""
        return state

    @abstractmethod
    def motion(self, state: State, inputs: MotionInput, dt: float) -> tuple[State, BodyMotion]:
        """What the joints say of the motion in a period of `dt` [s].

        Raises:
            InvalidValueError: a measurement that cannot be used.
        """

    @abstractmethod
    def command(self, state: State, wanted: PlanarTwist, conditions: Conditions, dt: float) -> tuple[State, Moves]:
        """The next commands for a motion of base_link; within the limits of the machine, by one factor."""

    @abstractmethod
    def fit(self, wanted: PlanarTwist) -> tuple[PlanarTwist, str]:
        """The motion that the machine can make in place of one that was asked for, and why it is refused: no motion."""

    @abstractmethod
    def health(self, state: State, slip_error: float) -> MobilityHealth:
        """How it is. slip_error: what the camera has found the way to be shorter than was told, over it [-]."""

    def slip(self, state: State, slip_error: float, least_pace: float) -> float | None:
        """Slip of the machine [-]; None of one that goes slower than `least_pace` [m/s] or does not know it well."""
        del state, slip_error, least_pace
        return None

    def rather_astern(self, state: State) -> bool:
        """Whether it would get on better backwards, and can turn about."""
        del state
        return False

    def status(self, state: State, moves: Moves, slip_error: float) -> dict[str, str | float]:
        """Fields of its own for /drive/status; the unit is the last part of a name."""
        del state, moves, slip_error
        return {}

    @abstractmethod
    def warm_up(self) -> None:
        """Have every compiled kernel ready, so that no later step waits for the compiler or its libraries."""
