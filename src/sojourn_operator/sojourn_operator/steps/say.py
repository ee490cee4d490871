"""Whatever an operator may say on a topic of his, right or wrong: to see what the machine answers to it."""

from collections.abc import Mapping
from functools import cache
from math import isfinite
from typing import Any, NamedTuple, Self, get_args, get_origin, get_type_hints

import numpy as np
from pydantic import Field, field_validator, model_validator

from sojourn_config.steps import StepProblem
from sojourn_contract import values
from sojourn_contract.goal_topics import GOAL_TOPICS
from sojourn_contract.values import Message
from sojourn_machine.names import names_text
from sojourn_machine.params import Params
from sojourn_operator.steps.step import DONE, OperatorStep, View

SHORTEST_S = 0.1
"""An operator looks at the machine ten times a second [s]."""
Words = dict[str, Any]


class SayStep(Params, OperatorStep):
    """`- say: {to: /arm/task, fields: {status: [{name: fly}]}}` in a scenario. Nobody waits for an answer."""

    to: str = Field(min_length=1, description="topic of goals")
    fields: Words = Field(
        description="of the value, by the names of sojourn_contract.values; numbers may be texts: nan"
    )
    seconds: float = Field(default=SHORTEST_S, gt=0.0, le=1e4, description="after which the operator goes on [s]")

    @field_validator("fields")
    @classmethod
    def _spell_out(cls, fields: Words) -> Words:
        return {name: _spelt(value) for name, value in fields.items()}

    @model_validator(mode="after")
    def _can_be_said(self) -> Self:
        known = {row.name: row for row in GOAL_TOPICS}
        if self.to not in known:
            raise ValueError(f"to = {self.to!r}: {names_text(self.to, known)}")
        try:
            message_of(known[self.to].type, self.fields, 0)
        except (TypeError, ValueError) as error:
            raise ValueError(f"fields of {known[self.to].type}: {error}") from error
        return self

    @property
    def role(self) -> str:  # type: ignore[override]
        """Who hears the topic."""
        return self._row.subscribers[0]

    @property
    def topic(self) -> str:  # type: ignore[override]
        """That is said."""
        return self.to

    @property
    def _row(self) -> Any:
        return next(row for row in GOAL_TOPICS if row.name == self.to)

    def problems(self, bundle: object) -> tuple[StepProblem, ...]:
        """None: it may be wrong."""
        return ()

    def describe(self) -> str:
        """See OperatorStep."""
        return f"say {self.fields} on {self.to}"

    def goal(self, view: View) -> Message:
        """See OperatorStep."""
        return message_of(self._row.type, self.fields, view.stamp)

    def end(self, view: View) -> tuple[str, str] | None:
        """See OperatorStep."""
        return (DONE, "") if view.is_over(self.seconds) else None


def message_of(type_name: str, words: Words, stamp: int) -> Message:
    """A message of a type "package/Name" from what its fields say, stamped so [ns] where they say nothing of it.

    Raises:
        ValueError, TypeError: a field that there is not, one that is missing, or one of another kind.
    """
    message: Message = _value(getattr(values, type_name.partition("/")[2]), words, stamp)
    return message


def _spelt(told: Any) -> Any:
    """Texts instead of the numbers that JSON does not have: a bag keeps the step as JSON, and would lose them."""
    if isinstance(told, float) and not isfinite(told):
        return str(told)
    if isinstance(told, Mapping):
        return {name: _spelt(value) for name, value in told.items()}
    return [_spelt(value) for value in told] if isinstance(told, list | tuple) else told


def _value(kind: Any, told: Any, stamp: int) -> Any:
    if get_origin(kind) is np.ndarray:
        return np.array([float(number) for number in told])
    if get_origin(kind) is tuple:
        inner = get_args(kind)
        rows = list(told.items()) if isinstance(told, Mapping) else told
        if inner[-1] is ...:
            return tuple(_value(inner[0], row, stamp) for row in rows)
        return tuple(_value(each, row, stamp) for each, row in zip(inner, rows, strict=True))
    if kind in (int, float, str):
        return kind(told)
    hints = _fields(kind)
    _require_fields(kind, hints, told)
    stamped = {"stamp": stamp} if "stamp" in hints else {}
    return kind(**stamped, **{name: _value(hints[name], value, stamp) for name, value in told.items()})


def _require_fields(kind: type[Any], hints: Mapping[str, Any], told: Any) -> None:
    if not isinstance(told, Mapping):
        raise ValueError(f"{told}: allowed is fields by their names")
    if unknown := set(told) - set(hints):
        raise ValueError(f"{min(unknown)!r}: {names_text(min(unknown), hints)}")
    given = {"stamp", *told, *kind._field_defaults}
    if missing := [name for name in hints if name not in given]:
        raise ValueError(f"missing: {', '.join(missing)}")


@cache
def _fields(kind: type[NamedTuple]) -> Mapping[str, Any]:
    return get_type_hints(kind)
