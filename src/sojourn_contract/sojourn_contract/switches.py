"""The texts of /power/switches: for each load "on", "off", or the fraction of its power that it may draw."""

from collections.abc import Collection, Mapping

from sojourn_contract.errors import RefusedMessageError


def fraction_of(text: str) -> float | None:
    """Fraction that a switch's text stands for, 0 to 1, or None if it stands for none."""
    if text in ("on", "off"):
        return 1.0 if text == "on" else 0.0
    try:
        fraction = float(text)
    except ValueError:
        return None
    return fraction if 0.0 <= fraction <= 1.0 else None


def check_switches(topic: str, values: Mapping[str, str], loads: Collection[str] | None = None) -> None:
    """Raise RefusedMessageError for a text that is no switch, or a load that is not among `loads`, if
    given.
    """
    for load, text in values.items():
        if loads is not None and load not in loads:
            raise RefusedMessageError(topic, "status.values.key", load, "one of " + ", ".join(loads))
        if fraction_of(text) is None:
            raise RefusedMessageError(topic, f"status.values.{load}", text, "on, off, or a fraction from 0 to 1")
