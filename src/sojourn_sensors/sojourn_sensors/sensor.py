"""What a sensor is: the parameters of a kind, on a site, with a state; truth of a period in, reading and messages out.

A kind is one module with two classes, registered by an entry point of the group `sojourn.sensors`:

- its parameters, a `SensorParams`: the name of the kind, the rows of the topic table on which it speaks, and `sensor`;
- the sensor itself, a `Sensor`.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Generic, TypeVar

from sojourn_config.scenario import LoadedScenario
from sojourn_contract.run_table import rows_of_sensor
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import JointState, Odometry
from sojourn_machine.mounting import mounting
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_sensors.fault_hooks import FaultNow, faulted
from sojourn_sensors.scenes import CameraScene

AnyParams = TypeVar("AnyParams", bound=SensorParams)
AnyState = TypeVar("AnyState")
AnyReading = TypeVar("AnyReading")


class SensorSite:
    """The machine and the world that the sensors of a run are in, as far as they do not change.

    Args:
        scenario: of the run. table: its topics.
    """

    def __init__(self, scenario: LoadedScenario, table: TopicTable) -> None:
        self.scenario, self.table = scenario, table

    @property
    def seed(self) -> int:
        """Of the run's random numbers: a sensor draws from the stream of its own name."""
        return self.scenario.config.seed

    @cached_property
    def ground(self) -> HeightField:
        """The ground as it was at the start; made when it is first asked for. Raises ConfigError."""
        return self.scenario.height_field()

    @cached_property
    def untouched(self) -> GroundMemory:
        """What has been done to the ground at the start. Raises ConfigError."""
        terrain = self.scenario.terrain
        cell = terrain.memory_cell if terrain.memory else 0.0
        return GroundMemory(cell, self.ground.origin_x, self.ground.origin_y)

    @cached_property
    def scene(self) -> CameraScene:
        """What cameras see; made when one first asks for it. Raises ConfigError."""
        return CameraScene(self.scenario, self.ground)

    def mounting(self, link: str) -> tuple[FloatArray, FloatArray]:
        """Rotation from a link to base_link, (3, 3), and the link's place in base_link, (3,) [m]."""
        return mounting(self.scenario.urdf_xml, link)

    def rows(self, name: str) -> tuple[Topic, ...]:
        """Rows on which the sensor of a name speaks: those that it has alone, and of the others the first that has a
        row of its kind has it under the row's own name, unless that names all.
        """
        return tuple(rows_of_sensor(self.scenario, self.table, name))


@dataclass(frozen=True, slots=True)
class Truth:
    """What is true at the end of a period, as the plant says it."""

    stamp: int
    """Simulation time [ns]."""
    odometry: Odometry
    """Pose of base_link in map and its motion, which every sensor is given."""
    joints: JointState
    """Every joint that moves, and that of the arm's tool."""
    inputs: Mapping[str, Any]
    """All that came with them, by topic; None where a message was refused, no entry where none was due."""


class Sensor(Generic[AnyParams, AnyState, AnyReading]):
    """One sensor of a machine. What it remembers is in its state.

    Args:
        name: in the machine's file. params: of its kind. site: where it is.
    """

    every: ClassVar[int] = 1
    """It measures each so many control periods."""
    speaks_with: ClassVar[tuple[str, ...]] = ()
    """Topics of the truth without a new message on which it has nothing to say."""

    def __init__(self, name: str, params: AnyParams, site: SensorSite) -> None:
        self.name, self.params, self.site = name, params, site
        self.rows = self.rows_on(site)

    def rows_on(self, site: SensorSite) -> tuple[Topic, ...]:
        """Rows of the run's table on which it speaks."""
        return site.rows(self.name)

    @property
    def topic(self) -> str:
        """The first topic on which it speaks."""
        return self.rows[0].name

    def initial_state(self, truth: Truth) -> AnyState:
        """Before its first reading, with the truth of the first period."""
        raise NotImplementedError

    def step(self, state: AnyState, truth: Truth, dt: float) -> tuple[AnyState, AnyReading]:
        """Read the truth, `dt` [s] after the period before; `state` is not changed.

        Raises:
            MachineError, RefusedMessageError: the truth is none that it can read.
        """
        raise NotImplementedError

    def step_without_power(self, state: AnyState, truth: Truth, dt: float) -> tuple[AnyState, AnyReading | None]:
        """The same while its load draws nothing: it stands still."""
        return state, None

    def hear(self, state: AnyState, truth: Truth) -> AnyState:
        """Take in what comes on the rows that its parameters name in `hears`, in a period in which it does not measure.

        Raises:
            RefusedMessageError: it is nothing that it can use.
        """
        return state

    def hardware(self, state: AnyState) -> Any:
        """What of its state the part itself remembers, whichever process reads it: plain values and arrays, mappings
        and tuples of them; None: nothing.
        """
        return None

    def with_hardware(self, state: AnyState, hardware: Any) -> AnyState:
        """A first state with what the part remembers. Raises MachineError, TypeError, ValueError for what is none."""
        return state

    def faulted(self, reading: AnyReading, fault: FaultNow) -> AnyReading:
        """A reading with a numerical fault. Raises ValueError, with what is allowed, for one that it cannot have."""
        return faulted(reading, fault)

    def messages(self, stamp: int, reading: AnyReading | None) -> Iterable[tuple[str, Any]]:
        """(topic, message) of a reading, None without power, stamped `stamp` [ns]."""
        raise NotImplementedError
