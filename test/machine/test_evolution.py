"""A value with other fields: as `dataclasses.replace` makes it, of whatever class."""

import dataclasses
from dataclasses import dataclass, field
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_machine.evolution import replace


@dataclass(frozen=True, slots=True)
class Plain:
    speed: float
    names: tuple[str, ...] = ()
    table: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Longer(Plain):
    reason: str | None = None


@dataclass(frozen=True, slots=True)
class Named:
    kind: str
    new: int = 0
    old: int = 0
    create: int = 0
    value: int = 0


@dataclass(frozen=True)
class WithoutSlots:
    speed: float
    names: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Checked:
    speed: float

    def __post_init__(self) -> None:
        if self.speed < 0.0:
            raise ValueError("backwards")


CHANGES = st.fixed_dictionaries(
    {}, optional={"speed": st.floats(allow_nan=False), "names": st.just(("a",)), "table": st.just({"b": 1})}
)


@pytest.mark.parametrize(
    "value", [Plain(1.0, ("x",), {"y": 2}), Longer(1.0, ("x",), {"y": 2}, "why"), WithoutSlots(3.0)]
)
@given(changes=CHANGES)
def test_it_is_what_the_library_makes(value: Any, changes: dict[str, Any]) -> None:
    known = {name: change for name, change in changes.items() if hasattr(value, name)}
    before = dataclasses.asdict(value)
    assert replace(value, **known) == dataclasses.replace(value, **known)
    assert dataclasses.asdict(value) == before and type(replace(value)) is type(value)


@pytest.mark.parametrize("value", [Plain(1.0), WithoutSlots(1.0), Checked(1.0)])
def test_a_name_that_is_no_field_is_an_error(value: Any) -> None:
    with pytest.raises(TypeError, match="colour"):
        replace(value, colour="red")


def test_what_a_class_checks_is_checked() -> None:
    with pytest.raises(ValueError, match="backwards"):
        replace(Checked(1.0), speed=-1.0)


def test_fields_may_have_any_name() -> None:
    value = Named("stop", 1, 2, 3, 4)
    for name in ("kind", "new", "old", "create", "value"):
        assert replace(value, **{name: 7}) == dataclasses.replace(value, **{name: 7})
