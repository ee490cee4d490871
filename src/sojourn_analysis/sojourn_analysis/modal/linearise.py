"""The plant linearised about an equilibrium: standing, or driving straight ahead at a constant speed, on flat ground.

One physics step of the plant, x+ = F_h(x, u), is differentiated by central differences on the tangent space of its
configurations, with a step h so short that the plant's integrator no longer counts:

    x = (y, w, m)      y small displacements of base (in its own axes) and joints, without those that a coupling drives,
                       w their rates, m memory: servos and friction of joints, motors behind play, shear of contacts
    dF_k = [F_h(x_0 + e d_k) - F_h(x_0 - e d_k)]/2e          both measured from F_h(x_0), which itself moves on
    w' = (dF_w - I_w)/h x + ...,   m' alike
    y' = [(dF_y - I_y)/h - (dF_w - I_w)] x + ...             the plant advances y with the new w (semi-implicit Euler)

so that A, B hold every law that the plant knows: contacts, servos, friction, links, gravity. The inputs are references
of joints and, for each wheel, height and slope of the ground under it. Outputs are accelerations, C x + D u.

Step sizes: e = 1e-6 (m, rad and the like), h = 1e-5 s. The natural frequencies of base and suspension of the explorer
on soil change by less than 3e-4 of themselves with e = 1e-7 and for h from 3e-6 to 3e-5 s, by 1e-3 with e = 1e-5. Where
a law has a kink at the equilibrium (the renewal |v| of a contact at rest, friction that slides one way alone, the loss
|T| of a gear that carries nothing, the gap of a gear with play) the central difference gives the mean of both sides:
modes of an idle arm's joints shift by some per cent with e. The shear of the soil, which has another stiffness where it
turns than where it goes on, is taken as it goes on: what is driven over is sheared for the first time.

(Kane and Levinson 1985, Dynamics, sec. 6; Featherstone 2008 for the couplings.) Range: what is small against the
sinkage of the wheels and the bristles of friction; contacts as they are, none made or lost; flat ground of one soil;
ruts do not count.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.actuators import joint_drive
from sojourn_physics.contact.contact_law import STATE_COLUMNS, STATE_NAMES, StateColumn, WheelColumn
from sojourn_physics.contact.hysteresis import ON_BACKBONE
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.params import SimulationParams
from sojourn_physics.plant.state import PlantCommand, PlantState
from sojourn_physics.plant.step import step
from sojourn_physics.terrain.height_field import HeightField

BASE = ("x", "y", "z", "roll", "pitch", "yaw")
TURNED_BY = {"y": ("yaw", 1.0), "z": ("pitch", -1.0)}
"""Accelerations of the base that its forward speed adds to when it turns."""
STEP = 1e-5
"""h [s]"""
DIFFERENCE = 1e-6
"""e [m], [rad], [m/s], ..."""
STEADY = 0.05
"""Fastest change of the rates that still counts as an equilibrium [m/s^2], [rad/s^2]."""


@dataclass(frozen=True, slots=True, eq=False)
class LinearPlant:
    """x' = A x + B u about an equilibrium.

    Args:
        coordinates: names of y, (n,): x, y, z, roll, pitch, yaw of the base, then joints. memory: names of m, (k,).
        inputs: names of u, (p,): "height WHEEL" [m], "slope WHEEL" [-], "reference JOINT" [rad], "rate JOINT" [rad/s].
        a: (2 n + k, 2 n + k) of (y, w, m). b: (2 n + k, p).
        mass: (n, n) mass matrix in the coordinates, rotors included [kg], [kg m], [kg m^2].
        speed: of the base, forward [m/s]. places: of the wheels in base_link, (wheels, 3) [m].
    """

    coordinates: tuple[str, ...]
    memory: tuple[str, ...]
    inputs: tuple[str, ...]
    a: FloatArray
    b: FloatArray
    mass: FloatArray
    speed: float
    places: FloatArray

    @property
    def size(self) -> int:
        """Number n of coordinates."""
        return len(self.coordinates)

    def acceleration(self, name: str) -> tuple[FloatArray, FloatArray]:
        """Rows C, (2 n + k,), and D, (p,), whose output is the acceleration of a coordinate.

        That of the base is the one of a body that drives on: v' + w x v, not the change of the numbers in its axes.

        Raises:
            InvalidValueError: an unknown name.
        """
        row = self.size + self.index(name)
        c = self.a[row].copy()
        if name in TURNED_BY:
            rate, sign = TURNED_BY[name]
            c[self.size + self.index(rate)] += sign * self.speed
        return c, self.b[row]

    def index(self, name: str) -> int:
        """Number of a coordinate.

        Raises:
            InvalidValueError: an unknown name.
        """
        if name not in self.coordinates:
            raise InvalidValueError("coordinate", name, "one of " + ", ".join(self.coordinates))
        return self.coordinates.index(name)


def linearise(
    model: PlantModel,
    state: PlantState,
    command: PlantCommand,
    references: Sequence[str] = (),
    difference: float = DIFFERENCE,
    time_step: float = STEP,
) -> LinearPlant:
    """The linear plant about a state that lasts under a command.

    Args:
        model: on flat ground. state: as the plant settles into under the command, standing or driving straight.
        references: joints whose position and rate references are inputs.
        difference: e. time_step: h [s].

    Raises:
        InvalidValueError: a state that is no equilibrium, ground that is not flat, an unknown joint.
    """
    if float(np.ptp(model.terrain.heights)) > 0.0:
        raise InvalidValueError("terrain", "not flat", "flat ground to linearise on")
    tangent = _Tangent(model, state, command, time_step)
    tangent.check_steady()
    count, size = len(tangent.names), len(tangent.start)
    full = np.empty((size, size))
    for column in range(size):
        change = np.zeros(size)
        change[column] = difference
        full[:, column] = (tangent.advance(change) - tangent.advance(-change)) / (2.0 * difference)
    a = (full - np.eye(size)) / time_step
    a[:count] -= time_step * a[count : 2 * count]
    columns: dict[str, FloatArray] = {}
    still = np.zeros(size)
    for wheel, name in enumerate(model.wheel_names):
        for kind in ("height", "slope"):
            ends = [tangent.on_ground(wheel, kind, sign * difference) for sign in (1.0, -1.0)]
            columns[f"{kind} {name}"] = (ends[0] - ends[1]) / (2.0 * difference)
    for joint in references:
        number = int(model.reference_rows([joint])[0])
        for row, kind in ((0, "reference"), (1, "rate")):
            ends = []
            for sign in (1.0, -1.0):
                other = replace(command, reference=command.reference.copy())
                other.reference[row, number] += sign * difference
                ends.append(tangent.advance(still, other))
            columns[f"{kind} {joint}"] = (ends[0] - ends[1]) / (2.0 * difference)
    b = np.column_stack(list(columns.values())) / time_step
    b[:count] -= time_step * b[count : 2 * count]
    return LinearPlant(
        tangent.names, tangent.memory_names, tuple(columns), a, b, tangent.mass(), float(state.velocity[0]),
        tangent.places(),
    )  # fmt: skip


class _Tangent:
    """The plant's step as a map between small changes of one state."""

    def __init__(self, model: PlantModel, state: PlantState, command: PlantCommand, time_step: float) -> None:
        if model.outside:
            raise InvalidValueError("drives", "of another kind", "geared_motor, whose memory is known")
        simulation = SimulationParams(physics_step=time_step, control_period=time_step)
        self.model = model.variant(simulation=simulation, memory_cell=0.0)
        self.state = replace(state.copy(), ground=self.model.untouched_ground)
        self.state.supports.wheels[:, StateColumn.LARGEST_SHEAR] = ON_BACKBONE
        self.command = command
        joints = model.joints
        driven = {model.joint_index[coupling.second] for coupling in model.machine.couplings}
        kept = [index for index in range(len(joints.names)) if index not in driven]
        self.columns = np.array([*range(6), *joints.columns[kept]])
        self.spread = np.zeros((model.multibody.nv, len(self.columns)))
        self.spread[self.columns, range(len(self.columns))] = 1.0
        for coupling in model.machine.couplings:
            first, second = (model.joint_index[name] for name in (coupling.first, coupling.second))
            self.spread[joints.columns[second]] -= self.spread[joints.columns[first]] / coupling.ratio
        self.names = (*BASE, *(joints.names[index] for index in kept))
        driven_joints = np.flatnonzero(joints.kinds != joint_drive.PASSIVE)
        with_play = np.flatnonzero(joints.parameters[:, joint_drive.TOOTH_STIFFNESS] > 0.0)
        rows = {
            joint_drive.SERVO_INTEGRAL: ("servo", driven_joints),
            joint_drive.DEFLECTION: ("friction", np.arange(len(joints.names))),
            joint_drive.TWIST: ("twist", with_play),
            joint_drive.MOTOR_RATE: ("motor rate", with_play),
            joint_drive.BEARING_DEFLECTION: ("bearing", with_play),
        }
        self.joint_memory = tuple(
            np.concatenate([np.array(column) for column in columns])
            for columns in (
                [np.full(len(which), row, dtype=np.int64) for row, (_, which) in rows.items()],
                [which for _, which in rows.values()],
            )
        )
        self.memory_names = (
            *(f"{name} {joints.names[index]}" for name, which in rows.values() for index in which),
            *(f"{column} {name}" for name in model.wheel_names for column in STATE_NAMES),
        )
        self.start = np.zeros(2 * len(self.names) + len(self.memory_names))
        self.after = self._step(self.state, command)

    def check_steady(self) -> None:
        """Raise where the rates change."""
        change = (self.after.velocity - self.state.velocity) / self.model.simulation.physics_step
        if float(np.abs(change).max()) > STEADY:
            found = f"accelerations up to {np.abs(change).max():.3g}"
            raise InvalidValueError("state", found, f"one that lasts under the command, within {STEADY:g} m/s2, rad/s2")

    def advance(self, change: FloatArray, command: PlantCommand | None = None) -> FloatArray:
        """Change after one step, for a change before it, both as (y, w, m)."""
        return self._change(self._step(self._changed(change), command or self.command))

    def on_ground(self, wheel: int, kind: str, amount: float) -> FloatArray:
        """Change after one step on ground that is higher [m] or slopes up forward [-] under one wheel."""
        flat = self.model
        self.model = flat.variant(terrain=self._ground_under(wheel, kind, amount))
        try:
            return self._change(self._step(self.state, self.command))
        finally:
            self.model = flat

    def mass(self) -> FloatArray:
        """Mass matrix in the coordinates."""
        multibody, data = self.model.multibody, self.model.data
        pin.crba(multibody, data, self.state.configuration, pin.Convention.WORLD)
        matrix = np.triu(data.M) + np.triu(data.M, 1).T + np.diag(self.model.joints.armature)
        return np.asarray(self.spread.T @ matrix @ self.spread)

    def places(self) -> FloatArray:
        """Centres of the wheels in base_link, (wheels, 3) [m]."""
        pin.forwardKinematics(self.model.multibody, self.model.data, self.state.configuration)
        base = self.model.data.oMi[1]
        wheels = self.model.supports.tables.wheels.carried.bodies
        return np.array([base.actInv(self.model.data.oMi[int(wheel)].translation) for wheel in wheels])

    def _step(self, state: PlantState, command: PlantCommand) -> PlantState:
        return step(self.model, state, command)[0]

    def _changed(self, change: FloatArray) -> PlantState:
        count, joints = len(self.names), self.model.joints
        motion = self.spread @ change[:count]
        state = self.state.copy()
        state.joints[0] += motion[joints.columns]
        of_joints, of_contacts = np.split(change[2 * count :], [len(self.joint_memory[0])])
        state.joints[self.joint_memory] += of_joints
        state.supports.wheels[:] += of_contacts.reshape(-1, STATE_COLUMNS)
        return replace(
            state,
            configuration=pin.integrate(self.model.multibody, state.configuration, motion),
            velocity=state.velocity + self.spread @ change[count : 2 * count],
        )

    def _change(self, state: PlantState) -> FloatArray:
        """From the equilibrium's own next state to this one."""
        motion = pin.difference(self.model.multibody, self.after.configuration, state.configuration)
        return np.concatenate([
            motion[self.columns], (state.velocity - self.after.velocity)[self.columns],
            (state.joints - self.after.joints)[self.joint_memory],
            (state.supports.wheels - self.after.supports.wheels).ravel(),
        ])  # fmt: skip

    def _ground_under(self, wheel: int, kind: str, amount: float) -> HeightField:
        """The terrain with the part that is nearest to one wheel lifted, or turned about the axle, a little."""
        terrain = self.model.terrain
        pin.forwardKinematics(self.model.multibody, self.model.data, self.state.configuration)
        wheels = self.model.supports.tables.wheels.carried.bodies
        centres = np.array([self.model.data.oMi[int(body)].translation[:2] for body in wheels])
        base = self.model.data.oMi[1].rotation[:2, 0]
        ahead = base / np.linalg.norm(base)
        radius = float(self.model.supports.tables.wheels.rows[wheel, WheelColumn.RADIUS])
        rows, columns = terrain.heights.shape
        x = terrain.origin_x + terrain.resolution * np.arange(columns)
        y = terrain.origin_y + terrain.resolution * np.arange(rows)
        reach = 2.0 * radius + 2.0 * terrain.resolution
        near_x = np.flatnonzero(np.abs(x - centres[wheel, 0]) < reach)
        near_y = np.flatnonzero(np.abs(y - centres[wheel, 1]) < reach)
        place_x, place_y = np.meshgrid(x[near_x], y[near_y])
        away = (place_x[..., None] - centres[:, 0]) ** 2 + (place_y[..., None] - centres[:, 1]) ** 2
        own = np.argmin(away, axis=2) == wheel
        along = (place_x - centres[wheel, 0]) * ahead[0] + (place_y - centres[wheel, 1]) * ahead[1]
        heights = terrain.heights.copy()
        heights[np.ix_(near_y, near_x)] += own * (amount if kind == "height" else amount * along)
        return replace(terrain, heights=heights)
