"""How a support meets the ground, as a machine's file says it: a contact law by its name, with its own parameters.

The laws themselves are physics, and are found by their names when they are needed: see `choice`.
"""

from typing import Annotated, Any

from pydantic import Field, SerializeAsAny

from sojourn_machine.choice import kinds_of
from sojourn_machine.params import Params
from sojourn_machine.registry import Registry

CONTACT_LAWS: "Registry[type[ContactChoice]]" = Registry("sojourn.contact_laws", "contact model")
"""Parameter sets of the laws that a wheel may have, by their names."""
FOOT_LAWS: "Registry[type[ContactChoice]]" = Registry("sojourn.foot_laws", "contact model of a foot")
"""Likewise of a foot."""


class ContactChoice(Params):
    """A contact law by its name: `contact` of a wheel or a foot. Each law has a subclass with its parameters."""

    model: str = Field(description="contact model")

    def rollers_deg(self) -> float | None:
        """From the axle to the axis of the wheel's rollers, towards ahead [degree]; None of a wheel without rollers."""
        return None


Contact = Annotated[SerializeAsAny[ContactChoice], *kinds_of(CONTACT_LAWS, "model")]
FootContact = Annotated[SerializeAsAny[ContactChoice], *kinds_of(FOOT_LAWS, "model")]
DEFAULT_CONTACT: Any = {"model": "rigid_wheel_on_soil"}
"""What a wheel has where its file says nothing; read like a file's."""
DEFAULT_FOOT_CONTACT: Any = {"model": "foot_pad"}
"""Likewise of a foot."""
