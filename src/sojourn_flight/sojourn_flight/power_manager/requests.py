"""What an operator asks of the loads, and why it may not be: a request is carried out whole or not at all."""

from collections.abc import Mapping
from typing import TypeAlias

from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_machine.errors import InvalidValueError, UnknownNameError

Wanted: TypeAlias = tuple[bool, ...]
"""What an operator asked of each load, in the order of the parameters."""


def parse_switches(texts: Mapping[str, str]) -> Mapping[str, bool]:
    """Load name to on (True) or off (False). Raises InvalidValueError for another text, or where nothing is asked."""
    if not texts:
        raise InvalidValueError("request", "empty", "at least one load with on or off")
    for name, text in texts.items():
        if text not in ("on", "off"):
            raise InvalidValueError(f"switch of {name}", text, "on or off")
    return {name: text == "on" for name, text in texts.items()}


def switched(params: PowerManagerParams, wanted: Wanted, asked: Mapping[str, bool]) -> Wanted:
    """What is wanted of the loads after a request; of those that it does not name what was wanted before.

    Raises:
        UnknownNameError: a load that does not exist.
        InvalidValueError: an essential one that is to be off.
    """
    names = [load.name for load in params.loads]
    for name, on in asked.items():
        if name not in names:
            raise UnknownNameError("load", name, names)
        if not on and params.loads[names.index(name)].essential:
            switchable = ", ".join(load.name for load in params.loads if not load.essential)
            raise InvalidValueError(f"switch of essential load {name}", "off", f"on; may be off: {switchable}")
    return tuple(asked.get(name, old) for name, old in zip(names, wanted, strict=True))
