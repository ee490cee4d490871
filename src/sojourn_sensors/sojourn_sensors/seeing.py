"""What sees the ground as it is now, rocks and the machine's own body: cameras and lidars."""

from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeVar

from pydantic import Field

from sojourn_contract.ground import GROUND, with_ground
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import SensorParams
from sojourn_machine.shapes import MachineShapes, Shapes, moved
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_sensors.motion import rotation_matrix
from sojourn_sensors.sensor import Sensor, SensorSite, Truth


class SeeingParams(SensorParams):
    """Of a sensor on its link that sees."""

    hears: ClassVar[tuple[Any, ...]] = (GROUND,)
    link: str = Field(min_length=1, description="link of the URDF: x along the axis of its view, z up")


def heard_of(ground: GroundMemory, truth: Truth) -> GroundMemory:
    """What has been done to the ground, after what a period tells of it, if anything. Raises RefusedMessageError."""
    cloud = truth.inputs.get(GROUND.name)
    return ground if cloud is None else with_ground(ground, cloud)


AnyParams = TypeVar("AnyParams", bound=SeeingParams)
AnyReading = TypeVar("AnyReading")


@dataclass(frozen=True, eq=False, slots=True)
class Outlook:
    """From where a sensor sees, and what of the machine."""

    turn: FloatArray
    """From its link into map, (3, 3)."""
    place: FloatArray
    """Of its link in map, (3,) [m]."""
    body: Shapes
    """The machine's shapes in map."""


class SeeingSensor(Sensor[AnyParams, GroundMemory, AnyReading], Generic[AnyParams, AnyReading]):
    """It remembers what it was told of the ground."""

    def __init__(self, name: str, params: AnyParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._shapes = MachineShapes(site.scenario.urdf_xml, params.link)

    def read(self, ground: GroundMemory, truth: Truth) -> AnyReading:
        """One reading, over ground to which so much has been done."""
        raise NotImplementedError

    def initial_state(self, truth: Truth) -> GroundMemory:
        return self.hear(self.site.untouched, truth)

    def step(self, state: GroundMemory, truth: Truth, dt: float) -> tuple[GroundMemory, AnyReading]:
        ground = self.hear(state, truth)
        return ground, self.read(ground, truth)

    def step_without_power(self, state: GroundMemory, truth: Truth, dt: float) -> tuple[GroundMemory, None]:
        return self.hear(state, truth), None

    def hear(self, state: GroundMemory, truth: Truth) -> GroundMemory:
        return heard_of(state, truth)

    def outlook(self, truth: Truth) -> Outlook:
        """With the pose and the joints of the truth."""
        base = rotation_matrix(truth.odometry.orientation)
        turn, place, body = self._shapes.at(truth.joints.names, truth.joints.position)
        at = truth.odometry.position
        return Outlook(base @ turn, base @ place + at, moved(body, base, at))
