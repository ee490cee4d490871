"""One control period of the plant: the recipe of a step.

Semi-implicit Euler at the physics step (velocity first, then configuration with the new velocity), implicit
in the joints' stiff terms. For each physics step:

    1  placements, Jacobian, mass matrix and bias forces         (Pinocchio)
    2  contact forces, joint torques and their slopes; acceleration, couplings, new velocity, energy (`kernels.advance`)
    3  configuration on the group                                (Pinocchio)

The tool at the arm's end and the power network take one step a control period, these with the mean power of the
motors; the bus voltage holds for the next period.
"""

import math
from typing import Any

import numpy as np
import pinocchio as pin

from sojourn_machine.contact_report import FORCE
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.rotations import quaternion_of
from sojourn_physics.actuators.joint_drive import (
    ELECTRICAL,
    FRICTION_HEAT,
    STATE_ROWS,
    STOP_HEAT,
    WINDING_HEAT,
)
from sojourn_physics.plant.energy import mechanical_energy
from sojourn_physics.plant.flight import flight_after
from sojourn_physics.plant.heat import Moved
from sojourn_physics.plant.kernels import SOIL_WORK, advance
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.orbital_bias import orbital_bias
from sojourn_physics.plant.state import EnergyAccount, PlantCommand, PlantOutput, PlantState, zeros_command
from sojourn_physics.plant.supply import powered
from sojourn_physics.plant.tools.mounted_tool import NO_ENERGY

SETTLED_SPEED = 1e-6
"""The machine has settled when nothing moves faster [m/s], [rad/s]."""
SETTLED_PERIODS = 25
"""For so many control periods: what swings in the play of a gear stands still at its turning points, too."""
ON_ONE_LINE = 1e-9
"""Square of the width over the length of a base whose wheels stand on one line [-]."""
PLACEMENT_TRIES = 5
PLACEMENT_TOLERANCE = 1e-3
"""How near to where it was asked for the machine has to rest [m], [rad]."""
LOWERED_PERIODS = 100
"""For so many control periods a machine that is set down again is held against gaining speed."""


def step(model: PlantModel, state: PlantState, command: PlantCommand) -> tuple[PlantState, PlantOutput]:
    """Advance one control period.

    Args:
        model: the machine and its ground; its working memory is used, its parameters are not changed.
        state: at the start of the period; not changed.
        command: holds for the whole period.

    Returns:
        the state at the end, and what was seen on the way.

    Raises:
        InvalidValueError: a command of another shape or not finite; a state that has become infinite.
    """
    _check_command(model, command)
    if model.power.stuck:
        command = replace(command, load_fractions=model.power.as_switched(command.load_fractions))
    conditions, parameters = model.conditions, model.joints.parameters
    if conditions is not None and state.conditions is not None:
        parameters = conditions.now(state.conditions)
    limits = (command.load_fractions * model.power.served_at_loads(state.power))[model.joints.loads]
    if command.motor_health is not None:
        limits *= command.motor_health
    model.memory.load(state.ground)
    blown = model.weigh(state.configuration, state.velocity)
    if model.tool is not None and state.tool is not None:
        model.tool.prepare(state.tool)
    work = model.work
    work.begin(state, command.reference, limits, parameters)
    configuration, on_map, outside = _sub_steps(model, state)
    steps, motion, sums = model.simulation.substeps, work.tables.motion, work.tables.sums
    velocity = motion.rates[-1].copy()
    if not (_is_finite(configuration) and _is_finite(velocity)):
        raise InvalidValueError("state of the plant", f"infinite at tick {state.tick + 1}", "finite numbers")
    warmed = state.conditions
    if conditions is not None and warmed is not None:
        squares, period = sums.current_squares / steps, model.simulation.control_period
        around = model.round_drives(state.heat)
        warmed = conditions.after(warmed, parameters, squares, limits, period, around)
    new = replace(
        state,
        configuration=configuration,
        velocity=velocity,
        joints=motion.joints.copy(),
        supports=motion.supports.copy(),
        off_terrain=state.off_terrain or not on_map,
        conditions=warmed,
        outside=outside,
    )
    wrist = None
    if model.wrist is not None:
        report, touching = model.report.copy(), model.wrist.contacts
        report[touching, FORCE] = sums.contact_force[touching] / steps
        mean = (velocity - state.velocity) / model.simulation.control_period
        wrist = model.wrist.wrench(configuration, velocity, mean, report)
    spread = np.sqrt(np.add.reduce(np.square(motion.rates[1:] - velocity), axis=0) / steps)
    if blown is not None:
        moved = model.centre_of_mass(configuration) - model.centre_of_mass(state.configuration)
        into_air = state.energy.air_work - float(blown @ moved)
        new = replace(new, energy=replace(state.energy, air_work=into_air))
    return _close_period(model, new, command, wrist, spread)


