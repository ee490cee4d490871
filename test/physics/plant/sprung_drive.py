"""A kind of drive that is not ours: a rotor that keeps its rate, and a spring with a damper between it and the joint.

torque T = k w + c (u - q'), at most T_max, with w the twist of the spring and u the rate of the rotor:
as commanded, in the mode `position` faster by what the joint is behind; without current the rotor stands
power T u; stored k w^2/2; heat is the rest. A clutch slips at T_max.
"""

from typing import Literal

from pydantic import Field

from sojourn_machine.actuator_choice import ActuatorParams
from sojourn_physics.actuators.actuator import Actuator, Drawn, JointMotion, JointOrder, Push


class SprungDriveParams(ActuatorParams):
    kind: Literal["sprung_drive"]
    holds: Literal["rate", "position"] = Field(default="rate", description="rate or position")
    stiffness: float = Field(gt=0.0, description="k [N m/rad]")
    damping: float = Field(gt=0.0, description="c [N m s/rad]")
    max_torque: float = Field(gt=0.0, description="T_max [N m]")
    gain: float = Field(default=5.0, gt=0.0, description="rate over what the joint is behind [1/s]")

    @property
    def mode(self) -> Literal["rate", "position"]:
        return self.holds

    @property
    def largest_torque(self) -> float:
        return self.max_torque

    def actuator(self, joint: str) -> "SprungDrive":
        return SprungDrive(self)


class SprungDrive(Actuator[tuple[float, float]]):
    """State: twist of the spring [rad], angle of the joint when a step was last solved [rad]."""

    def __init__(self, params: SprungDriveParams) -> None:
        self.params = params

    def initial_state(self, angle: float) -> tuple[float, float]:
        return 0.0, angle

    def push(self, state: tuple[float, float], told: JointOrder, joint: JointMotion, dt: float) -> Push:
        slip, slope = self._rotor(state, told) - joint.rate, self.params.stiffness * dt + self.params.damping
        torque = self.params.stiffness * state[0] + slope * slip
        most = self.params.max_torque
        return Push(torque, slope) if abs(torque) < most else Push(max(min(torque, most), -most))

    def settle(
        self, state: tuple[float, float], told: JointOrder, joint: JointMotion, torque: float, dt: float
    ) -> tuple[tuple[float, float], Drawn]:
        rotor, most = self._rotor(state, told), self.params.max_torque / self.params.stiffness
        twist = max(min(state[0] + (rotor - joint.mean_rate) * dt, most), -most)
        new = twist, joint.angle
        stored = (self.stored(new) - self.stored(state)) / dt
        return new, Drawn(torque * rotor, torque * (rotor - joint.mean_rate) - stored, torque / 10.0)

    def stored(self, state: tuple[float, float]) -> float:
        return 0.5 * self.params.stiffness * state[0] ** 2

    def _rotor(self, state: tuple[float, float], told: JointOrder) -> float:
        if told.supply == 0.0:
            return 0.0
        behind = told.position - state[1] if self.params.holds == "position" else 0.0
        return told.rate + self.params.gain * behind
