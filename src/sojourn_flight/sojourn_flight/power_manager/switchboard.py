"""What each load is switched to, and why.

It follows from few things that seldom change (`Grounds`), so that what was worked out of them is kept.
"""

from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias

from sojourn_flight.power_manager.modes import Mode, mode_of
from sojourn_machine.power.loads import LoadParams

if TYPE_CHECKING:
    from sojourn_flight.power_manager.params import PowerManagerParams

SwitchMode: TypeAlias = Literal["on", "off", "limit"]

KEPT = 256
"""Orders, before all are forgotten: a drive fraction that moves makes new ones each period."""


class Grounds(NamedTuple):
    """What the switches go by."""

    wanted: tuple[bool, ...]
    """What the operator asked of each load."""
    by_charge: int
    """Levels shed for low charge [1]."""
    by_voltage: int
    """Levels shed for low voltage [1]."""
    asleep: bool
    drive_fraction: float
    """Fraction of its power that the bus voltage allows a load which drives the machine [1]."""


class LoadSwitch(NamedTuple):
    """The command to one load."""

    name: str
    mode: SwitchMode
    fraction: float
    """0 off to 1 on; between, the part of its power that the load may take [1]."""
    reason: str


class Orders(NamedTuple):
    """What is switched in a period."""

    mode: Mode
    shed_level: int
    """Levels shed, 0 none [1]."""
    switches: tuple[LoadSwitch, ...]
    """One for each load, in the order of the parameters."""
    fractions: tuple[float, ...]
    """Theirs, as the network takes them."""
    on: tuple[bool, ...]
    """Whether each has any power."""


class Switchboard:
    """The switches of a machine's loads."""

    def __init__(self, params: "PowerManagerParams") -> None:
        self._params = params
        self._known: dict[Grounds, Orders] = {}

    def orders(self, grounds: Grounds) -> Orders:
        """What follows from them."""
        known = self._known.get(grounds)
        if known is None:
            if len(self._known) >= KEPT:
                self._known.clear()
            known = self._known[grounds] = self._worked_out(grounds)
        return known

    def level_reason(self, grounds: Grounds, level: int) -> str:
        """Why so many levels are shed, in words."""
        if level == 0:
            return "nothing is shed"
        return f"{level} of {len(self._params.shed_priorities)} levels shed: {self._shed_reason(grounds, level - 1)}"

    def _worked_out(self, grounds: Grounds) -> Orders:
        params = self._params
        levels = len(params.shed_priorities)
        level = levels if grounds.asleep else max(grounds.by_charge, grounds.by_voltage)
        shed = params.shed_priorities[:level]
        switches = tuple(
            self._switch(grounds, load, granted, shed) if wanted or load.essential else _switched_off(load)
            for load, wanted, granted in zip(params.loads, grounds.wanted, params.granted, strict=True)
        )
        return Orders(
            mode_of(params.loads, shed, levels, grounds.asleep),
            level,
            switches,
            tuple(switch.fraction for switch in switches),
            tuple(switch.fraction > 0.0 for switch in switches),
        )

    def _switch(
        self, grounds: Grounds, load: LoadParams, granted: tuple[float, str], shed: tuple[int, ...]
    ) -> LoadSwitch:
        sleep = self._params.law.sleep
        if load.essential:
            if grounds.asleep and sleep is not None and load.name in sleep.loads:
                return LoadSwitch(load.name, "off", 0.0, "asleep")
            return LoadSwitch(load.name, "on", 1.0, "essential")
        if load.priority in shed:
            return LoadSwitch(load.name, "off", 0.0, f"shed: {self._shed_reason(grounds, shed.index(load.priority))}")
        fraction, reason = granted
        if load.name in self._params.derated and grounds.drive_fraction < 1.0:
            fraction, reason = fraction * grounds.drive_fraction, "bus voltage is low"
        mode: SwitchMode = "on" if fraction >= 1.0 else "limit" if fraction > 0.0 else "off"
        return LoadSwitch(load.name, mode, fraction, reason)

    def _shed_reason(self, grounds: Grounds, rank: int) -> str:
        """Why a level is shed, in words."""
        if rank < grounds.by_charge:
            return self._params.shed_words[rank]
        if rank < grounds.by_voltage:
            return f"bus was below {self._params.law.shed_voltage:.1f} V"
        return "asleep"


def _switched_off(load: LoadParams) -> LoadSwitch:
    return LoadSwitch(load.name, "off", 0.0, "switched off by the operator")
