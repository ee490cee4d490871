"""A battery pack to its kernels, and what it remembers."""

from dataclasses import dataclass

from sojourn_machine.power.battery_kernels import PackTables


@dataclass(frozen=True, eq=False, slots=True)
class Pack:
    """What the kernels are given of a pack that does not change. Parameters are compared without it."""

    tables: PackTables
    falls: tuple[float, ...]
    """Of the voltage between the points of its table, with the charge out of it [V/C]."""
    full_voltage: float
    """Of the rested full pack [V]."""
    largest_charge: float
    """Limit of the charging current [A]."""


@dataclass(frozen=True, slots=True)
class PackState:
    """What a pack remembers. Energies and charge are sums since `initial_state`."""

    soc: float
    """State of charge [1]; a little below 0 is possible in the step that empties the pack."""
    polarisation_voltage: float
    """Voltage of the polarisation pair of the pack, positive in discharge [V]."""
    temperature: float
    """Temperature of the cells [K]."""
    charge_drawn: float = 0.0
    """Net charge through the terminals, out positive [C]."""
    energy_terminal: float = 0.0
    """Net energy through the terminals, out positive [J]."""
    energy_heat: float = 0.0
    """Heat released in the cells [J]."""
