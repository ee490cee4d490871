"""Torque sensors in joints: /joint_torque/NAME."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from sojourn_contract.field_rules import EFFORT
from sojourn_contract.joint_places import JointPlaces
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import JointState
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import MachinePart, SensorParams
from sojourn_physics.sensors import strain_gauge
from sojourn_physics.sensors.strain_gauge import StrainGaugeParams, StrainGaugeState
from sojourn_sensors.part_temperature import PartTemperature
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

ROW = Topic(
    "/joint_torque",
    "sensor_msgs/JointState",
    "sensors",
    (),
    1,
    0.1,
    "measured torque of joints, of no joint while the sensor has no power",
    (replace(EFFORT, low=-1e6, high=1e6),),
    all_named=True,
)


class TorqueSensorParams(StrainGaugeParams, SensorParams):
    """Strain gauges on the output shafts of joints."""

    kind: str = "torque_sensor"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    quantities: ClassVar[tuple[str, ...] | None] = ("",)
    joints: tuple[str, ...] = Field(min_length=1, description="joints of the URDF that have one each")
    node: str | None = Field(
        default=None, description="node of the machine's heat that they are as warm as; none: no apparent strain"
    )

    @property
    def parts(self) -> tuple[MachinePart, ...]:
        warm = () if self.node is None else (MachinePart("node", "node", (self.node,)),)
        return (MachinePart("joints", "joint", self.joints), *warm)

    def sensor(self, name: str, site: SensorSite) -> "TorqueSensor":
        """The sensors of a machine's joints."""
        return TorqueSensor(name, self, site)


@dataclass(frozen=True, slots=True)
class TorqueMemory:
    """Of the gauges, and how warm they were when that was last told [K]."""

    gauges: StrainGaugeState
    temperature: float | None = None


class TorqueSensor(Sensor[TorqueSensorParams, TorqueMemory, FloatArray]):
    """Torques of its joints, (joints,) [N m]; gauges creep and warm without power too."""

    def __init__(self, name: str, params: TorqueSensorParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._joints = JointPlaces("/truth/joint_states", params.joints)
        self._warmth = None if params.node is None else PartTemperature(site, "node", params.node)

    def initial_state(self, truth: Truth) -> TorqueMemory:
        names = tuple(f"{self.name}.{joint}" for joint in self.params.joints)
        return TorqueMemory(strain_gauge.initial_state(self.params, self.site.seed, names))

    def step(self, state: TorqueMemory, truth: Truth, dt: float) -> tuple[TorqueMemory, FloatArray]:
        told = None if self._warmth is None else self._warmth.told(truth)
        temperature = state.temperature if told is None else told
        torque = truth.joints.effort[self._joints.places(truth.joints)]
        gauges, reading = strain_gauge.step(self.params, state.gauges, torque, dt, temperature)
        return TorqueMemory(gauges, temperature), reading

    def step_without_power(self, state: TorqueMemory, truth: Truth, dt: float) -> tuple[TorqueMemory, None]:
        return self.step(state, truth, dt)[0], None

    def hardware(self, state: TorqueMemory) -> FloatArray:
        """Creep of the gauges."""
        return state.gauges.creep

    def with_hardware(self, state: TorqueMemory, hardware: FloatArray) -> TorqueMemory:
        return replace(state, gauges=replace(state.gauges, creep=hardware))

    def messages(self, stamp: int, reading: FloatArray | None) -> Iterator[tuple[str, Any]]:
        names = () if reading is None else self.params.joints
        yield self.topic, JointState(stamp, names, effort=np.zeros(0) if reading is None else reading)
