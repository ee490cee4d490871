"""Values that no file says, and that follow from what other files say: laid under a file where it is silent.

Each remembers from what it follows, so that a resolved file and a message can tell.
"""

import dataclasses
from collections.abc import Mapping
from typing import NamedTuple, TypeAlias

from sojourn_config.yaml_file import Data, KeyPath, YamlDocument

KIND = "kind"
"""Key by which a table says what it is a table of."""


class DerivedValue(NamedTuple):
    """A value, and from what it follows, in words."""

    value: Data
    why: str


Derivation: TypeAlias = Mapping[str, "DerivedValue | Derivation"]
"""Tables of such values, by key."""


def with_derived(document: YamlDocument, derivation: Derivation) -> YamlDocument:
    """The document with the derived values where it has no key; what it says itself, `null` too, stays."""
    reasons = dict(document.derived)
    data = _filled(document.data, derivation, (), reasons)
    return dataclasses.replace(document, data=data, derived=reasons)


def laid_over(document: YamlDocument, below: YamlDocument, at: str | None = None) -> YamlDocument:
    """The document with the content of another file where it has no key of its own; in its table `at`, if that is
    given.
    """
    found = _as_derived(below, below.data, ())
    filled = with_derived(document, found if at is None else {at: found})
    return dataclasses.replace(filled, texts={**document.texts, **below.texts})


def _filled(
    own: Mapping[str, Data], derivation: Derivation, at: KeyPath, reasons: dict[KeyPath, str]
) -> dict[str, Data]:
    filled = dict(own)
    for key, found in derivation.items():
        path, said = (*at, key), own.get(key)
        if isinstance(found, DerivedValue):
            if key not in own:
                filled[key], reasons[path] = found
        elif _is_of_another_kind(said, found):
            continue
        elif key not in own or isinstance(said, dict):
            filled[key] = _filled(said if isinstance(said, dict) else {}, found, path, reasons)
    return filled


def _is_of_another_kind(said: Data, found: Derivation) -> bool:
    """Whether a table says that it is of another kind than what is derived: then nothing of it fits."""
    kind = found.get(KIND)
    return isinstance(said, dict) and isinstance(kind, DerivedValue) and said.get(KIND, kind.value) != kind.value


def _as_derived(document: YamlDocument, table: Mapping[str, Data], at: KeyPath) -> Derivation:
    found: dict[str, DerivedValue | Derivation] = {}
    for key, value in table.items():
        path = (*at, key)
        file, line = document.place(path)
        found[key] = (
            _as_derived(document, value, path) if isinstance(value, dict) else DerivedValue(value, f"{file}:{line}")
        )
    return found
