"""Encoders and measured efforts of all joints: /joint_states."""

from collections.abc import Iterator
from typing import Any, ClassVar

from pydantic import Field

from sojourn_contract.joint_places import JointPlaces
from sojourn_contract.topics import topic
from sojourn_contract.values import JointState
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.sensors import joints
from sojourn_physics.sensors.joints import JointMeasurement, JointSensorState, JointTruth
from sojourn_physics.sensors.params import JOINTS, JointGroupParams
from sojourn_sensors.sensor import Sensor, SensorSite, Truth


class JointSensorsParams(SensorParams):
    """`joint_groups` of sensors.yaml."""

    kind: str = JOINTS
    speaks_on: ClassVar[tuple[Any, ...]] = (topic("/joint_states"),)
    quantities: ClassVar[tuple[str, ...] | None] = ("position", "velocity", "effort")
    alone: ClassVar[bool] = True
    groups: dict[str, JointGroupParams] = Field(description="group name to its joints")

    def sensor(self, name: str, site: SensorSite) -> "JointSensors":
        """The encoders of a machine."""
        return JointSensors(name, self, site)


class JointSensors(Sensor[JointSensorsParams, JointSensorState, tuple[tuple[str, ...], JointMeasurement]]):
    """Reads every joint of the groups; a reading has the names of the joints."""

    def __init__(self, name: str, params: JointSensorsParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._motors: tuple[tuple[str, ...], JointPlaces] | None = None
        """Names and places of the motors: looked up again when the names change, so no memory of the run."""

    def initial_state(self, truth: Truth) -> JointSensorState:
        return joints.initial_state(self.params.groups, self.site.seed, truth.joints.names, self._true(truth))

    def step(
        self, state: JointSensorState, truth: Truth, dt: float
    ) -> tuple[JointSensorState, tuple[tuple[str, ...], JointMeasurement]]:
        state, reading = joints.step(state, self._true(truth), dt)
        return state, (state.layout.joint_names, reading)

    def hardware(self, state: JointSensorState) -> Any:
        """Of angle sensors that are no encoders, by joint: memory, and the angle told last [rad]."""
        names = [state.layout.joint_names[place] for place in state.layout.others]
        return {name: (one.memory, one.told[0]) for name, one in zip(names, state.others, strict=True)}

    def with_hardware(self, state: JointSensorState, hardware: Any) -> JointSensorState:
        known = [hardware[state.layout.joint_names[place]] for place in state.layout.others]
        others = zip(state.others, known, strict=True)
        return replace(state, others=tuple(replace(one, memory=memory, told=(told,)) for one, (memory, told) in others))

    def messages(
        self, stamp: int, reading: tuple[tuple[str, ...], JointMeasurement] | None
    ) -> Iterator[tuple[str, Any]]:
        if reading is not None:
            names, read = reading
            yield self.topic, JointState(stamp, names, read.position, read.velocity, read.effort)

    def _true(self, truth: Truth) -> JointTruth:
        motors = truth.inputs.get("/truth/motor_states")
        return JointTruth(truth.joints.position, truth.joints.effort, self._motor_positions(truth.joints, motors))

    def _motor_positions(self, joints_: JointState, motors: JointState | None) -> FloatArray | None:
        """Angle of each joint's motor over its gear [rad], the joint's own where nothing is said; None if of none."""
        if motors is None or not motors.names:
            return None
        if self._motors is None or self._motors[0] != motors.names:
            self._motors = (motors.names, JointPlaces("/truth/joint_states", motors.names))
        found = joints_.position.copy()
        found[self._motors[1].places(joints_)] = motors.position
        return found
