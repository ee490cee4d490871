"""Files as they come out, with what they build on and overrides: YAML, each value with the place where it is written.

What no file says has the default of its schema, and is not shown.
"""

import json
import re
from collections.abc import Iterator, Mapping

from sojourn_config.yaml_file import Data, KeyPath, YamlDocument, plain_scalar

_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_./-]*")
COLUMN = 72
"""Where the places begin, if the value leaves room."""


def resolved_text(documents: Mapping[str, YamlDocument]) -> str:
    """All of a run's files.

    Args:
        documents: by role, as `machine`.
    """
    parts = []
    for role, document in documents.items():
        parts.append(f"# {role}: {document.file}")
        parts += _table(document, document.data, (), "")
        parts.append("")
    return "\n".join(parts)


def _table(document: YamlDocument, table: Mapping[str, Data], at: KeyPath, indent: str) -> Iterator[str]:
    for key, value in table.items():
        yield from _entry(document, f"{indent}{key}:", value, (*at, key), indent + "  ")


def _entry(document: YamlDocument, head: str, value: Data, at: KeyPath, indent: str) -> Iterator[str]:
    if isinstance(value, dict) and value:
        yield head
        yield from _table(document, value, at, indent)
    elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
        yield head
        for index, item in enumerate(value):
            yield from _item(document, item, (*at, index), indent)
    else:
        file, line = document.place(at)
        yield f"{head} {_inline(value)}".ljust(COLUMN) + f" # {file}" + ("" if line is None else f":{line}")


def _item(document: YamlDocument, item: Data, at: KeyPath, indent: str) -> Iterator[str]:
    if not isinstance(item, dict) or not item:
        yield from _entry(document, f"{indent}-", item, at, indent + "  ")
        return
    first, *others = _table(document, item, at, indent + "  ")
    yield f"{indent}- {first.lstrip()}"
    yield from others


def _inline(value: Data) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    if isinstance(value, str) and _PLAIN.fullmatch(value) and plain_scalar(value) == value:
        return value
    return json.dumps(value, ensure_ascii=False)
