"""What the hazard camera sees from the true pose of the base."""

import numpy as np
from numpy.typing import NDArray

from sojourn_config.scenario import LoadedScenario
from sojourn_machine.params import FloatArray
from sojourn_physics.sensors import hazcam
from sojourn_physics.sensors.noise import NoiseStream
from sojourn_sensors.motion import rotation_matrix

NO_POINTS = np.zeros((0, 3), dtype=np.float32)


class HazardView:
    """The hazard camera of a scenario's rover before the scenario's ground; of a rover without one, nothing.

    Args:
        scenario: its ground is made only where there is a camera. Raises ConfigError if it cannot be made.
    """

    def __init__(self, scenario: LoadedScenario) -> None:
        params = scenario.sensors.hazcam
        self._camera = None if params is None else hazcam.hazcam_on(params, scenario.urdf_xml)
        self._seed = scenario.config.seed
        if self._camera is not None:
            self._ground = scenario.height_field()

    def warm_up(self) -> None:
        """Have its compiled kernels loaded."""
        self.observe(self.initial_state(), np.zeros(3), np.array((0.0, 0.0, 0.0, 1.0)))

    def initial_state(self) -> NoiseStream | None:
        """Drawn by the scenario's seed; None of a rover without a camera."""
        return None if self._camera is None else hazcam.initial_state(self._camera, self._seed)

    def observe(
        self, state: NoiseStream | None, position: FloatArray, orientation: FloatArray
    ) -> tuple[NoiseStream | None, NDArray[np.float32]]:
        """Points in base_link, shape (n, 3) [m], from the base's true position [m] and attitude (x y z w)."""
        if self._camera is None or state is None:
            return state, NO_POINTS
        return hazcam.step(self._camera, state, self._ground, position, rotation_matrix(orientation))
