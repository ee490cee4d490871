"""How a support meets the ground, as a machine's file says it: a contact law by its name, with its own parameters.

The laws themselves are physics, and are found by their names when they are needed: see `registry`. So what reads a
machine's file knows no law, and a law may come from any package.
"""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, ConfigDict, Field, SerializeAsAny, field_validator

from sojourn_machine.params import Params
from sojourn_machine.registry import Registry

CONTACT_LAWS: "Registry[type[ContactChoice]]" = Registry("sojourn.contact_laws", "contact model")
"""Parameter sets of the laws that a wheel may have, by their names."""
FOOT_LAWS: "Registry[type[ContactChoice]]" = Registry("sojourn.foot_laws", "contact model of a foot")
"""Likewise of a foot."""


class ContactChoice(Params):
    """A contact law by its name: `contact` of a wheel or a foot. Each law has a subclass with its parameters."""

    model: str = Field(description="contact model")


class _Name(Params):
    """The key of the table that says which law it is; the others are that law's to judge."""

    model_config = ConfigDict(extra="ignore")
    model: str


class _WheelLawName(_Name):
    @field_validator("model")
    @classmethod
    def _registered(cls, name: str) -> str:
        CONTACT_LAWS.get(name)
        return name


class _FootLawName(_Name):
    @field_validator("model")
    @classmethod
    def _registered(cls, name: str) -> str:
        FOOT_LAWS.get(name)
        return name


def _wheel_law(value: Any) -> Any:
    """The parameter set of the law that a table names, read from the table."""
    if not isinstance(value, Mapping):
        return value
    return CONTACT_LAWS.get(_WheelLawName.model_validate(value).model).model_validate(value)


def _foot_law(value: Any) -> Any:
    """Likewise, of a foot."""
    if not isinstance(value, Mapping):
        return value
    return FOOT_LAWS.get(_FootLawName.model_validate(value).model).model_validate(value)


Contact = Annotated[SerializeAsAny[ContactChoice], BeforeValidator(_wheel_law)]
FootContact = Annotated[SerializeAsAny[ContactChoice], BeforeValidator(_foot_law)]
DEFAULT_CONTACT: Any = {"model": "rigid_wheel_on_soil"}
"""What a wheel has where its file says nothing; read like a file's."""
DEFAULT_FOOT_CONTACT: Any = {"model": "foot_pad"}
"""Likewise of a foot."""
