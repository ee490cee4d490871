"""A rover's plant linearised for its data sheet: standing on flat ground, and driving over it at cruise speed."""

import numpy as np

from sojourn_analysis.modal.linearise import LinearPlant, linearise
from sojourn_config.bundle import Bundle
from sojourn_machine.errors import MachineError
from sojourn_physics.plant.model import PlantModel, Site
from sojourn_physics.plant.state import PlantCommand, PlantState, zeros_command
from sojourn_physics.plant.step import initial_state, step
from sojourn_physics.terrain.height_field import HeightField

LENGTH, WIDTH, RESOLUTION = 120.0, 12.0, 0.1
"""Of the flat ground [m]."""
SLOW_START = 2.0
"""Time in which the wheels are brought to their rate [s]."""
LONGEST_DRIVE = 20.0
"""Until a drive counts as steady [s]."""


def linear_plants(bundle: Bundle, pose: dict[str, float], speed: float) -> tuple[LinearPlant, LinearPlant | None]:
    """Standing, and driving with wheels that turn for a speed [m/s]; None where no steady drive comes about.

    Args:
        pose: angles of the arm's joints [rad].

    Raises:
        MachineError: a machine that does not stand on this ground.
    """
    nodes = round(WIDTH / RESOLUTION) + 1, round(LENGTH / RESOLUTION) + 1
    ground = HeightField(
        np.zeros(nodes), np.zeros(nodes, np.uint8), RESOLUTION, -10.0, -0.5 * WIDTH, (bundle.soil.name,)
    )
    site = Site(ground, list(bundle.soils.values()), bundle.gravity_field)
    model = PlantModel(bundle.urdf_xml, bundle.machine, site, bundle.power)
    state = initial_state(model, 0.0, 0.0, 0.0, 1.0, pose)
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    standing = linearise(model, state, command)
    rows = model.reference_rows([wheel.joint for wheel in bundle.machine.wheels])
    radii = np.array([wheel.radius for wheel in bundle.machine.wheels])
    try:
        state = _steady_drive(model, state, command, rows, speed / radii)
        return standing, linearise(model, state, command)
    except MachineError:
        return standing, None


def _steady_drive(
    model: PlantModel, state: PlantState, command: PlantCommand, rows: np.ndarray, rates: np.ndarray
) -> PlantState:
    period = model.simulation.control_period
    for number in range(round(LONGEST_DRIVE / period)):
        command.reference[1, rows] = rates * min(number * period / SLOW_START, 1.0)
        state, _ = step(model, state, command)
        if state.off_terrain or state.configuration[0] > LENGTH - 20.0:
            break
    return state
