"""Bench of what a rich power network costs a period: array, radioisotope generator, battery and capacitors on one bus,
and a thermal network of ten nodes, beside one battery alone.

Both are the explorer, on the same long drive. Two stacks with all roles and no recorder go in turns in one process, a
second of simulated time each, so that what the computer does besides falls on both alike. What counts is processor
time. The power manager looks ahead once a minute, which is spread over the minute.
"""

import statistics
import tempfile
import time
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from sojourn_config.collector import settle_collector
from sojourn_config.paths import config_folder
from sojourn_contract.topics import topic
from sojourn_studies.timed_loop import TURN, TimedLoop

SCENARIO, PLAIN = "mars_sol", "explorer"
LONG_DRIVE = (
    "steps=[{drive_to: {x: 36.0, y: 0.0}, timeout_s: 3000.0}]",
    "terrain.size_x=80.0",
    "duration_limit_s=3000.0",
)
"""In place of the five metres of the scenario."""
WARM_TURNS = 3
FORECAST = "/power/forecast"
EACH_MINUTE = topic(FORECAST).every // TURN
"""Turns from one look ahead to the next."""
COST = "rich network, a period costs more [%]"
TARGETS = {COST: ("<=", 5.0)}
NODES = (
    "electronics",
    "cells",
    "bank",
    "front_motors",
    "rear_motors",
    "arm_motors",
    "mast",
    "deck",
    "shell",
    "generator_case",
)
"""In a chain from the warm box outwards; the outermost radiate."""
OUTSIDE = NODES[6:]
RICH: Mapping[str, dict[str, Any]] = {
    "machine": {},
    "sensors": {},
    "flight": {},
    "power": {
        "stores": {
            "capacitors": {
                "kind": "supercapacitor", "capacitance": 58.0, "resistance": 0.015, "leak_resistance": 5000.0,
                "voltage_empty": 18.0, "voltage_full": 33.6, "current_limit": 100.0, "temperature_surroundings": 288.15,
            }
        },
        "sources": {"array": {"extends": "mer_array"}, "generator": {"extends": "mmrtg"}},
    },
    "thermal": {
        "nodes": {
            name: {"heat_capacity": 4000.0, "temperature": 280.0}
            | (
                {"emissivity": 0.8, "area_to_sky": 0.4, "area_to_ground": 0.3, "absorptivity": 0.3, "area_to_sun": 0.2}
                if name in OUTSIDE
                else {}
            )
            for name in NODES
        },
        "conductors": [
            {"between": list(pair), "conductance": 0.2, "radiating_area": 0.02} for pair in pairwise(NODES)
        ],
        "heaters": {"survival_heater": {"node": "cells", "power_w": 10.0, "on_below": 275.0, "off_above": 280.0}},
        "radioisotope_heaters": [{"node": "electronics", "count": 6}],
        "warms": {
            "computer": "electronics", "receiver": "electronics", "imu": "electronics", "battery": "cells",
            "capacitors": "bank", "drive": "front_motors", "steer": "rear_motors", "arm": "arm_motors",
            "cameras": "mast", "actuator_heater": "deck", "generator": "generator_case",
        },
    },
}  # fmt: skip
"""What its files say over those of the plain machine."""


def write_rich_machine(folder: Path) -> Path:
    """A folder of the rich machine in an existing one; returns its path."""
    made, plain = folder / "rich", config_folder().resolve() / "machines" / PLAIN
    made.mkdir()
    for name, tables in RICH.items():
        above = plain / f"{name}.yaml"
        told = {"extends": str(above)} if above.is_file() else {}
        (made / above.name).write_text(yaml.safe_dump(told | tables, sort_keys=False), "utf-8")
    return made


class TimedTurn(NamedTuple):
    """A second of simulated time."""

    seconds: float
    """That it took of the processor [s]."""
    looked: bool
    """Whether the power manager looked ahead in it."""


def bench_network(turns: int) -> dict[str, float]:
    """What a period costs with the plain and with the rich network, and the difference.

    Args:
        turns: that count; a minute of them or more has a look ahead [1].
    """
    with tempfile.TemporaryDirectory(prefix="sojourn-bench-") as folder:
        machines = {"plain": PLAIN, "rich": str(write_rich_machine(Path(folder)))}
        loops = {
            name: TimedLoop(SCENARIO, (f"machine={machine}", *LONG_DRIVE), time.process_time)
            for name, machine in machines.items()
        }
    settle_collector()
    taken = {name: list[TimedTurn]() for name in loops}
    for number in range(WARM_TURNS + turns):
        for name in sorted(loops, reverse=bool(number % 2)):
            turn = TimedTurn(*loops[name].turn(FORECAST))
            if number >= WARM_TURNS:
                taken[name].append(turn)
    return figures(taken["plain"], taken["rich"])


def figures(plain: Sequence[TimedTurn], rich: Sequence[TimedTurn]) -> dict[str, float]:
    """Of turns that were taken one beside the other.

    A period is dearer by the median of the ratios, turn by turn, and by what a look ahead of the rich machine takes
    more than that of the plain one, spread over its minute: the median over the looks, each told in turns of the plain
    machine beside it, which the computer took as quickly.
    """
    pairs = [pair for pair in zip(plain, rich, strict=True) if not (pair[0].looked or pair[1].looked)]
    usual, richer = (statistics.median(turn.seconds for turn in turns) for turns in zip(*pairs, strict=True))
    dearer = statistics.median(other.seconds / one.seconds for one, other in pairs) - 1.0
    looks = [
        (_look(rich, place) - _look(plain, place)) / (EACH_MINUTE * _beside(plain, place))
        for place, turn in enumerate(plain)
        if turn.looked
    ]
    ahead = statistics.median(looks) if looks else 0.0
    return {
        "plain network, a period [us]": usual / TURN * 1e6,
        "rich network, a period [us]": richer / TURN * 1e6,
        COST: 100.0 * (dearer + ahead),
        "  of it the look ahead, once a minute [%]": 100.0 * ahead,
    }


def _look(turns: Sequence[TimedTurn], place: int) -> float:
    """What one look ahead takes, beyond the turns beside its own [s]."""
    return turns[place].seconds - _beside(turns, place)


def _beside(turns: Sequence[TimedTurn], place: int) -> float:
    """What the turns before and after one take, in the mean [s]."""
    return statistics.mean(turn.seconds for turn in (*turns[max(place - 1, 0) : place], *turns[place + 1 : place + 2]))
