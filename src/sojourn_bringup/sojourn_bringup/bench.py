"""Bench: what a step costs, how fast the loop runs, what a start takes. scripts/bench prints a table and writes JSON.

The figures hold for the machine and the load of the moment: quote medians and ratios. The floor of a plant step is what
its libraries alone would take, measured in the same run: Pinocchio's aba, forwardKinematics and computeJointJacobians,
and the contact kernel.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from sojourn_bringup import bench_arm, bench_arm_limits, bench_commands, bench_machine, bench_wheel, options, start
from sojourn_bringup.bench_contacts import NOT_FINITE, bench_contacts
from sojourn_bringup.bench_ground import bench_ground
from sojourn_bringup.errors import BringupError
from sojourn_bringup.screen import Screen
from sojourn_config.scenario import load_scenario
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_mechanics.contact.contact_set import contact_forces
from sojourn_mechanics.plant.model import PlantModel
from sojourn_mechanics.plant.state import PlantState, zeros_command
from sojourn_mechanics.plant.step import step
from sojourn_plant.start import build_plant

SCENARIO = "lunar_sample"
ROUNDS = 9
PERIODS_A_ROUND = 50
CALLS_A_ROUND = 1000
WHEEL_RATE = 0.5
TARGETS = {
    "plant step [us]": ("<=", 60.0),
    "plant step over floor": ("<=", 2.5),
    NOT_FINITE: ("<=", 0.0),
    "composed, times real time": (">=", 6.0),
    "processes, times real time": (">=", 5.0),
    **bench_arm.TARGETS,
    **bench_arm_limits.TARGETS,
    **bench_wheel.TARGETS,
    **bench_commands.TARGETS,
    **bench_machine.TARGETS,
}


def bench_step() -> dict[str, float]:
    """Microseconds of a physics step while driving, of its floor, and the plant's own speed; medians over rounds."""
    model, state = build_plant(load_scenario(SCENARIO))
    command = zeros_command(len(model.joints.names), len(model.bus.loads))
    command.reference[0] = state.motor_angles
    drives = model.reference_rows([wheel.joint for wheel in model.machine.wheels])
    command.reference[1, drives] = WHEEL_RATE
    state, _ = step(model, state, command)
    calls = _floor_calls(model, state)
    names = [*calls, "step"]
    samples: dict[str, list[float]] = {name: [] for name in names}
    for _ in range(ROUNDS):
        for name, call in calls.items():
            samples[name].append(_microseconds(call, CALLS_A_ROUND))
        begin = time.perf_counter()
        for _ in range(PERIODS_A_ROUND):
            state, _ = step(model, state, command)
        steps = PERIODS_A_ROUND * model.simulation.substeps
        samples["step"].append((time.perf_counter() - begin) / steps * 1e6)
    medians = {name: statistics.median(values) for name, values in samples.items()}
    floor = sum(medians[name] for name in calls)
    per_wheel = medians["contact kernel"] / model.contacts.wheel_count
    return {
        "plant step [us]": medians["step"],
        "floor of the step [us]": floor,
        "plant step over floor": medians["step"] / floor,
        **{f"  {name} [us]": medians[name] for name in calls},
        "contact kernel for each wheel [us]": per_wheel,
        "plant alone, times real time": CONTROL_PERIOD_S / (medians["step"] * 1e-6 * model.simulation.substeps),
    }


def bench_loop(kind: str, seconds: float) -> dict[str, float]:
    """Speed, start-up and memory of the whole loop, recorder running, in a process of its own.

    Args:
        kind: "composed" or "processes". seconds: simulated time [s].
    """
    with tempfile.TemporaryDirectory(prefix="sojourn-bench-") as folder:
        command = [sys.executable, "-m", "sojourn_bringup.bench", "--child", kind, "--seconds", str(seconds)]
        command += ["--run-dir", str(Path(folder) / "run"), "--began", repr(time.monotonic())]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise BringupError(f"the bench of {kind} failed: {done.stderr.strip() or done.stdout.strip()}")
    figures: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return figures


