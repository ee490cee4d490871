"""What motors draw that stand and hold: the plant lets its wheels turn a little, stops them and looks.

A wheel that has stopped holds against what the ground has been wound up with, and an arm against its weight; their
windings turn all of it into heat. On ground of another slope than that of the start it is more or less.
"""

import numpy as np

from sojourn_config.scenario import LoadedScenario
from sojourn_machine.params import FloatArray
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import step
from sojourn_plant.start import build_plant

ROLLED, SETTLED, SEEN = 4.0, 2.0, 1.0
"""Times of turning, of coming to rest and of the mean [s]."""
WHEEL_RATE = 0.5
"""[rad/s]"""


def standing_draw(scenario: LoadedScenario) -> FloatArray:
    """Of each load after a stop, of those that do not move the machine 0, (loads,) [W].

    Raises:
        ConfigError: the ground cannot be made.
    """
    model, state = build_plant(scenario)
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    rolling = model.reference_rows([support.joint for support in model.machine.rolling])
    period = model.simulation.control_period
    command.reference[1, rolling] = WHEEL_RATE
    for _ in range(round(ROLLED / period)):
        state, _ = step(model, state, command)
    command.reference[1, rolling] = 0.0
    command.reference[0] = state.motor_angles
    for _ in range(round(SETTLED / period)):
        state, _ = step(model, state, command)
    drawn, count = np.zeros(len(model.loads)), round(SEEN / period)
    for _ in range(count):
        state, seen = step(model, state, command)
        drawn += seen.power.load_power
    moves = [load.kind == "commanded" for load in scenario.power.loads]
    return np.where(moves, np.maximum(drawn / count, 0.0), 0.0)
