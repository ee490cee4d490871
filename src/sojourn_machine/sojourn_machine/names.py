"""Words for a name that does not exist: which names do, and the nearest of them."""

import difflib
from collections.abc import Iterable


def nearest(name: str, valid: Iterable[str]) -> str | None:
    """The valid name most like `name`, or None where none is like it."""
    by_lower = {candidate.lower(): candidate for candidate in valid}
    found = difflib.get_close_matches(name.lower(), list(by_lower), n=1, cutoff=0.5)
    return by_lower[found[0]] if found else None


def names_text(name: str, valid: Iterable[str]) -> str:
    """Words for "`name` is wrong, these are the names": the list, and the nearest one."""
    names = sorted(valid)
    if not names:
        return "allowed is nothing: no name exists"
    hint = nearest(name, names)
    return "allowed is one of " + ", ".join(names) + (f"; did you mean {hint}?" if hint else "")
