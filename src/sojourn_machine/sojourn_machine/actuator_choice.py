"""What drives joints, as a machine's file says it: a kind of drive by its name, with its own parameters.

Motor, gear and servo are the kind that comes with us (`drives`). What another kind does in the plant is found by its
name when it is needed: see `registry`.
"""

from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, SerializeAsAny, model_validator

from sojourn_machine.choice import kinds_of
from sojourn_machine.params import Params
from sojourn_machine.registry import Registry

ACTUATORS: "Registry[type[ActuatorParams]]" = Registry("sojourn.actuators", "kind of drive")
"""Parameter sets of the kinds of drives, by their names."""


class ActuatorParams(Params):
    """One drive of a group of joints. Each kind has a subclass with its parameters, its name the default of `kind`.

    Efforts and rates are those of the joint: of one that slides N and m/s stand for N m and rad/s.
    """

    kind: str = Field(description="kind of drive")
    joints: tuple[str, ...] = Field(min_length=1, description="joints of the URDF with this drive")
    load: str = Field(
        min_length=1, description="name of the electrical load that feeds it, by which it is switched and limited"
    )
    torque_key: ClassVar[tuple[str, ...]] = ("max_torque",)
    """Where its file says `largest_torque`."""

    @model_validator(mode="after")
    def _each_joint_once(self) -> Self:
        if len(set(self.joints)) != len(self.joints):
            raise ValueError("joints: allowed is each joint once")
        return self

    @property
    def mode(self) -> Literal["rate", "position"]:
        """What it holds: the commanded rate, or position and rate."""
        raise NotImplementedError

    @property
    def largest_torque(self) -> float:
        """That it asks for at the joint [N m]."""
        raise NotImplementedError

    @property
    def motor_effort(self) -> float:
        """Largest torque that it can give the joint [N m]."""
        return self.largest_torque

    @property
    def reflected_inertia(self) -> float:
        """Of what turns with the joint as one, as the joint feels it [kg m^2]."""
        return 0.0

    @property
    def friction_torque(self) -> float:
        """Coulomb friction at the joint without load [N m]."""
        return 0.0

    @property
    def viscous_friction(self) -> float:
        """At the joint [N m s/rad]."""
        return 0.0

    @property
    def efficiency(self) -> float:
        """Under load, of what is between motor and joint [-]."""
        return 1.0

    @property
    def winding_loss(self) -> float:
        """Heat over the square of the torque at the joint [W/(N m)^2]."""
        return 0.0

    @property
    def encoder_ratio(self) -> float | None:
        """Turns of the shaft whose encoder tells the joint's angle, for one of the joint; None: it is the joint's."""
        return None

    def actuator(self, joint: str) -> Any:
        """What drives one of its joints in the plant: an `Actuator` of the package of physics."""
        raise NotImplementedError


DEFAULT_KIND = "geared_motor"
"""Of a drive whose table names none."""
Drive = Annotated[SerializeAsAny[ActuatorParams], *kinds_of(ACTUATORS, "kind", DEFAULT_KIND)]
