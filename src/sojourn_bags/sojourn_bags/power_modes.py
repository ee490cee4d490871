"""What the power manager did in a run, in words: its modes, and the charge that was left."""

from dataclasses import dataclass

from sojourn_bags.reading import Bag

STATUS = "/power/status"
USUAL = "NOMINAL"
TOLD = 4
"""Changes of the mode that are told one by one, at most."""


@dataclass(frozen=True)
class ModeChange:
    """From when on the power manager was in a mode."""

    time: float
    """Simulation time [s]."""
    mode: str

    def as_data(self) -> dict[str, float | str]:
        """As JSON has it."""
        return {"time_s": self.time, "mode": self.mode}


def mode_changes(bag: Bag) -> list[ModeChange]:
    """The first mode and all that differ from the one before; none where no power manager spoke of modes."""
    if STATUS not in bag:
        return []
    messages = bag[STATUS]
    found: list[ModeChange] = []
    for time, status in zip(messages.times.tolist(), messages.statuses(), strict=True):
        mode = status.get("mode", "")
        if mode and (not found or mode != found[-1].mode):
            found.append(ModeChange(time, mode))
    return found


def power_words(changes: list[ModeChange], charge: list[float]) -> str:
    """A sentence; "" where the mode was NOMINAL all along.

    Args:
        changes: of the mode. charge: of the first store over time [1]; empty where it is not known.
    """
    if all(change.mode == USUAL for change in changes):
        return ""
    told = [f"{change.mode} from {_time(change.time)} on" for change in changes[:TOLD]]
    if len(changes) > TOLD:
        more = len(changes) - TOLD
        told.append(f"{more} more change{'s' * (more > 1)} and {changes[-1].mode} at the end")
    left = ""
    if charge:
        left = f"; charge {charge[0]:.0%} at the start, {min(charge):.0%} at least, {charge[-1]:.0%} at the end"
    return f"Power: {', '.join(told)}{left}."


def _time(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"
