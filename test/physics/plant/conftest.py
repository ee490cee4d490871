"""The explorer on its ground: models are made once, and runs are shared."""

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from sojourn_config.scenario import load_scenario
from sojourn_machine.params import FloatArray
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand, PlantOutput, PlantState, zeros_command
from sojourn_physics.plant.step import step
from sojourn_plant.start import build_plant

sys.path.insert(0, str(Path(__file__).parent))  # `sprung_drive`


@dataclass
class Machine:
    """A model with its first state."""

    model: PlantModel
    start: PlantState

    @property
    def wheels(self) -> slice:
        return slice(0, len(self.model.machine.wheels))

    @property
    def weight(self) -> float:
        return self.model.mass * self.model.gravity

    def hold(self, rate: float = 0.0) -> PlantCommand:
        """All joints where they are at the start, wheels at a rate [rad/s]."""
        command = zeros_command(len(self.model.joints.names), len(self.model.loads))
        command.reference[0] = self.start.motor_angles
        rows = self.model.reference_rows([wheel.joint for wheel in self.model.machine.wheels])
        command.reference[1, rows] = rate
        return command

    def run(
        self,
        seconds: float,
        command: PlantCommand | None = None,
        state: PlantState | None = None,
        watch: Callable[[PlantState, PlantOutput], None] | None = None,
    ) -> PlantState:
        """The state after so many seconds of one command."""
        state = self.start if state is None else state
        command = self.hold() if command is None else command
        for _ in range(round(seconds / self.model.simulation.control_period)):
            state, output = step(self.model, state, command)
            if watch is not None:
                watch(state, output)
        return state

    def thrown(self, axis: str, angle: float, lift: float) -> PlantState:
        """The start, turned about an axis of the base by an angle [rad] and lifted [m]: in the air, at rest."""
        direction = np.eye(3)["xyz".index(axis)]
        configuration = self.start.configuration.copy()
        turned = pin.Quaternion(configuration[3:7]) * pin.Quaternion(pin.AngleAxis(angle, direction))
        configuration[3:7] = turned.coeffs()
        configuration[2] += lift
        return replace(
            self.start.copy(),
            configuration=configuration,
            velocity=np.zeros_like(self.start.velocity),
            supports=self.model.supports.first_states(),
        )


def tilt(state: PlantState) -> float:
    """Angle between the base's z axis and up [rad]."""
    x, y = state.configuration[3], state.configuration[4]
    return math.acos(max(-1.0, min(1.0, 1.0 - 2.0 * (x * x + y * y))))


def values(state: PlantState) -> FloatArray:
    """Every number of a state, in one array."""
    return np.concatenate([
        state.configuration, state.velocity, state.joints.ravel(), *(states.ravel() for states in state.supports),
        [*state.power.voltages, *state.power.served, state.power.stores[0].soc],
        [state.energy.electrical, state.energy.soil_work],
    ])  # fmt: skip


@lru_cache(maxsize=16)
def _machine(scenario: str, overrides: tuple[str, ...]) -> Machine:
    return Machine(*build_plant(load_scenario(scenario, overrides)))


@pytest.fixture(scope="session")
def machine() -> Callable[..., Machine]:
    """`machine("flat_drive", "soil=mars")`: the plant of a scenario, at rest at its start."""

    def make(scenario: str, *overrides: str) -> Machine:
        return _machine(scenario, overrides)

    return make


@pytest.fixture(scope="session")
def flat(machine: Callable[..., Machine]) -> Machine:
    """On flat lunar ground."""
    return machine("flat_drive")


@pytest.fixture(scope="session")
def tilt_of() -> Callable[[PlantState], float]:
    """Tilt of a state."""
    return tilt


@pytest.fixture(scope="session")
def numbers_of() -> Callable[[PlantState], FloatArray]:
    """All numbers of a state."""
    return values