def _child(given: argparse.Namespace) -> int:
    """One run of the loop; prints its figures as JSON."""
    wishes = [SCENARIO, "--run-dir", given.run_dir, "--domain", str(given.domain)]
    wishes += ["--set", f"duration_limit_s={given.seconds}"]
    screen = Screen(Console(file=open(os.devnull, "w")))  # noqa: SIM115 - for the life of the process
    plan = start.make_plan(start.parser().parse_args(wishes), screen)
    figures: dict[str, float] = {}
    if given.child == "composed":
        from sojourn_bringup.composed import ComposedRun

        composed = ComposedRun(plan, screen)
        outcome = composed.run()
        began = composed.stopwatch.began_at
        figures["composed, memory [MB]"] = _memory_mb()
    else:
        from sojourn_bringup.supervisor import Supervisor

        supervisor = Supervisor(plan, screen)
        outcome = supervisor.run()
        began = supervisor.stopwatch.began_at
        for role, node in supervisor.nodes.items():
            figures[f"processes, memory of {role} [MB]"] = node.peak_memory_mb
    if not outcome.wall_time_s or outcome.sim_time_s < 0.9 * given.seconds:
        print(outcome.message, file=sys.stderr)
        return 1
    figures[f"{given.child}, times real time"] = outcome.sim_time_s / outcome.wall_time_s
    figures[f"{given.child}, start-up [s]"] = began - given.began
    print(json.dumps(figures))
    return 0


def _floor_calls(model: PlantModel, state: PlantState) -> dict[str, Callable[[], Any]]:
    multibody, data = model.multibody, model.data
    q, v, torque = state.configuration.copy(), state.velocity.copy(), np.zeros(model.multibody.nv)
    memory, report, force = state.contacts.copy(), model.report.copy(), np.zeros(multibody.nv)
    contacts, terrain = model.contacts, model.terrain
    pin.computeJointJacobians(multibody, data, q)
    placements, jacobian = model.placements.copy(), np.asfortranarray(model.jacobian.copy())

    def contact() -> None:
        contact_forces(
            contacts.wheels, contacts.bodies, contacts.supports, contacts.offsets, contacts.wheel_count, placements,
            jacobian, v, terrain.heights, terrain.soil_index, model.grid, model.soils, model.rim, model.memory.tables,
            model.simulation.physics_step, memory, report, force,
        )  # fmt: skip

    return {
        "aba": lambda: pin.aba(multibody, data, q, v, torque),
        "forwardKinematics": lambda: pin.forwardKinematics(multibody, data, q),
        "computeJointJacobians": lambda: pin.computeJointJacobians(multibody, data, q),
        "contact kernel": contact,
    }


def _microseconds(call: Callable[[], Any], count: int) -> float:
    call()
    begin = time.perf_counter()
    for _ in range(count):
        call()
    return (time.perf_counter() - begin) / count * 1e6


def _memory_mb() -> float:
    fields = Path("/proc/self/statm").read_text().split()
    return int(fields[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def _table(figures: dict[str, float]) -> Table:
    table = Table("figure", "measured", "to reach", title="Bench")
    for name, value in figures.items():
        sign, target = TARGETS.get(name, ("", 0.0))
        met = not sign or (value <= target if sign == "<=" else value >= target)
        table.add_row(escape(name), f"{value:.2f}", f"{sign} {target:g}" if sign else "", style=None if met else "red")
    return table


PARTS = {
    "step": bench_step,
    "wheel": bench_wheel.bench_wheel,
    "contacts": bench_contacts,
    "ground": bench_ground,
    "arm": lambda: bench_arm.inverse_kinematics() | bench_arm_limits.plan_through_points(),
    "arm_limits": bench_arm_limits.random_goals,
    "wheels": bench_machine.bench_wheels,
    "energy": bench_machine.bench_energy,
}
LOOPS = ("composed", "processes")
COMMANDS = "commands"


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print a table, write JSON."""
    parser = options.Parser(
        prog="bench",
        description="Measure the plant's step, contacts, inverse kinematics, the loop's speed, start-up and memory.",
    )
    parser.add_argument("--seconds", type=options.positive_seconds, default=40.0, help="simulated time of a run [s]")
    parser.add_argument("--rounds", type=int, default=3, help="runs of the loop; the median counts")
    parser.add_argument("--json", type=Path, default=Path("bench.json"), help="file to write (default: %(default)s)")
    parser.add_argument(
        "--only",
        action="append",
        choices=(*PARTS, *LOOPS, COMMANDS),
        help="measure this part; again for more (default: all)",
    )
    for hidden in ("--child", "--run-dir", "--began"):
        parser.add_argument(hidden, help=argparse.SUPPRESS)
    options.add_place(parser)
    given = parser.parse_args(arguments)
    if given.child:
        given.began = float(given.began)
        return _child(given)
    figures: dict[str, float] = {}
    for part in given.only or (*PARTS, *LOOPS, COMMANDS):
        if part == COMMANDS:
            figures |= bench_commands.bench_commands(given.domain)
            continue
        if part in PARTS:
            figures |= PARTS[part]()
            continue
        runs = [bench_loop(part, given.seconds) for _ in range(given.rounds)]
        figures |= {name: statistics.median(run[name] for run in runs) for name in runs[0]}
    Console().print(_table(figures))
    given.json.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    options.run_script(main)