def _sub_steps(model: PlantModel, state: PlantState) -> tuple[FloatArray, bool, tuple[Any, ...]]:
    """The physics steps of a period: the configuration at its end, whether all contacts were on the map, and the states
    of the drives whose law is their own.
    """
    multibody, data, work, drives, tide = model.multibody, model.data, model.work, model.outside, model.tide
    period, rates, displacement = work.period, work.rates, work.tables.motion.displacement
    configuration, outside, on_map = state.configuration, state.outside, True
    for i in range(model.simulation.substeps):
        pin.crba(multibody, data, configuration, pin.Convention.WORLD)
        if tide is None:
            pin.nonLinearEffects(multibody, data, configuration, rates[i])
        else:
            model.bias[:] = orbital_bias(multibody, data, tide, configuration, rates[i])
        if outside:
            drives.push(work.tables, outside, i)
        on_map &= advance(period, i)
        if outside:
            outside = drives.settle(work.tables, outside, i)
        configuration = pin.integrate(multibody, configuration, displacement)
    return configuration, on_map, outside


def _check_command(model: PlantModel, command: PlantCommand) -> None:
    shape = (3, len(model.joints.names))
    if command.reference.shape != shape or command.load_fractions.shape != (len(model.loads),):
        raise InvalidValueError(
            "shapes of the command",
            (command.reference.shape, command.load_fractions.shape),
            f"{shape} and one a load",
        )
    if command.tool is not None and not (command.tool.shape == (3,) and np.isfinite(command.tool).all()):
        raise InvalidValueError("command of the tool", command.tool.tolist(), "3 finite numbers")
    if command.motor_health is not None and command.motor_health.shape != shape[1:]:
        raise InvalidValueError("shape of the motors' health", command.motor_health.shape, f"{shape[1:]}")
    if not (_is_finite(command.reference.ravel()) and _is_finite(command.load_fractions)):
        raise InvalidValueError("command", "NaN or infinity", "finite numbers")


def _is_finite(values: FloatArray) -> bool:
    """Whether none of the numbers, (n,), is NaN or infinite."""
    return math.isfinite(np.add.reduce(values))


def _close_period(
    model: PlantModel, state: PlantState, command: PlantCommand, wrist: FloatArray | None, spread: FloatArray
) -> tuple[PlantState, PlantOutput]:
    """Tool, supply, energy account and events of the period that has passed."""
    configuration, velocity = state.configuration, state.velocity
    sums, load_energy = model.work.tables.readings.energy, model.work.tables.sums.load_energy
    mechanical = mechanical_energy(model, configuration, velocity, state.joints)
    tool, drawn, gained = state.tool, NO_ENERGY, 0.0
    if model.tool is not None and tool is not None:
        bus = model.power.load_bus[model.tool.load]
        supplied = float(command.load_fractions[model.tool.load] * state.power.served[bus])
        voltage = state.power.voltages[bus]
        tool, drawn = model.tool.advance(model, tool, state.supports.pads, command.tool, supplied, voltage)
        load_energy[model.tool.load] += drawn.electrical
        if state.tool is not None and tool.payload != state.tool.payload:
            model.tool.prepare(tool)
            gained = mechanical_energy(model, configuration, velocity, state.joints) - mechanical
    heat_of_motors = float(sums[WINDING_HEAT] + sums[FRICTION_HEAT] + sums[STOP_HEAT])
    heat_of_motors += drawn.winding_heat + drawn.friction_heat
    network, supply, heat = powered(model, state, command.load_fractions, Moved(load_energy, heat_of_motors))
    old = state.energy
    energy = EnergyAccount(
        electrical=old.electrical + float(sums[ELECTRICAL]) + drawn.electrical,
        winding_heat=old.winding_heat + float(sums[WINDING_HEAT]) + drawn.winding_heat,
        friction_heat=old.friction_heat + float(sums[FRICTION_HEAT]) + drawn.friction_heat,
        stop_heat=old.stop_heat + float(sums[STOP_HEAT]),
        soil_work=old.soil_work + float(sums[SOIL_WORK]) + drawn.soil_work - gained,
        air_work=old.air_work,
        mechanical=mechanical + gained + model.outside.stored(state.outside),
    )
    x, y = configuration[3], configuration[4]
    upright = 1.0 - 2.0 * (x * x + y * y)  # cosine between the base's z axis and up
    new = PlantState(
        tick=state.tick + 1,
        configuration=configuration,
        velocity=velocity,
        joints=state.joints,
        supports=state.supports,
        ground=model.memory.store(),
        power=network,
        energy=energy,
        rolled_over=state.rolled_over or bool(upright < model.roll_over_cosine),
        off_terrain=state.off_terrain,
        tool=tool,
        conditions=state.conditions,
        heat=heat,
        outside=state.outside,
        flight=flight_after(model, state.flight, configuration, velocity),
    )
    output = PlantOutput(
        contacts=model.report.copy(),
        efforts=model.efforts.copy(),
        currents=model.currents.copy(),
        power=supply,
        spread=spread,
        wrist_wrench=wrist,
    )
    return new, output


