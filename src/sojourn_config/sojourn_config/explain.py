"""A validation error of pydantic as problems that a person can act on: key, value, what is allowed, unit.

The range and the description (with its unit) are taken from the field that refused the value, so that they
are never written twice.
"""

import types
import typing
from collections.abc import Iterator
from dataclasses import dataclass, field

import annotated_types
from pydantic import BaseModel, RootModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from sojourn_config.errors import MISSING, Problem
from sojourn_config.yaml_file import Data, KeyPath, YamlDocument
from sojourn_machine.choice import KindsOf
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.names import names_text, nearest

_BASE_WORDS: dict[object, str] = {
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    str: "text",
}


@dataclass
class KeySchema:
    """What the schema says about one key: its type, its bounds and its description."""

    annotation: object
    metadata: list[object] = field(default_factory=list)
    description: str = ""


def problems_of(error: ValidationError, model: type[BaseModel], document: YamlDocument) -> list[Problem]:
    """Every problem of a validation, in the order of the schema."""
    problems: list[Problem] = []
    listed: set[KeyPath] = set()
    for detail in error.errors(include_url=False):
        if _is_too_short_by_others(detail, document):
            continue
        if detail["type"] == "extra_forbidden":
            problems.append(_unknown_key(detail, model, document, listed))
        else:
            problems.append(_problem(detail, model, document))
    return problems


def allowed_text(place: KeySchema) -> str:
    """What may stand at a place, in words: `a number above 0, at most 1 (shear modulus [m])`."""
    words = _type_words(place.annotation)
    unit = "characters" if str in _members(place.annotation) else "values"
    bounds = ", ".join(_bounds(place.metadata, unit))
    text = f"{words} {bounds}" if bounds else words
    return f"{text} ({place.description})" if place.description else text


def place_of(model: type[BaseModel], path: KeyPath, data: Data) -> KeySchema | None:
    """What the schema says about the key at `path`; None where it knows no such key.

    Args:
        data: of the file. A table of it that names its kind has the keys of that kind alone.
    """
    place: KeySchema | None = KeySchema(model)
    here: Data = data
    for part in path:
        if place is None:
            return None
        here = _within(here, part)
        place = _child(place, part)
        if place is not None:
            place = _of_told_kind(place, here)
    return place


def _within(table: Data, part: str | int) -> Data:
    """What stands at a key of a table or a place of a list; None where nothing does."""
    if isinstance(table, dict) and isinstance(part, str):
        return table.get(part)
    if isinstance(table, list) and isinstance(part, int) and part < len(table):
        return table[part]
    return None


def _of_told_kind(place: KeySchema, table: Data) -> KeySchema:
    """The place with the schema of the kind that its table names, where it is a choice and the table names one."""
    for kinds in (item for item in place.metadata if isinstance(item, KindsOf)):
        told = table.get(kinds.key) if isinstance(table, dict) else None
        if isinstance(told, str) and told in kinds.registry.names():
            return _kind(kinds.registry.get(told))
    return place


def _is_too_short_by_others(detail: ErrorDetails, document: YamlDocument) -> bool:
    """Whether a list is too short only because values of it were refused, each of which has a problem of its own."""
    if detail["type"] != "too_short":
        return False
    _, value = _path_in_data(detail, document.data)
    return isinstance(value, list | dict) and len(value) >= detail["ctx"]["min_length"]


def _unknown_key(detail: ErrorDetails, model: type[BaseModel], document: YamlDocument, listed: set[KeyPath]) -> Problem:
    """An unknown key. The valid keys of a table are listed once, with the first one."""
    path, value = _path_in_data(detail, document.data)
    parent = place_of(model, path[:-1], document.data)
    names = _key_names(parent) if parent is not None else ()
    if path[:-1] not in listed:
        listed.add(path[:-1])
        return document.problem(path, value, "unknown key: " + names_text(str(path[-1]), names))
    hint = nearest(str(path[-1]), names)
    return document.problem(path, value, f"unknown key: did you mean {hint}?" if hint else "unknown key")


