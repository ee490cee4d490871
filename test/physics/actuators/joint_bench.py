"""One driven joint on a flywheel, stepped by the kernels of the plant."""

from dataclasses import dataclass, field

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.actuators import joint_drive as jd

HUGE = 1e12


@dataclass
class Bench:
    """One joint on a flywheel: the machine's equation is  (J + armature) dω/dt = torques + load."""

    kind: int = jd.RATE
    ratio: float = 1.0
    resistance: float = 2.32
    torque_constant: float = 0.0234
    max_current: float = HUGE
    efficiency: float = 1.0
    friction: float = 0.0
    viscous: float = 0.0
    proportional: float = 0.0
    integral: float = 0.0
    derivative: float = 0.0
    max_torque: float = HUGE
    rotor: float = 0.0
    lower: float = -np.inf
    upper: float = np.inf
    half_gap: float = 0.0
    tooth_stiffness: float = 0.0
    tooth_damping: float = 0.0
    bearing_friction: float = 0.0
    bearing_viscous: float = 0.0
    sees_joint: float = 0.0
    saturation: float = 0.0
    spring: float = 0.0
    rest: float = 0.0
    max_effort: float = np.inf
    max_rate: float = np.inf
    back_loss: float = 0.0
    inertia: float = 1e-3
    voltage: float = 24.0
    fraction: float = 1.0
    dt: float = 0.001
    load: float = 0.0
    states: FloatArray = field(default_factory=lambda: np.zeros((jd.STATE_ROWS, 1)))
    velocity: FloatArray = field(default_factory=lambda: np.zeros(1))
    command: FloatArray = field(default_factory=lambda: np.zeros((3, 1)))
    energy: FloatArray = field(default_factory=lambda: np.zeros(4))
    work: float = 0.0
    current: float = 0.0
    effort: float = 0.0
    power: float = 0.0

    def step(self, count: int = 1) -> None:
        """So many steps."""
        row = np.array([[
            self.ratio, self.torque_constant, self.resistance, self.max_current, self.efficiency, self.friction,
            self.viscous, self.proportional, self.integral, self.derivative, self.max_torque,
            self.rotor * self.ratio**2, self.lower, self.upper, 2e4, 200.0,
            self.half_gap, self.tooth_stiffness, self.tooth_damping,
            self.bearing_friction, self.bearing_viscous, self.sees_joint,
            self.saturation, self.spring, self.rest, self.max_effort, self.max_rate, self.back_loss,
        ]])  # fmt: skip
        zero = np.zeros(1, dtype=np.int64)
        joints = jd.Joints(row, np.array([self.kind]), zero, zero)
        told = jd.JointCommand(self.command, np.array([self.fraction]), np.array([self.voltage]))
        work = jd.JointWork(np.zeros((jd.WORK_ROWS, 1)), np.zeros(1), np.zeros(1))
        readings = jd.JointReadings(np.zeros(1), np.zeros(1), np.zeros(1), self.energy)
        for _ in range(count):
            work.force[0] = self.load
            jd.joint_torques(joints, told, self.dt, self.velocity, self.dt, self.states, work)
            new = self.velocity + self.dt * work.force / (self.inertia + work.armature)
            self.power = jd.settle_joints(joints, self.velocity, new, self.dt, work.rows, self.states, readings)
            self.work += self.load * 0.5 * (self.velocity[0] + new[0]) * self.dt
            self.velocity = new
            self.current, self.effort = float(readings.currents[0]), float(readings.efforts[0])
            assert readings.load_power[0] == self.power

    @property
    def rate(self) -> float:
        return float(self.velocity[0])
