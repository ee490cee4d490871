"""How a support meets the ground, as a machine's file says it: a contact law by its name, with its own parameters.

The laws themselves are physics, and are found by their names when they are needed: see `registry`. So what reads a
machine's file knows no law, and a law may come from any package.
"""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, ConfigDict, Field, SerializeAsAny, ValidationInfo, field_validator

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
    """The key of the table that says which law it is, of the registry that is the context of the validation; the other
    keys are that law's to judge.
    """

    model_config = ConfigDict(extra="ignore")
    model: str

    @field_validator("model")
    @classmethod
    def _registered(cls, name: str, info: ValidationInfo) -> str:
        laws: Any = info.context
        laws.get(name)
        return name


def _law_among(laws: "Registry[type[ContactChoice]]") -> BeforeValidator:
    """Reads the parameter set of the law of a registry that a table names from the table."""

    def law(value: Any) -> Any:
        if not isinstance(value, Mapping):
            return value
        return laws.get(_Name.model_validate(value, context=laws).model).model_validate(value)

    return BeforeValidator(law)


Contact = Annotated[SerializeAsAny[ContactChoice], _law_among(CONTACT_LAWS)]
FootContact = Annotated[SerializeAsAny[ContactChoice], _law_among(FOOT_LAWS)]
DEFAULT_CONTACT: Any = {"model": "rigid_wheel_on_soil"}
"""What a wheel has where its file says nothing; read like a file's."""
DEFAULT_FOOT_CONTACT: Any = {"model": "foot_pad"}
"""Likewise of a foot."""
