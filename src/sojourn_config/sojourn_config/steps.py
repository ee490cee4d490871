"""Steps of a scenario: a kind of step by its name, with its own words, and how long it may take.

The kinds are found by an entry point of the group `sojourn.steps`, so that no list of them is kept here: ours are in
the package of the operator, which carries them out.
"""

import json
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from pydantic import (
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    model_serializer,
    model_validator,
)
from pydantic_core import InitErrorDetails

from sojourn_config.yaml_file import KeyPath
from sojourn_machine.choice import KindsOf, within
from sojourn_machine.params import Params
from sojourn_machine.registry import Registry

if TYPE_CHECKING:
    from sojourn_config.bundle import Bundle

STEPS: "Registry[type[Step]]" = Registry("sojourn.steps", "kind of step")
"""What each kind asks for, by the key that a step has for it."""
FARTHEST = 1e6
LONGEST = 1e7
StepProblem: TypeAlias = tuple[KeyPath, object, str]
"""Key within the step, value, and what is allowed."""


class Step:
    """What every kind of step tells before a run. It is a pydantic model besides, whose fields are its words."""

    role: ClassVar[str] = ""
    """Role that carries it out, drive or arm: a machine without one refuses the scenario. "": none does."""
    topic: ClassVar[str] = ""
    """On which the operator says it; "": it says nothing."""

    def places(self) -> Iterable[tuple[KeyPath, float, float]]:
        """Points of map that have to be on the ground: key within the step, x and y [m]."""
        return ()

    def problems(self, bundle: "Bundle") -> Iterable[StepProblem]:
        """What of it does not fit a machine that has its role."""
        return ()


class StepConfig(Params):
    """One step: exactly one key names its kind and has its words, the others are those below."""

    model_config = ConfigDict(extra="allow")
    others: ClassVar[KindsOf] = KindsOf(STEPS, "")
    """What the one other key may be."""

    timeout_s: float | None = Field(
        default=None, gt=0.0, le=LONGEST, description="time until the step has failed [s]; none: no limit"
    )

    @property
    def kind(self) -> str:
        """Name of its kind."""
        return next(iter(self.__pydantic_extra__ or {}))

    @property
    def action(self) -> Any:
        """What is to be done: a `Step`."""
        return (self.__pydantic_extra__ or {})[self.kind]

    @model_serializer(mode="wrap")
    def _with_words(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """As the file."""
        return {**dump(self), self.kind: self.action.model_dump(mode="json")}

    @model_validator(mode="after")
    def _read_the_kind(self) -> "StepConfig":
        """Make of the words what its kind makes of them."""
        found = self.__pydantic_extra__ if self.__pydantic_extra__ is not None else {}
        for name in [name for name, words in found.items() if words is None and name in STEPS.names()]:
            del found[name]
        unknown = [name for name in found if name not in STEPS.names()]
        if unknown:
            raise ValidationError.from_exception_data(
                type(self).__name__,
                [InitErrorDetails(type="extra_forbidden", loc=(name,), input=found[name]) for name in unknown],
            )
        if len(found) != 1:
            given = " and ".join(found) or "none"
            raise ValueError(f"a step has one action, here {given}: allowed is one of " + ", ".join(STEPS.names()))
        ((name, words),) = found.items()
        try:
            found[name] = read_step(name, words)
        except ValidationError as error:
            told = [within(name, detail) for detail in error.errors(include_url=False)]
            raise ValidationError.from_exception_data(type(self).__name__, told) from None
        return self


def read_step(name: str, words: Any) -> Any:
    """The step of a kind from its words; what has been read already stays. Raises ValidationError, UnknownNameError."""
    if isinstance(words, Step):
        return words
    kind: Any = STEPS.get(name)
    # text is no number and a list stands for a tuple, as in the files: strict mode takes them so from JSON alone
    return kind.model_validate_json(json.dumps(words), strict=True)
