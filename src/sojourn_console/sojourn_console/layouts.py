"""Layouts of plots that an operator has saved, by name: one JSON file in the user's folder of settings."""

import json
import os
import re
from pathlib import Path

from sojourn_console.errors import LayoutError

_NAME = re.compile(r"[\w .-]{1,40}")


def layouts_file() -> Path:
    """Where they are kept: $XDG_CONFIG_HOME/sojourn/console_layouts.json, in ~/.config where it is not set."""
    base = os.environ.get("XDG_CONFIG_HOME", "")
    return (Path(base) if base else Path.home() / ".config") / "sojourn" / "console_layouts.json"


def read_layouts(file: Path) -> dict[str, tuple[str, ...]]:
    """Fields by name of the layout; none where there is no file. Raises LayoutError for one that holds none."""
    try:
        document = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        raise LayoutError(str(file), f"cannot be read: {error}") from error
    if not isinstance(document, dict) or not all(
        isinstance(fields, list) and all(isinstance(one, str) for one in fields) for fields in document.values()
    ):
        raise LayoutError(str(file), "allowed is an object of lists of fields")
    return {str(name): tuple(fields) for name, fields in document.items()}


def save_layout(file: Path, name: str, fields: tuple[str, ...]) -> None:
    """Keep the fields under a name, in place of what has it. Raises LayoutError."""
    if not _NAME.fullmatch(name):
        raise LayoutError(name, "allowed are 1 to 40 letters, digits, spaces, points, dashes and underscores")
    if not fields:
        raise LayoutError(name, "there is nothing to keep: follow a field first")
    known = {**read_layouts(file), name: fields}
    text = json.dumps({key: list(value) for key, value in known.items()}, indent=1, ensure_ascii=False)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        beside = file.with_suffix(".new")
        beside.write_text(text + "\n", encoding="utf-8")
        beside.replace(file)
    except OSError as error:
        raise LayoutError(name, f"{file} cannot be written: {error}") from error