def initial_state(
    model: PlantModel, x: float, y: float, yaw: float, soc: float, angles: dict[str, float] | None = None
) -> PlantState:
    """The machine at rest on the ground, settled on its soil; a fixed base stands square on it, its arm settled.

    A machine put down on uneven ground slides a little until it rests. It is then moved back as it stands and lowered
    there, until it rests where it was asked for.

    Args:
        x, y: of the base in map [m]. yaw: [rad]. soc: state of charge [0..1].
        angles: joint angles to start from and to hold while settling, by name [rad]; zero for all others.

    Raises:
        InvalidValueError: unknown joint; a place where the machine does not come to rest as asked for.
        OutsideTerrainError: no ground there.
    """
    configuration, command = in_posture(model, angles or {})
    wanted = np.array([x, y, yaw])
    start = _put_down(model, configuration, command, wanted, soc)
    state = _settled(model, start, command)
    for _ in range(PLACEMENT_TRIES):
        offset = wanted - _place(state)
        offset[2] = np.remainder(offset[2] + np.pi, 2.0 * np.pi) - np.pi
        if np.abs(offset).max() < PLACEMENT_TOLERANCE:
            return state
        stands = _moved(model, state, offset)
        moved = replace(
            start, configuration=stands, joints=state.joints, supports=state.supports, outside=state.outside
        )
        state = _settled(model, moved, command, LOWERED_PERIODS)
    raise InvalidValueError(
        f"start at x {x:g} m, y {y:g} m, yaw {yaw:g} rad",
        f"at rest {1e3 * np.hypot(*offset[:2]):.1f} mm and {1e3 * abs(offset[2]):.1f} mrad off",
        f"a place where the machine rests within {1e3 * PLACEMENT_TOLERANCE:g} mm and mrad of it",
    )


def in_posture(model: PlantModel, angles: dict[str, float]) -> tuple[FloatArray, PlantCommand]:
    """Configuration (nq,) with joints at angles by name [rad], others at zero, and the command that holds them."""
    configuration = pin.neutral(model.multibody)
    command = zeros_command(len(model.joints.names), len(model.loads))
    for name, angle in angles.items():
        index = int(model.reference_rows([name])[0])
        joint = model.multibody.joints[index + 2]
        if joint.nq == 2:
            configuration[joint.idx_q : joint.idx_q + 2] = np.cos(angle), np.sin(angle)
        else:
            configuration[joint.idx_q] = angle
        command.reference[0, index] = angle
    return configuration, command


def _place(state: PlantState) -> FloatArray:
    """x, y [m] and heading [rad] of the base, shape (3,)."""
    x_axis = pin.Quaternion(state.configuration[3:7]).toRotationMatrix()[:, 0]
    return np.array([*state.configuration[:2], np.arctan2(x_axis[1], x_axis[0])])


def _moved(model: PlantModel, state: PlantState, offset: FloatArray) -> FloatArray:
    """Configuration of a standing machine moved by x, y [m] and yaw [rad], shape (3,), and raised and tilted as the
    ground under what it stands on is, in the mean of the least squares.
    """
    configuration = state.configuration.copy()
    pin.forwardKinematics(model.multibody, model.data, configuration)
    base, points = configuration[:2], _standing_points(model)[:, :2]
    turn = pin.utils.rotate("z", float(offset[2]))
    there = base + offset[:2] + (points - base) @ turn[:2, :2].T
    rises = [model.terrain.height(*b) - model.terrain.height(*a) for a, b in zip(points, there, strict=True)]
    rise, slope_x, slope_y = _plane_through(there - base - offset[:2], np.array(rises))
    tilt = pin.exp3(np.array([slope_y, -slope_x, 0.0]))
    rotation = tilt @ turn @ pin.Quaternion(configuration[3:7]).toRotationMatrix()
    configuration[:3] += (offset[0], offset[1], rise)
    configuration[3:7] = quaternion_of(rotation)
    return configuration


