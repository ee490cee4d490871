"""Panel of the report for a machine that floats: how its base gave way."""

import numpy as np
from matplotlib.axes import Axes

from sojourn_bags.afloat import base_motion
from sojourn_bags.curves import COLORS
from sojourn_bags.machine import TrueMachine
from sojourn_bags.reading import Bag


def draw_base(axes: Axes, bag: Bag, machine: TrueMachine) -> None:
    """Fill the panel that has the map of a machine on the ground."""
    motion = base_motion(bag, machine)
    for name, values, color in (("base_link", motion.base, COLORS[0]), ("centre of mass", motion.centre, COLORS[2])):
        axes.plot(motion.times, 1e3 * np.linalg.norm(values, axis=1), color=color, label=name)
    axes.set(title="Base since the start", ylabel="moved [mm]", xlabel="simulation time [s]")
    axes.grid(alpha=0.25)
    turned = axes.twinx()
    turned.plot(motion.times, np.degrees(motion.turn), color=COLORS[1], label="turn of base_link")
    turned.set_ylabel("turned [degree]", color=COLORS[1])
    turned.set_ylim(bottom=0.0)
    axes.set_ylim(bottom=0.0)
    lines = [*axes.get_lines(), *turned.get_lines()]
    axes.legend(lines, [str(line.get_label()) for line in lines], fontsize=8, loc="upper left", framealpha=0.85)
