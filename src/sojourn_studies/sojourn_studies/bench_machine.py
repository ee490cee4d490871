"""Machines in the bench: cost of a physics step against the number of wheels, and the energy account of a long drive.

The machines with 4 to 20 wheels are rigid platforms that differ in the number of axles alone: each wheel is one of the
explorer, with its motor and its load. A straight line is fitted to the medians, t = a + b n, and next to it a parabola,
whose square term tells what is not a straight line.
"""

import statistics
import time

import numpy as np

from sojourn_config.command_errors import CommandError
from sojourn_config.scenario import load_scenario
from sojourn_physics.plant.model import PlantModel, Site
from sojourn_physics.plant.state import EnergyAccount, PlantCommand, PlantState, zeros_command
from sojourn_physics.plant.step import initial_state, step
from sojourn_plant.start import build_plant
from sojourn_studies.wheeled_platform import Chassis, wheeled_platform

SCENARIO = "flat_drive"
WHEELS = (4, 6, 8, 20)
SPACING = 0.7
"""Between axles [m]."""
MASS_PER_AXLE = 56.0
"""Of the chassis, so that a wheel carries what one of the explorer does [kg]."""
WHEEL_RATE = 0.5
"""[rad/s]"""
ROUNDS = 15
PERIODS_A_ROUND = 20
FAST = 0.8
"""Rate of the wheels on it [rad/s]."""
LEAST_SPEED = 0.03
"""Slower than that on average it has got stuck [m/s]."""
ROUGH_GROUND = (
    "terrain.kind=generated", "terrain.size_x=140", "terrain.size_y=60", "start.x=-55",
    "terrain.roughness.rms_slope_deg=3", "terrain.crater_law.diameter_max=3", "terrain.crater_law.density_at_1m=0.02",
    "terrain.crater_law.age_min=0.4", "terrain.rock_law.area_fraction=0.003", "terrain.rock_law.diameter_max=0.25",
)  # fmt: skip
NOT_ACCOUNTED = "long drive, energy not accounted for [%]"
TARGETS = {
    "wheels, worst residual of the line [%]": ("<=", 10.0),
    NOT_ACCOUNTED: ("<=", 1.0),
}


def bench_wheels() -> dict[str, float]:
    """Microseconds of a physics step for each number of wheels, and the straight line through them.

    The machines take turns, in rounds, so that a busy moment of the computer meets all; time of this process alone.
    """
    machines = {count: _driving(count) for count in WHEELS}
    samples: dict[int, list[float]] = {count: [] for count in WHEELS}
    for _ in range(ROUNDS):
        for count, (model, state, command) in machines.items():
            begin = time.process_time()
            for _ in range(PERIODS_A_ROUND):
                state, _ = step(model, state, command)
            steps = PERIODS_A_ROUND * model.simulation.substeps
            samples[count].append((time.process_time() - begin) / steps * 1e6)
            machines[count] = (model, state, command)
    costs = np.array([statistics.median(samples[count]) for count in WHEELS])
    counts = np.array(WHEELS, dtype=np.float64)
    slope, start = np.polyfit(counts, costs, 1)
    square = np.polyfit(counts, costs, 2)[0]
    residuals = costs - (start + slope * counts)
    return {
        **{f"step with {count} wheels [us]": float(cost) for count, cost in zip(WHEELS, costs, strict=True)},
        "wheels, line: each wheel [us]": float(slope),
        "wheels, line: without wheels [us]": float(start),
        "wheels, worst residual of the line [%]": float(100.0 * np.abs(residuals / costs).max()),
        "wheels, square term at 20 wheels [%]": float(100.0 * square * counts[-1] ** 2 / costs[-1]),
    }


def bench_energy(distance: float) -> dict[str, float]:
    """Energy account of a drive over rough ground, as far [m]."""
    used, seconds = long_drive(distance)
    parts = {name: getattr(used, name) / 3600.0 for name in used.__dataclass_fields__}
    return {
        "long drive [m]": distance,
        "long drive, time [s]": seconds,
        "long drive, electrical [Wh]": parts.pop("electrical"),
        **{f"  {name.replace('_', ' ')} [Wh]": part for name, part in parts.items()},
        NOT_ACCOUNTED: 100.0 * used.balance_error(EnergyAccount()),
    }


def long_drive(distance: float) -> tuple[EnergyAccount, float]:
    """What each term of the account grew by on a drive of the explorer over rough, cratered ground, ruts and all.

    Args:
        distance: [m], as the crow flies.

    Returns:
        the account since the start, and the time that it took [s].

    Raises:
        CommandError: it got stuck, rolled over or left the map.
    """
    model, start = build_plant(load_scenario(SCENARIO, ROUGH_GROUND))
    command = _command(model, start, FAST)
    period = model.simulation.control_period
    state = start
    while np.hypot(*(state.configuration[:2] - start.configuration[:2])) < distance:
        if state.tick * period * LEAST_SPEED > distance or state.off_terrain or state.rolled_over:
            raise CommandError(f"bench of energy: the drive came to an end at {state.configuration[:2]} m")
        state, _ = step(model, state, command)
    names = EnergyAccount.__dataclass_fields__
    used = EnergyAccount(**{name: getattr(state.energy, name) - getattr(start.energy, name) for name in names})
    return used, state.tick * period


def _driving(count: int) -> tuple[PlantModel, PlantState, PlantCommand]:
    """A platform that has begun to drive."""
    scenario = load_scenario(SCENARIO)
    axles = count // 2
    platform = wheeled_platform(
        [SPACING * (0.5 * (axles - 1) - number) for number in range(axles)],
        scenario.machine.wheels[0],
        scenario.machine.drives[:1],
        chassis=Chassis(MASS_PER_AXLE * axles),
    )
    soils, memory_cell = list(scenario.soils.values()), scenario.terrain.memory_cell
    site = Site(scenario.height_field(), soils, scenario.gravity_field, memory_cell)
    model = PlantModel(platform.urdf_xml, platform.machine, site, scenario.power, scenario.simulation)
    state = initial_state(model, 0.0, 0.0, 0.0, soc=0.8)
    command = _command(model, state)
    state, _ = step(model, state, command)
    return model, state, command


def _command(model: PlantModel, state: PlantState, rate: float = WHEEL_RATE) -> PlantCommand:
    """Wheels at a rate [rad/s], all other joints where they are."""
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    command.reference[1, model.reference_rows([wheel.joint for wheel in model.machine.wheels])] = rate
    return command
