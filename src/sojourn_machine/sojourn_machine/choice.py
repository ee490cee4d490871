"""A table of a file that says by a name which kind of thing it describes: a contact law, a mobility.

The kinds are found by their names when they are needed (`registry`), so that what reads the file knows none of them,
and a kind may come from any package. Each kind is a subclass of its choice, with its own parameters:

    Contact = Annotated[SerializeAsAny[ContactChoice], *kinds_of(CONTACT_LAWS, "model")]
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BeforeValidator, ValidationError
from pydantic_core import ErrorDetails, InitErrorDetails

from sojourn_machine.errors import UnknownNameError
from sojourn_machine.registry import Registry


@dataclass(frozen=True)
class KindsOf:
    """Says of a field which kinds it may be, for messages and manuals; `key`: where the table names its kind."""

    registry: Registry[Any]
    key: str


def kinds_of(registry: Registry[Any], key: str, otherwise: str | None = None) -> tuple[KindsOf, BeforeValidator]:
    """What makes a field one of the registered kinds, by the name that stands at `key` of its table.

    Args:
        otherwise: kind of a table that names none; None: it is refused.
    """

    def read(table: Any) -> Any:
        if not isinstance(table, Mapping):
            return table
        if key not in table and otherwise is None:
            raise _at(key, InitErrorDetails(type="missing", loc=(key,), input=dict(table)))
        name = table.get(key, otherwise)
        if not isinstance(name, str):
            raise _at(key, InitErrorDetails(type="string_type", loc=(key,), input=name))
        try:
            kind = registry.get(name)
        except UnknownNameError as error:
            details = InitErrorDetails(type="value_error", loc=(key,), input=name, ctx={"error": error})
            raise _at(key, details) from None
        return kind.model_validate(table)

    return KindsOf(registry, key), BeforeValidator(read)


def _at(key: str, details: InitErrorDetails) -> ValidationError:
    return ValidationError.from_exception_data(key, [details])


def within(name: str, detail: ErrorDetails) -> InitErrorDetails:
    """The same problem, told of the table of that name."""
    return InitErrorDetails(
        type=detail["type"], loc=(name, *detail["loc"]), input=detail["input"], ctx=detail.get("ctx", {})
    )
