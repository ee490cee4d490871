"""Picture of the manuals: a battery that runs down."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from sojourn_config.scenario import LoadedScenario
from sojourn_flight.power_manager import law as manager
from sojourn_flight.power_manager.reading import StoreReading
from sojourn_machine.power.network import PowerNetwork
from sojourn_studies.picture_style import BLUE, GREEN, GREY, ORANGE, PINK


def power(scenario: LoadedScenario) -> Figure:
    """The battery runs down with 60 W of driving: charge, voltage, and which loads the manager sheds."""
    network, params = PowerNetwork(scenario.power), scenario.power_manager
    loads = scenario.power.loads
    names = [load.name for load in loads]
    demand = np.array([{"drive": 50.0, "steer": 5.0, "arm": 5.0}.get(name, 0.0) for name in names])
    state, mind = network.initial_state(0.32), manager.initial_state(params)
    fractions, rows, dt = np.ones(len(names)), [], 2.0
    for step in range(6000):
        state, output = network.step(state, fractions, demand, dt)
        store = state.stores[0]
        reading = StoreReading(output.voltage, output.store_currents[0], store.temperature)
        mind, command = manager.step(params, mind, manager.PowerManagerInput((reading,)), dt)
        fractions = np.array(command.fractions)
        rows.append((step * dt / 3600.0, store.soc, command.soc, output.voltage, output.load_power.sum(), *fractions))
        if store.soc < 0.04:
            break
    time, true_soc, soc, voltage, watts, *switches = np.array(rows).T
    figure, axes = plt.subplots(
        3,
        1,
        figsize=(8.5, 6.6),
        layout="constrained",
        sharex=True,
        gridspec_kw={"height_ratios": [1.0, 1.0, 1.5]},
    )
    axes[0].plot(time, 100 * true_soc, color=BLUE, linewidth=2.0, label="true")
    axes[0].plot(time, 100 * soc, color=ORANGE, linewidth=1.4, linestyle="--", label="estimated by the manager")
    axes[0].set(ylabel="charge [%]", title="The battery runs down: the least important loads go first")
    axes[0].legend(frameon=False)
    axes[1].plot(time, watts, color=GREEN, linewidth=1.6)
    axes[1].set(ylabel="power drawn [W]", ylim=(0.0, None))
    volts = axes[1].twinx()
    volts.plot(time, voltage, color=PINK, linewidth=1.4)
    volts.set_ylabel("bus [V]", color=PINK)
    volts.grid(False)
    order = sorted(range(len(names)), key=lambda i: (loads[i].essential, loads[i].priority, i))
    for place, index in enumerate(reversed(order)):
        axes[2].fill_between(
            time,
            place - 0.36,
            place - 0.36 + 0.72 * switches[index],
            step="post",
            linewidth=0,
            color=GREY if loads[index].essential else BLUE,
        )
    axes[2].set_yticks(range(len(names)), [names[i].replace("_", " ") for i in reversed(order)])
    axes[2].set(xlabel="time [h]", xlim=(0.0, time[-1]), title="Loads switched on (grey: essential, never shed)")
    axes[2].grid(axis="y", visible=False)
    return figure
