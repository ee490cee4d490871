"""Limit switches at the ends of joints: /limit_switches/NAME."""

from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sojourn_contract.heartbeat import status_message
from sojourn_contract.joint_places import JointPlaces
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_choice import MachinePart, SensorParams
from sojourn_physics.sensors import limit_switch
from sojourn_physics.sensors.limit_switch import LimitSwitchParams, LimitSwitchState
from sojourn_sensors.sensor import Sensor, SensorSite, Truth

ROW = Topic(
    "/limit_switches",
    "diagnostic_msgs/DiagnosticArray",
    "sensors",
    (),
    5,
    0.5,
    "of each joint `lower JOINT` and `upper JOINT`: closed or open; nothing while they have no power",
    (FieldRule("status.values", ""),),
    all_named=True,
)
WORDS = ("lower", "upper")


class LimitSwitchesParams(LimitSwitchParams, SensorParams):
    """Switches at both ends of the travel of joints, as the URDF has it."""

    kind: str = "limit_switches"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    quantities: ClassVar[tuple[str, ...] | None] = ()
    joints: tuple[str, ...] = Field(min_length=1, description="joints of the URDF whose travel has ends")

    @property
    def parts(self) -> tuple[MachinePart, ...]:
        return (MachinePart("joints", "travel", self.joints),)

    def sensor(self, name: str, site: SensorSite) -> "LimitSwitches":
        """The switches of a machine's joints."""
        return LimitSwitches(name, self, site)


class LimitSwitches(Sensor[LimitSwitchesParams, LimitSwitchState, NDArray[np.bool_]]):
    """Whether each is closed, (joints, 2); read in every period, told at the rate of its row."""

    def __init__(self, name: str, params: LimitSwitchesParams, site: SensorSite) -> None:
        super().__init__(name, params, site)
        self._joints = JointPlaces("/truth/joint_states", params.joints)
        joints = [site.scenario.urdf.joints[joint] for joint in params.joints]
        self._limits = np.array([(joint.lower, joint.upper) for joint in joints])

    def initial_state(self, truth: Truth) -> LimitSwitchState:
        names = tuple(f"{self.name}.{joint}" for joint in self.params.joints)
        return limit_switch.initial_state(self.params, self.site.seed, names, self._beyond(truth))

    def step(self, state: LimitSwitchState, truth: Truth, dt: float) -> tuple[LimitSwitchState, NDArray[np.bool_]]:
        return limit_switch.step(self.params, state, self._beyond(truth), dt)

    def step_without_power(self, state: LimitSwitchState, truth: Truth, dt: float) -> tuple[LimitSwitchState, None]:
        return self.step(state, truth, dt)[0], None

    def hardware(self, state: LimitSwitchState) -> Any:
        """Which are pressed, and where each operates next."""
        return state.pressed, state.off

    def with_hardware(self, state: LimitSwitchState, hardware: Any) -> LimitSwitchState:
        pressed, off = hardware
        return replace(state, pressed=pressed, off=off)

    def messages(self, stamp: int, reading: NDArray[np.bool_] | None) -> Iterator[tuple[str, Any]]:
        rows = [] if reading is None else zip(self.params.joints, reading.tolist(), strict=True)
        values = {
            f"{word} {joint}": "closed" if closed else "open"
            for joint, of_joint in rows
            for word, closed in zip(WORDS, of_joint, strict=True)
        }
        yield self.topic, status_message(stamp, self.name, values)

    def _beyond(self, truth: Truth) -> FloatArray:
        """How far each joint is beyond its limits, (joints, 2) [rad] or [m]."""
        angle = truth.joints.position[self._joints.places(truth.joints)]
        return np.stack([self._limits[:, 0] - angle, angle - self._limits[:, 1]], axis=1)