def _problem(detail: ErrorDetails, model: type[BaseModel], document: YamlDocument) -> Problem:
    path, value = _path_in_data(detail, document.data)
    kind = detail["type"]
    place = place_of(model, path, document.data)
    if kind == "missing":
        wanted = allowed_text(place) if place is not None else "a value"
        return document.problem(path, MISSING, f"the key is missing: allowed is {wanted}")
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        return _wrong_tag(detail, path, document)
    if kind in ("value_error", "assertion_error"):
        return _from_validator(detail, path, value, document)
    if place is None:
        return document.problem(path, value, detail["msg"])
    if kind == "string_pattern_mismatch":
        return document.problem(path, value, f"allowed is {allowed_text(place)}: {detail['msg']}")
    if isinstance(value, str) and _is_number(place.annotation):
        wanted = allowed_text(place)
        return document.problem(path, value, f"is text: allowed is {wanted}, with no quotes and no unit")
    if isinstance(value, str):
        choices = [str(choice) for choice in _choices(place.annotation)]
        if choices:
            return document.problem(path, value, names_text(value, choices))
    return document.problem(path, value, f"allowed is {allowed_text(place)}")


def _wrong_tag(detail: ErrorDetails, path: KeyPath, document: YamlDocument) -> Problem:
    """A table of several kinds whose key for the kind is missing, or names none of them."""
    context = detail.get("ctx", {})
    key = str(context.get("discriminator", "")).strip("'")
    if detail["type"] == "union_tag_not_found":
        return document.problem((*path, key), MISSING, "the key is missing: it says which kind of table this is")
    kinds = [kind.strip().strip("'") for kind in str(context.get("expected_tags", "")).split(",")]
    return document.problem((*path, key), context.get("tag"), names_text(str(context.get("tag")), kinds))


def _from_validator(detail: ErrorDetails, path: KeyPath, value: object, document: YamlDocument) -> Problem:
    """A check of the model itself: it may know better than pydantic which key is to blame."""
    error = detail.get("ctx", {}).get("error")
    if isinstance(error, InvalidValueError):
        named = path if path and path[-1] == error.name else (*path, error.name)
        return document.problem(named, error.value, f"allowed is {error.allowed}")
    message = str(error) if error is not None else detail["msg"]
    return document.problem(path, MISSING if isinstance(value, dict | list) else value, message)


def _path_in_data(detail: ErrorDetails, data: Data) -> tuple[KeyPath, object]:
    """The location without the names of union members, which are in no file, and the value there."""
    path: list[str | int] = []
    here: object = data
    location = [part for part in detail["loc"] if part != "[key]"]
    for index, part in enumerate(location):
        absent = detail["type"] == "missing" and index == len(location) - 1
        inside_table = isinstance(here, dict) and part in here
        inside_list = isinstance(here, list) and isinstance(part, int) and part < len(here)
        if inside_table or inside_list:
            here = here[part]  # type: ignore[index]
        elif not absent:
            continue
        path.append(part)
    return tuple(path), here


def _child(place: KeySchema, part: str | int) -> KeySchema | None:
    for annotation in _members(place.annotation):
        if isinstance(annotation, type) and issubclass(annotation, BaseModel) and isinstance(part, str):
            info = annotation.model_fields.get(part)
            if info is not None:
                return _schema(info.annotation, list(info.metadata), info.description or "")
            others = getattr(annotation, "others", None)
            if isinstance(others, KindsOf):  # any other key names a thing, by default one of the kind of that name
                if part not in others.registry.names():
                    return _schema(object, [others], "")
                named = _kind(others.registry.get(part))
                return KeySchema(named.annotation, [*named.metadata, others], named.description)
            continue
        origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
        element: object | None = None
        if origin is dict and len(arguments) == 2:
            element = arguments[1]
        elif origin is list and arguments:
            element = arguments[0]
        elif origin is tuple and arguments and isinstance(part, int):
            fixed = arguments[-1] is not Ellipsis
            element = arguments[part] if fixed and part < len(arguments) else arguments[0]
        if element is not None:
            return _unwrap(element, place.description)
    return None