def _plane_through(places: FloatArray, heights: FloatArray) -> tuple[float, float, float]:
    """Height at the origin and both slopes of the plane of least squares through heights (n,) at places (n, 2) [m].

    By hand, as no linear algebra library adds up in the same order on every processor. Places on one line: level.
    """
    (x, y), (mean_x, mean_y), mean = places.T, places.mean(axis=0), float(heights.mean())
    x, y, height = x - mean_x, y - mean_y, heights - mean
    xx, xy, yy = (math.fsum(a * b) for a, b in ((x, x), (x, y), (y, y)))
    xh, yh = math.fsum(x * height), math.fsum(y * height)
    determinant = xx * yy - xy * xy
    if determinant <= ON_ONE_LINE * (xx + yy) ** 2:
        return mean, 0.0, 0.0
    slope_x, slope_y = (xh * yy - yh * xy) / determinant, (yh * xx - xh * xy) / determinant
    return mean - slope_x * float(mean_x) - slope_y * float(mean_y), slope_x, slope_y


def _put_down(model: PlantModel, posture: FloatArray, command: PlantCommand, aim: FloatArray, soc: float) -> PlantState:
    """Over the ground at aim = (x, y, yaw) in this posture, square on it, its lowest support touching."""
    x, y, yaw = aim
    height, slope_x, slope_y = _ground(model, x, y)
    normal = np.array([-slope_x, -slope_y, 1.0]) / np.sqrt(1.0 + slope_x**2 + slope_y**2)
    heading = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    forward = heading - np.dot(heading, normal) * normal
    forward /= np.linalg.norm(forward)
    rotation = np.column_stack([forward, np.cross(normal, forward), normal])
    configuration = posture.copy()
    configuration[:3] = np.array([x, y, height]) + _standing_height(model, configuration) * normal
    configuration[3:7] = quaternion_of(rotation)
    return unmoved(model, configuration, command, soc)


def unmoved(model: PlantModel, configuration: FloatArray, command: PlantCommand, soc: float) -> PlantState:
    """The machine at rest in a configuration, (nq,), before anything has acted on it."""
    joints = np.zeros((STATE_ROWS, len(model.joints.names)))
    joints[0] = command.reference[0]
    power = model.power.initial_state(soc)
    heat = None if model.heat is None else model.heat.first(power)
    return PlantState(
        tick=0,
        configuration=configuration,
        velocity=np.zeros(model.multibody.nv),
        joints=joints,
        supports=model.supports.first_states(),
        ground=model.untouched_ground,
        power=power,
        tool=None if model.tool is None else model.tool.first(),
        conditions=None if model.conditions is None else model.conditions.first(model.round_drives(heat)),
        heat=heat,
        outside=model.outside.first(joints[0]),
    )


def _settled(model: PlantModel, start: PlantState, command: PlantCommand, lowered: int = 0) -> PlantState:
    """Left alone until it rests.

    Args:
        lowered: control periods for which speed is taken away at the end of each (dynamic relaxation: Cundall 1976,
            Explicit finite-difference methods in geomechanics), so that the machine comes down without a swing.
    """
    state, quiet = start, 0
    for period in range(round(model.simulation.settle_time / model.simulation.control_period)):
        state, _ = step(model, state, command)
        quiet = quiet + 1 if np.abs(state.velocity).max() < SETTLED_SPEED else 0
        if quiet >= SETTLED_PERIODS:
            break
        if period < lowered:
            state = replace(state, velocity=np.zeros_like(state.velocity))
    # settling costs nothing and wears nothing
    return replace(
        state,
        tick=0,
        ground=start.ground,
        power=start.power,
        energy=EnergyAccount(mechanical=state.energy.mechanical),
        tool=start.tool,
        conditions=start.conditions,
        heat=start.heat,
    )


def _ground(model: PlantModel, x: float, y: float) -> tuple[float, float, float]:
    height = model.terrain.height(x, y)
    normal = model.terrain.normal(x, y)
    return height, -float(normal[0] / normal[2]), -float(normal[1] / normal[2])


def _standing_points(model: PlantModel) -> FloatArray:
    """Points of the machine's standing in map, as Pinocchio's data have it placed: (n, 3) [m]."""
    standing, placements = model.supports.standing, model.data.oMi
    return np.array(
        [placements[body].act(offset) for body, offset in zip(standing.bodies, standing.offsets, strict=True)]
    )


def _standing_height(model: PlantModel, configuration: FloatArray) -> float:
    """Height of the base over the plane that its lowest support touches, base level [m]; 0 of one without any."""
    level = configuration.copy()
    level[:7] = 0.0
    level[6] = 1.0
    pin.forwardKinematics(model.multibody, model.data, level)
    below = model.supports.standing.below
    if not below:
        return 0.0
    return float(max(np.array(below) - _standing_points(model)[:, 2]))
