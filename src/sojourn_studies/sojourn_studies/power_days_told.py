"""Days of power in words, figures and files: the work of scripts/power_plan."""

import argparse
import csv
import json
import math
from collections.abc import Iterator
from pathlib import Path

from sojourn_config.command_errors import UsageError
from sojourn_config.scenario import load_scenario
from sojourn_studies.power_days import LONGEST_STEP, PowerDays, power_days, steps_of_a_day

MOST_STEPS = 1_000_000
CELSIUS = 273.15


def run(given: argparse.Namespace) -> int:
    """Print the days, write and draw them."""
    scenario = load_scenario(given.scenario, given.set)
    if not given.days > 0.0:
        raise UsageError(f"power_plan: --days {given.days:g}: allowed is more than 0")
    if not 1.0 <= given.step <= 3600.0:
        raise UsageError(f"power_plan: --step {given.step:g}: allowed is 1 to 3600 s")
    count = given.days * math.prod(steps_of_a_day(scenario, given.step))
    if count > MOST_STEPS:
        longer = " or a longer --step" if given.step < LONGEST_STEP else ""
        raise UsageError(f"power_plan: {count:.0f} steps: allowed are {MOST_STEPS}: fewer --days{longer}")
    found = power_days(scenario, given.days, given.step)
    if given.json:
        print(json.dumps(_figures(found), indent=1))
    else:
        print("\n".join(lines(found)))
    if given.csv is not None:
        _write(given.csv, found)
    if given.plot is not None:
        from sojourn_studies.power_days_plot import draw  # matplotlib, which the figures alone do not need

        draw(given.plot, found)
    return 0


def lines(found: PowerDays) -> Iterator[str]:
    """The days as a table, and what came first that limited the machine."""
    scenario = found.scenario
    day = scenario.body.solar_day / 3600.0
    yield f"{scenario.name}: {scenario.config.machine} on {scenario.body.name}, solar days of {day:.2f} h"
    yield ""
    yield "  day       h   offered     given      used    charge          modes"
    yield "                   [Wh]      [Wh]      [Wh]    least  most"
    for one in found.days():
        energies = f"{one.offered:10.1f}{one.given:10.1f}{one.used:10.1f}"
        modes = ", ".join(one.modes)
        yield f"{one.number:5d}{one.hours:8.2f}{energies}    {one.least:5.1%} {one.most:5.1%}    {modes}"
    yield ""
    limit = found.first_limit
    if limit is None:
        yield f"No limit is met; the charge is {found.charge.min():.1%} at least."
    else:
        yield f"First limit: {limit.what} after {limit.hours:.2f} h."
    if scenario.power.sources and not found.offered.any():
        why = ": the Sun does not shine on the machine" if found.lies_in_the_dark else ""
        yield f"No source gives anything in all this time ({', '.join(scenario.power.sources)}){why}."
    if short := scenario.power.lasting_shortfall():
        yield f"Whatever the light, {short}."
    if found.dead_at is not None:
        yield f"All stores are empty after {found.dead_at:.2f} h."
    for name, (hour, broken) in found.beyond_limits.items():
        yield f"{name}: {broken} from {hour:.2f} h on."
    told = {**dict(zip(scenario.power.all_stores, found.temperatures.T, strict=True)), **found.nodes}
    yield "Temperatures: " + ", ".join(
        f"{name} {values.min() - CELSIUS:.0f} to {values.max() - CELSIUS:.0f} C" for name, values in told.items()
    )
    yield f"At the end: charge {found.charge[-1]:.1%}, {found.steps[-1].manager.mode}."


def _figures(found: PowerDays) -> dict[str, object]:
    limit = found.first_limit
    return {
        "scenario": found.scenario.name,
        "machine": found.scenario.config.machine,
        "days": [one._asdict() for one in found.days()],
        "first_limit": None if limit is None else {"h": limit.hours, "what": limit.what},
        "empty_h": found.dead_at,
        "beyond_limits": {name: {"h": hour, "what": broken} for name, (hour, broken) in found.beyond_limits.items()},
        "coldest_k": {
            **dict(zip(found.scenario.power.all_stores, found.temperatures.min(axis=0).tolist(), strict=True)),
            **{name: float(values.min()) for name, values in found.nodes.items()},
        },
        "charge_at_end": float(found.charge[-1]),
        "mode_at_end": found.steps[-1].manager.mode,
        "energy_not_explained": found.imbalance,
    }


def _write(path: Path, found: PowerDays) -> None:
    """Every step that was asked for as a row: means of its powers, and what is at its end."""
    power = found.scenario.power
    loads = [f"load_{load.name}_w" for load in power.loads]
    stores = [(f"charge_{name}", f"temperature_{name}_k") for name in power.all_stores]
    nodes = [f"temperature_{name}_k" for name in found.nodes]
    head = ["hours", "offered_w", "given_w", *loads, *(name for pair in stores for name in pair), *nodes, "mode"]
    try:
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(head)
            for end in range(found.parts - 1, len(found.steps), found.parts):
                step, row = found.steps[end], slice(end + 1 - found.parts, end + 1)
                pairs = [value for pair in zip(step.charges, step.temperatures, strict=True) for value in pair]
                means = [found.offered[row].mean(), found.given[row].mean(), *found.used[row].mean(axis=0)]
                numbers = [found.hours[end], *means, *pairs, *(values[end] for values in found.nodes.values())]
                writer.writerow([*(f"{float(number):.6g}" for number in numbers), step.manager.mode])
    except OSError as error:
        raise UsageError(f"--csv {path}: {error}") from error