def _kind(kind: type[BaseModel]) -> KeySchema:
    """Of a kind by its name; one that is no table is what stands there itself."""
    if issubclass(kind, RootModel):
        info = kind.model_fields["root"]
        return _schema(info.annotation, list(info.metadata), info.description or "")
    return KeySchema(kind)


def _unwrap(annotation: object, description: str) -> KeySchema:
    """The type and the bounds of `Annotated[...]`; the description of the table around it is kept."""
    if typing.get_origin(annotation) is not typing.Annotated:
        return KeySchema(annotation, [], description)
    inner, *extras = typing.get_args(annotation)
    metadata: list[object] = []
    for extra in extras:
        if isinstance(extra, FieldInfo):
            metadata.extend(extra.metadata)
            description = extra.description or description
        else:
            metadata.append(extra)
    return _schema(inner, metadata, description)


def _schema(annotation: object, metadata: list[object], description: str) -> KeySchema:
    """A choice of kinds is any of those that are registered; so each key of each of them is known."""
    for kinds in (item for item in metadata if isinstance(item, KindsOf)):
        registered = tuple(kinds.registry.get(name) for name in kinds.registry.names())
        return KeySchema(typing.Union[registered], metadata, description)  # noqa: UP007
    return KeySchema(annotation, metadata, description)


def _members(annotation: object) -> Iterator[object]:
    """The members of a union without None, or the type itself."""
    if typing.get_origin(annotation) in (typing.Union, types.UnionType):
        for member in typing.get_args(annotation):
            if member is not type(None):
                yield _unwrap(member, "").annotation
    else:
        yield annotation


def _key_names(place: KeySchema) -> tuple[str, ...]:
    names: list[str] = []
    for annotation in _members(place.annotation):
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            names.extend(annotation.model_fields)
            others = getattr(annotation, "others", None)
            names.extend(others.registry.names() if isinstance(others, KindsOf) else ())
    return tuple(dict.fromkeys(names))


def _choices(annotation: object) -> tuple[object, ...]:
    found: list[object] = []
    for member in _members(annotation):
        if typing.get_origin(member) is typing.Literal:
            found.extend(typing.get_args(member))
    return tuple(found)


def _is_number(annotation: object) -> bool:
    return any(member in (int, float) for member in _members(annotation))


def _type_words(annotation: object) -> str:
    return " or ".join(_member_words(member) for member in _members(annotation))


def _member_words(annotation: object) -> str:
    origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
    if annotation in _BASE_WORDS:
        return _BASE_WORDS[annotation]
    if origin is typing.Literal:
        return "one of " + ", ".join(str(choice) for choice in arguments)
    if origin is tuple and arguments and arguments[-1] is not Ellipsis:
        return f"a list of {len(arguments)} values"
    if origin in (tuple, list):
        return "a list"
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return "a table with the keys " + ", ".join(annotation.model_fields)
    return "a table" if origin is dict else "a value of its kind"


def _bounds(metadata: list[object], counted: str) -> Iterator[str]:
    for item in metadata:
        if isinstance(item, annotated_types.Gt):
            yield f"above {item.gt:g}" if isinstance(item.gt, int | float) else f"above {item.gt}"
        elif isinstance(item, annotated_types.Ge):
            yield f"at least {item.ge:g}" if isinstance(item.ge, int | float) else f"at least {item.ge}"
        elif isinstance(item, annotated_types.Lt):
            yield f"below {item.lt:g}" if isinstance(item.lt, int | float) else f"below {item.lt}"
        elif isinstance(item, annotated_types.Le):
            yield f"at most {item.le:g}" if isinstance(item.le, int | float) else f"at most {item.le}"
        elif isinstance(item, annotated_types.MinLen) and item.min_length:
            yield f"of at least {item.min_length} {counted}"
        elif isinstance(item, annotated_types.MaxLen):
            yield f"of at most {item.max_length} {counted}"
