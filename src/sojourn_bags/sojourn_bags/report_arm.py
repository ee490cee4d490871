"""Panels of the report for a machine that does not drive: where its arm was, how fast, and how far off its command."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes

from sojourn_bags.curves import short_name
from sojourn_bags.machine import FloatArray
from sojourn_bags.reading import Bag
from sojourn_machine.machine import MachineParams

Curves = Callable[[Axes, FloatArray, FloatArray, Sequence[str]], None]
"""Draws columns of values over time, with names."""


def draw_standing_arm(
    panels: Sequence[Axes], bag: Bag, machine: MachineParams, joints: Sequence[str], curves: Curves
) -> None:
    """Fill four panels.

    Args:
        machine: that carries it. joints: of the arm. curves: draws columns of values over times into axes, with their
        names.
    """
    states = bag["/truth/joint_states"]
    truth = states.joints()
    columns = [truth.index(joint) for joint in joints]
    names = [short_name(joint) for joint in joints]
    positions, rates = truth.position[:, columns], truth.velocity[:, columns]
    curves(panels[0], states.times, positions, names)
    panels[0].set(title="Positions of the arm's joints", ylabel="position [rad], [m]")
    curves(panels[1], states.times, rates, names)
    panels[1].set(title="Speeds of the arm's joints", ylabel="speed [rad/s], [m/s]")
    curves(panels[2], states.times, 1e3 * (positions - _commanded(bag, joints, states.times)), names)
    panels[2].set(title="Truth less command", ylabel="[mrad], [mm]")
    loads = bag["/truth/loads"]
    names = list(machine.loads_of(joints))
    power = np.array([[float(status.get(f"power {name}", "nan")) for name in names] for status in loads.statuses()])
    curves(panels[3], loads.times, power, names)
    panels[3].set(title="Power of the arm's motors", ylabel="power [W]")


def _commanded(bag: Bag, joints: Sequence[str], times: FloatArray) -> FloatArray:
    """Positions last commanded at each time, (times, joints); NaN before the first command."""
    if "/arm_command" not in bag:
        return np.full((len(times), len(joints)), np.nan)
    commands = bag["/arm_command"]
    told = commands.joints()
    rows = np.searchsorted(commands.times, times + 1e-9) - 1
    values = told.position[:, [told.index(joint) for joint in joints]]
    return np.where((rows >= 0)[:, np.newaxis], values[np.maximum(rows, 0)], np.nan)
