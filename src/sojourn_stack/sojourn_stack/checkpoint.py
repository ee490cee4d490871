"""The state of a run as a file, and back: save it, and go on from it in another process.

The file is a ZIP: `state.json`, a tree of plain values, and its arrays in numpy's own format, see `state_tree` of
sojourn_contract.
"""

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ConfigDict, TypeAdapter, ValidationError

from sojourn_contract.leaps import Leaps
from sojourn_contract.role_state import RoleState
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.state_tree import CheckpointError, TreeReader, TreeWriter, read_tree
from sojourn_stack.stack import StackState

FORMAT = 5
"""Of the file; another one is refused."""
PARTS = ("roles", "messages", "ahead", "leaps", "origin")
"""Of a file, besides what is plain."""
LAST_PERIOD = ((1 << 31) - 1) * NANOSECONDS // CONTROL_PERIOD_NS
"""A later one has no stamp: that of a message has 31 bits for its seconds."""


@dataclasses.dataclass(frozen=True)
class Origin:
    """Of which run a state is.

    Args:
        scenario: name, or absolute path. overrides: KEY=VALUE texts that went over it. participants: all roles.
        digests: SHA-256 of each file that was read, by name.
    """

    scenario: str
    overrides: tuple[str, ...]
    participants: tuple[str, ...]
    digests: Mapping[str, str]


_TYPES = TypeAdapter(
    tuple[
        Mapping[str, RoleState],
        Mapping[str, Mapping[int, tuple[Any, str]]],
        tuple[tuple[str, Any], ...],
        Leaps,
        Origin | None,
    ],
    config=ConfigDict(strict=True, revalidate_instances="always"),
)
"""Of PARTS."""


def save(state: StackState, file: Path, origin: Origin | None = None) -> None:
    """Write a state, and of which run it is.

    Raises:
        CheckpointError: it holds what cannot be kept. OSError: the file cannot be written.
    """
    writer = TreeWriter()
    roles = {role: writer.tree(one, role) for role, one in state.roles.items()}
    # messages have been said in another order in each layout
    messages = writer.tree(dict(sorted(state.messages.items())), "messages")
    tree = {
        "format": FORMAT,
        "period": state.period,
        "finished": state.finished,
        "roles": roles,
        "messages": messages,
        "ahead": writer.tree(tuple(sorted(state.ahead, key=lambda one: one[0])), "ahead"),
        "leaps": writer.tree(state.leaps, "leaps"),
        "origin": writer.tree(origin, "origin"),
    }
    fresh = file.with_name(file.name + ".new")
    writer.write(tree, fresh)
    fresh.replace(file)


def load(file: Path) -> StackState:
    """Read a state. Raises CheckpointError, which names the role whose state does not fit, for any other file."""
    return read(file)[0]


def read(file: Path) -> tuple[StackState, Origin | None]:
    """Read a state, and of which run it is, None where nobody has said it. Raises as `load`, and OSError."""
    found: tuple[StackState, Origin | None] = read_tree(file, str(file), lambda tree, reader: _read(tree, reader, file))
    return found


def _read(tree: Any, reader: TreeReader, file: Path) -> tuple[StackState, Origin | None]:
    found = tree.get("format") if isinstance(tree, dict) else None
    if found != FORMAT:
        raise CheckpointError(str(file), f"format {found!r}: allowed is {FORMAT}")
    period = tree["period"]
    if type(period) is not int or not 1 <= period <= LAST_PERIOD:
        raise CheckpointError("period", f"{str(period)[:40]}: allowed is 1 to {LAST_PERIOD}")
    if not isinstance(tree["roles"], dict):
        raise CheckpointError(
            "roles", f"a {type(tree['roles']).__name__}: allowed is a state of each role, by its name"
        )
    roles = {role: reader.value(one, role) for role, one in tree["roles"].items()}
    messages, ahead, leaps, origin = (reader.value(tree[part], part) for part in PARTS[1:])
    _check((roles, messages, ahead, leaps, origin))
    return StackState(period, roles, messages, bool(tree["finished"]), ahead, leaps), origin


def _check(parts: tuple[Any, ...]) -> None:
    """Raise CheckpointError where PARTS are not of the types that their classes say; apps know their own."""
    try:
        _TYPES.validate_python(parts)
    except ValidationError as error:
        first = error.errors()[0]
        part, *inside = first["loc"]
        place = [*([] if part == 0 and inside else [PARTS[int(part)]]), *map(str, inside)]
        allowed = first["msg"].removeprefix("Input should be ")
        raise CheckpointError(".".join(place), f"{str(first['input'])[:40]}: allowed is {allowed}") from error
