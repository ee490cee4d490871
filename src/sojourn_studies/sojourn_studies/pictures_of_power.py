"""Picture of the manuals: a battery that runs down."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from sojourn_config.scenario import LoadedScenario
from sojourn_flight.power_manager import law as manager
from sojourn_machine.power import battery, loads
from sojourn_studies.picture_style import BLUE, GREEN, GREY, ORANGE, PINK


def power(scenario: LoadedScenario) -> Figure:
    """The battery runs down with 60 W of driving: charge, voltage, and which loads the manager sheds."""
    pack, bus, params = scenario.battery, scenario.bus, scenario.power_manager
    names = [load.name for load in bus.loads]
    demand = np.array([{"drive": 50.0, "steer": 5.0, "arm": 5.0}.get(name, 0.0) for name in names])
    state, line, mind = battery.initial_state(pack, 0.32), loads.BusState(), manager.initial_state(params)
    fractions, rows, dt = np.ones(len(names)), [], 2.0
    for step in range(6000):
        source, resistance = battery.thevenin(pack, state)
        line, output = loads.step(bus, line, source, resistance, fractions, demand, dt)
        telemetry = manager.PowerManagerInput(output.voltage, output.current, state.temperature)
        mind, command = manager.step(params, mind, telemetry, dt)
        state = battery.step(pack, state, output.current, dt)
        fractions = np.array(command.fractions())
        rows.append((step * dt / 3600.0, state.soc, command.soc, output.voltage, output.load_power.sum(), *fractions))
        if state.soc < 0.04:
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
    order = sorted(range(len(names)), key=lambda i: (bus.loads[i].essential, bus.loads[i].priority, i))
    for place, index in enumerate(reversed(order)):
        axes[2].fill_between(
            time,
            place - 0.36,
            place - 0.36 + 0.72 * switches[index],
            step="post",
            linewidth=0,
            color=GREY if bus.loads[index].essential else BLUE,
        )
    axes[2].set_yticks(range(len(names)), [names[i].replace("_", " ") for i in reversed(order)])
    axes[2].set(xlabel="time [h]", xlim=(0.0, time[-1]), title="Loads switched on (grey: essential, never shed)")
    axes[2].grid(axis="y", visible=False)
    return figure
