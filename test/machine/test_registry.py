"""Kinds by their names, and who may bring them."""

from collections.abc import Callable
from importlib.metadata import EntryPoint

import pytest

from sojourn_machine import registry
from sojourn_machine.errors import ContestedNameError, UnknownNameError
from sojourn_machine.registry import Registry

GROUP = "sojourn.test_kinds"


@pytest.fixture
def brought(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Registry[object]]:
    """A registry of what packages bring under the name `kind`."""

    def installed(*values: str) -> Registry[object]:
        points = [EntryPoint("kind", value, GROUP) for value in values]
        monkeypatch.setattr(registry, "entry_points", lambda group: points)
        return Registry(GROUP, "kind of test")

    return installed


@pytest.mark.parametrize("order", [1, -1])
def test_a_kind_from_outside_stands_before_one_of_ours(brought: Callable[..., Registry[object]], order: int) -> None:
    kinds = brought(*["sojourn_machine.names:names_text", "json:dumps"][::order])
    assert kinds.names() == ("kind",)
    assert kinds.get("kind").__module__ == "json"


def test_one_that_is_found_twice_is_one(brought: Callable[..., Registry[object]]) -> None:
    assert brought("json:dumps", "json:dumps").get("kind").__module__ == "json"


def test_two_from_outside_under_one_name_are_refused(brought: Callable[..., Registry[object]]) -> None:
    with pytest.raises(ContestedNameError) as error:
        brought("pickle:dumps", "json:dumps").get("kind")
    said = "kind of test 'kind' is brought by json:dumps and by pickle:dumps: one of them needs another name"
    assert str(error.value) == said


def test_one_that_nobody_brings_is_unknown(brought: Callable[..., Registry[object]]) -> None:
    with pytest.raises(UnknownNameError, match=r"kind of test 'kin' is unknown.*did you mean kind"):
        brought("json:dumps").get("kin")
