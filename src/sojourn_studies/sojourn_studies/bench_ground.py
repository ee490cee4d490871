"""What the size of the map costs: the plant's step, while driving and leaving ruts, on maps of 5 cm and up to 1 km.

The cost must not grow with the map. Maps above 200 m are kept in single precision; 1 km square takes 2 GB, and is left
out where the machine has not three times that to spare.
"""

import statistics
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand, PlantState, zeros_command
from sojourn_physics.plant.step import step
from sojourn_physics.terrain.height_field import HeightField
from sojourn_plant.start import build_plant

SCENARIO = "flat_drive"
RESOLUTION_M = 0.05
WAVE_M, WAVE_HEIGHT_M = 3.0, 0.02
"""Length and height of the swell that the grounds have, so that they are not all zeros."""
BYTES_A_NODE = 5
ROOM = 3.0
"""Memory that must be free, over that of the map: there are copies while it is made."""
ROUNDS = 9
PERIODS_A_ROUND = 25
WARM_UP = 100


def bench_ground(sizes: Sequence[int]) -> dict[str, float]:
    """Microseconds of a physics step on maps of each size [m]; medians over rounds that alternate between the sizes."""
    scenario = load_scenario(SCENARIO, ["start.x=0.0"])
    machines = {size: _driving(scenario, size) for size in sizes if _fits(size)}
    samples: dict[int, list[float]] = {size: [] for size in machines}
    for _ in range(ROUNDS):
        for size, (model, state, command) in machines.items():
            begin = time.perf_counter()
            for _ in range(PERIODS_A_ROUND):
                state, _ = step(model, state, command)
            steps = PERIODS_A_ROUND * model.simulation.substeps
            samples[size].append((time.perf_counter() - begin) / steps * 1e6)
            machines[size] = (model, state, command)
    return {
        f"plant step on {size} m square at 5 cm [us]": statistics.median(values) for size, values in samples.items()
    }


def _driving(scenario: LoadedScenario, size: int) -> tuple[PlantModel, PlantState, PlantCommand]:
    """The machine on a map of this size [m], two seconds after it has set out."""
    model, state = build_plant(scenario, ground(size))
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    command.reference[1, model.reference_rows([wheel.joint for wheel in model.machine.wheels])] = 0.5
    for _ in range(WARM_UP):
        state, _ = step(model, state, command)
    return model, state, command


def ground(size: int) -> HeightField:
    """A swell on a square map [m] about (0, 0)."""
    nodes = round(size / RESOLUTION_M) + 1
    place = RESOLUTION_M * np.arange(nodes) - 0.5 * size
    wave = (0.5 * WAVE_HEIGHT_M * np.sin(2.0 * np.pi / WAVE_M * place)).astype(np.float32)
    return HeightField(
        heights=wave[np.newaxis, :] + wave[:, np.newaxis],
        soil_index=np.zeros((nodes, nodes), dtype=np.uint8),
        resolution=RESOLUTION_M,
        origin_x=-0.5 * size,
        origin_y=-0.5 * size,
        soil_names=("lunar_nominal",),
    )


def _fits(size: int) -> bool:
    needed = ROOM * BYTES_A_NODE * (size / RESOLUTION_M) ** 2
    for line in Path("/proc/meminfo").read_text().splitlines():
        if line.startswith("MemAvailable:"):
            return int(line.split()[1]) * 1024.0 > needed
    return False
