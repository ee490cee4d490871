"""Inputs that stay away, or cannot be used: after a while a goal that needs them is given up, with the reason."""

from collections.abc import Mapping, Sequence
from typing import Any

from sojourn_contract import stamps

PATIENCE_S = 3.0
"""Simulation time for which a goal waits for its inputs: three beats of the heart of whoever publishes them."""


def given_up(
    names: Sequence[str], stamp: int, usable_at: int | None, inputs: Mapping[str, Any], cause: str = ""
) -> str:
    """Why goals are given up in the period stamped `stamp` [ns], in words; "" while they need not be.

    Args:
        names: topics without which a node cannot follow a goal. usable_at: as `seen_usable` gives it.
        inputs: those of this period, None where one is missing. cause: in words, where it is known.
    """
    away_s = 0.0 if usable_at is None else stamps.seconds(stamp - usable_at)
    if away_s < PATIENCE_S:
        return ""
    missing = [name for name in names if inputs.get(name) is None] or names
    absent = f"no usable {' or '.join(missing)} for {away_s:.1f} s"
    return f"{absent}; {cause}" if cause else absent


def last_refused(refusal: str) -> str:
    """What has been refused last, and why, as a cause; "" for ""."""
    return f"last refused: {refusal}" if refusal else ""


def seen_usable(stamp: int, before: int | None, usable: bool) -> int:
    """Stamp [ns] of the last period in which the inputs could be used, or of the first one, after the period stamped
    `stamp`; `before`: what it was, None before the first. A clock that has been set back begins anew.
    """
    return stamp if usable or before is None or stamp < before else before
