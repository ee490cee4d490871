"""Servo, DC motor, gear and friction of every joint, one step, with implicit damping.

Motor (electrical time constant far under the step: quasi-static current):

    V = R I + k N q',   τ = N k I,   |I| <= I_max,   |V| <= bus voltage

Servo at the output:  rate mode      τ* = P (ω* - ω) + I ∫(ω* - ω) dt
                      position mode  τ* = P (q* - q) + D (q'* - q') + τ_ff + I ∫(q* - q) dt
limited by its own largest torque, by the current that the power manager allows, and by the bus voltage. The position
mode is a cascade, as in any motion controller: it asks for the rate q'* + P (q* - q) / D, which is kept within the
joint's largest rate; a rate mode keeps ω* within it. What motor and friction together bring to the joint is kept within
the joint's largest effort E: against a load that drives it backwards the gear's friction holds with the motor, which
then has to give less. Both limits are the URDF's. The servo keeps them; a load that is larger than friction alone, or
that drives the joint, does not.

Friction of gear and bearings is of Dahl's kind (Dahl 1968, Aerospace Report TOR-0158), so that a held joint
rests at a fixed point:  dz/dt = q' - |q'| z/z_c,  τ_f = F z/z_c + b q',  F = F_0 + λ|τ|:
with F_0 the friction without load and λ = 1 - η, η the gear's efficiency, in both directions of power. Of a gear whose
efficiency η_b is given for a load that drives, it is then λ_b = 1/η_b - 1, at most 1 (beyond, the step would not be
stable). Between the two goes the sense of the motion that z remembers, so that a held joint has one friction:
λ = 1 - η + [λ_b - (1 - η)](1 - u)/2, u = z/z_c sign τ.

A joint driven into its limit meets a stiff, damped stop. A joint with a spring (suspension) feels τ_s = -k (q - q_0),
explicit: with the plant's order (rate first, then angle) that keeps the energy, an implicit one would lose k dt^2/J of
it each step. The damper of a suspension counts as viscous friction.

A series motor has its own law and a brake: see `series_drive`.

With a gear that has play and gives (`gear_play`), motor and joint move each for itself: servo, motor and the gear's
friction act on the motor, stop and the friction of the bearing on the joint. The servo sees the motor's angle or the
joint's, wherever the encoder is; its damping always acts on the motor's rate.

All torques are taken as linear in the rate at the end of the step, τ(q' + a dt) = τ_0 - B a dt. B dt is added
to the joint's inertia before the machine is solved, which makes the stiff terms (back-EMF, servo, friction)
implicit. After the solution `settle_joints` finds the torques that were really applied, and books the energy
with them.
"""

import math
from typing import NamedTuple

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.actuators.gear_play import on_joint, tooth_torque
from sojourn_physics.actuators.series_drive import series_current, series_torque, torque_at_full_voltage

# Columns of a joint's parameters
RATIO, TORQUE_CONSTANT, RESISTANCE, MAX_CURRENT, EFFICIENCY, FRICTION, VISCOUS, PROPORTIONAL = range(8)
INTEGRAL, DERIVATIVE, MAX_TORQUE, ARMATURE, LOWER, UPPER, STOP_STIFFNESS, STOP_DAMPING = range(8, 16)
HALF_GAP, TOOTH_STIFFNESS, TOOTH_DAMPING, BEARING_FRICTION, BEARING_VISCOUS, SEES_JOINT = range(16, 22)
"""Of a gear with play; a stiffness of zero: there is none, motor and joint turn as one."""
SATURATION, SPRING_STIFFNESS, SPRING_REST, MAX_EFFORT, MAX_RATE, BACK_LOSS = range(22, 28)
"""SATURATION above 0: a series motor, whose field constant stands for TORQUE_CONSTANT. MAX_EFFORT [N m] of motor and
friction together, MAX_RATE [rad/s]: the joint's own limits. BACK_LOSS: λ_b - (1 - η) [-]."""
JOINT_COLUMNS = 28

PASSIVE, RATE, POSITION = 0, 1, 2
"""Kinds of joint."""
WANTED_POSITION, WANTED_RATE, WANTED_EFFORT = range(3)
"""Rows of a command's reference: [rad], [rad/s], feed-forward torque [N m]."""

FRICTION_ANGLE = 5e-4
"""z_c: angle over which friction builds up [rad]."""

# Rows of a joint's state and of the step's working arrays
ANGLE, SERVO_INTEGRAL, DEFLECTION, TWIST, MOTOR_RATE, BEARING_DEFLECTION = range(6)
STATE_ROWS = 6
"""angle [rad], integral of the servo, friction deflection z [rad]; of a gear with play: twist [rad], rate of the motor
over the gear [rad/s], deflection of the bearing's friction [rad]
"""
MOTOR, MOTOR_SLOPE, GEAR_FRICTION, GEAR_FRICTION_SLOPE, STOP, STOP_SLOPE = range(6)
TEETH, TEETH_SLOPE, BEARING, BEARING_SLOPE, MOTOR_CHANGE, MOTOR_SHARE, BRAKES = range(6, 13)
WORK_ROWS = 13
"""Torques and their slopes: of the motor, of its gear's friction, of the stop; of a gear with play: of the teeth and of
the bearing, change of the motor's rate and its share of the joint's; 1 where a brake gives the motor's torque
"""
ELECTRICAL, WINDING_HEAT, FRICTION_HEAT, STOP_HEAT = range(4)
ENERGY_TERMS = 4


class Joints(NamedTuple):
    """Joints with one degree of freedom, in the model's order."""

    parameters: FloatArray
    """(joints, JOINT_COLUMNS)"""
    kinds: IntArray
    """(joints,)"""
    columns: IntArray
    """(joints,): place in the machine's velocity."""
    loads: IntArray
    """(joints,): of the bus that the motor is on."""


class JointCommand(NamedTuple):
    """What the joints are told."""

    reference: FloatArray
    """(3, joints)"""
    limits: FloatArray
    """(joints,): fraction of its current that each motor may draw; 0 is switched off, or dead."""
    bus_voltage: FloatArray
    """(joints,): of the bus that each motor is on [V]."""


class JointWork(NamedTuple):
    """Of a step: from the torques at its start to those that were applied."""

    rows: FloatArray
    """(WORK_ROWS, joints)"""
    force: FloatArray
    """(nv,): generalised force, added to at the joints' columns."""
    armature: FloatArray
    """(nv,): to be added to the machine's inertia, written at the joints' columns."""


class JointReadings(NamedTuple):
    """What can be seen of the joints after a step."""

    efforts: FloatArray
    """(joints,) [N m]"""
    currents: FloatArray
    """(joints,) [A]"""
    load_power: FloatArray
    """(loads,): power of the motors on each load [W]."""
    energy: FloatArray
    """At least (ENERGY_TERMS,): electrical, winding heat, friction heat, stop heat [J]; added to."""


@kernel
def _dahl(friction: float, viscous: float, deflection: float, rate: float, dt: float) -> tuple[float, float]:
    """Friction torque at the end of the step [N m], and its slope [N m s/rad]."""
    stiffness = friction / FRICTION_ANGLE
    relaxed = 1.0 + dt * abs(rate) / FRICTION_ANGLE
    # z + dt q' (end of step), over `relaxed`
    return -stiffness * (deflection + dt * rate) / relaxed - viscous * rate, stiffness * dt / relaxed + viscous


@kernel
def _loss(p: FloatArray, torque: float, deflection: float) -> float:
    """λ: friction over the motor's torque [-]."""
    loss, more = float(1.0 - p[EFFICIENCY]), float(p[BACK_LOSS])
    if more != 0.0:
        sense = min(max(deflection / FRICTION_ANGLE, -1.0), 1.0)
        loss += 0.5 * more * (1.0 - (sense if torque > 0.0 else -sense))
    return loss


@kernel
def _within_effort(p: FloatArray, torque: float, deflection: float, rate: float, dt: float) -> float:
    """The motor's torque [N m], less where with friction it would be above the effort that the joint may bear.

    With the loss λ and u = -z/z_c at the end of the step, the sense of friction, the joint gets
    τ + u (F_0 + loss |τ|) - b q'.
    """
    sense = -(deflection + dt * rate) / (FRICTION_ANGLE + dt * abs(rate))
    others = float(sense * p[FRICTION] - p[VISCOUS] * rate)
    loss, effort = _loss(p, torque, deflection), float(p[MAX_EFFORT])
    if torque > 0.0:
        return float(max(min(torque, (effort - others) / (1.0 + loss * sense)), 0.0))
    return float(min(max(torque, (-effort - others) / (1.0 - loss * sense)), 0.0))


@kernel
def _slipped(deflection: float, rate: float, old_rate: float, dt: float) -> float:
    """Deflection z at the end of the step [rad]."""
    return (deflection + dt * rate) / (1.0 + dt * abs(old_rate) / FRICTION_ANGLE)


@kernel
def joint_torques(
    joints: Joints,
    command: JointCommand,
    lead: float,
    velocity: FloatArray,
    dt: float,
    states: FloatArray,
    work: JointWork,
) -> None:
    """Torques at the present rate and their slopes.

    Args:
        lead: time since the command's stamp [s]: a position reference moves on at its rate.
        velocity: (nv,) [rad/s]. states: (STATE_ROWS, joints), servo integral advanced in place. work: written.
    """
    kinds, reference = joints.kinds, command.reference
    generalised_force = work.force
    for i in range(kinds.shape[0]):
        p = joints.parameters[i]
        column = joints.columns[i]
        rate = velocity[column]
        angle = states[ANGLE, i]
        torque = 0.0
        slope = 0.0
        series = p[SATURATION] > 0.0
        bus_voltage = command.bus_voltage[i]
        braking = False
        has_play = p[TOOTH_STIFFNESS] > 0.0
        joint_rate = rate  # from here to the friction, `rate` is the motor's
        seen, spring_slope = angle, dt * p[PROPORTIONAL]
        if has_play:
            rate = states[MOTOR_RATE, i]
            if p[SEES_JOINT] > 0.0:
                spring_slope = 0.0
            else:
                seen += states[TWIST, i]
        if kinds[i] != PASSIVE:
            gain = p[RATIO] * p[TORQUE_CONSTANT]
            fraction = command.limits[i]
            if fraction > 0.0 or series:
                if kinds[i] == RATE:
                    wanted = min(max(reference[WANTED_RATE, i], -p[MAX_RATE]), p[MAX_RATE]) if fraction > 0.0 else 0.0
                    error = wanted - rate
                    torque = p[PROPORTIONAL] * error + p[INTEGRAL] * states[SERVO_INTEGRAL, i]
                    slope = p[PROPORTIONAL]
                    braking = series and (wanted == 0.0 or torque * rate < 0.0)
                else:
                    error = reference[WANTED_POSITION, i] + reference[WANTED_RATE, i] * lead - seen
                    asked = p[DERIVATIVE] * reference[WANTED_RATE, i] + p[PROPORTIONAL] * error
                    most = p[DERIVATIVE] * p[MAX_RATE]
                    if abs(asked) > most:
                        asked = math.copysign(most, asked)
                        error = spring_slope = 0.0
                    torque = (
                        asked
                        - (p[DERIVATIVE] + spring_slope) * rate
                        + reference[WANTED_EFFORT, i]
                        + p[INTEGRAL] * states[SERVO_INTEGRAL, i]
                    )
                    slope = p[DERIVATIVE] + spring_slope
                current = p[MAX_CURRENT] * fraction
                if braking:
                    largest = p[MAX_TORQUE]
                elif series:
                    by_current = p[RATIO] * series_torque(p[TORQUE_CONSTANT], p[SATURATION], current)
                    largest = min(p[MAX_TORQUE], by_current)
                else:
                    largest = min(p[MAX_TORQUE], gain * current)
                limited = min(max(torque, -largest), largest)
                limited = _within_effort(p, limited, states[DEFLECTION, i], rate, dt)
                if limited != torque:
                    torque = limited
                    slope = 0.0
                # what the bus voltage can drive against the back-EMF
                if braking:
                    high, low, steep = largest, -largest, 0.0
                elif series:
                    high, steep = torque_at_full_voltage(
                        p[TORQUE_CONSTANT], p[SATURATION], p[RESISTANCE], bus_voltage, p[RATIO] * abs(rate)
                    )
                    high, low, steep = p[RATIO] * high, -p[RATIO] * high, p[RATIO] ** 2 * steep
                else:
                    back = gain * rate
                    high = gain * (bus_voltage - back) / p[RESISTANCE]
                    low = gain * (-bus_voltage - back) / p[RESISTANCE]
                    steep = gain * gain / p[RESISTANCE]
                if torque > high or torque < low:
                    torque = high if torque > high else low
                    slope = steep
                    # driven backwards beyond no-load speed: the amplifier's limit holds
                    limited = _within_effort(p, min(max(torque, -largest), largest), states[DEFLECTION, i], rate, dt)
                    if limited != torque:
                        torque = limited
                        slope = 0.0
                elif slope != 0.0 or torque * error < 0.0:
                    states[SERVO_INTEGRAL, i] += error * dt  # no wind-up while saturated
        friction = p[FRICTION] + _loss(p, torque, states[DEFLECTION, i]) * abs(torque)
        friction_torque, friction_slope = _dahl(friction, p[VISCOUS], states[DEFLECTION, i], rate, dt)
        stop = 0.0
        stop_slope = 0.0
        over = max(angle + dt * joint_rate - p[UPPER], 0.0) + min(angle + dt * joint_rate - p[LOWER], 0.0)
        if over != 0.0:
            stop = -p[STOP_STIFFNESS] * over - p[STOP_DAMPING] * joint_rate
            if stop * over < 0.0:
                stop_slope = p[STOP_STIFFNESS] * dt + p[STOP_DAMPING]
            else:  # a stop pushes, it does not hold back
                stop = 0.0
        work.rows[MOTOR, i] = torque
        work.rows[MOTOR_SLOPE, i] = slope
        work.rows[GEAR_FRICTION, i] = friction_torque
        work.rows[GEAR_FRICTION_SLOPE, i] = friction_slope
        work.rows[STOP, i] = stop
        work.rows[STOP_SLOPE, i] = stop_slope
        work.rows[BRAKES, i] = 1.0 if braking else 0.0
        generalised_force[column] -= p[SPRING_STIFFNESS] * (angle - p[SPRING_REST])
        if not has_play:
            generalised_force[column] += torque + friction_torque + stop
            work.armature[column] = p[ARMATURE] + dt * (slope + friction_slope + stop_slope)
            continue
        bearing, bearing_slope = _dahl(
            p[BEARING_FRICTION], p[BEARING_VISCOUS], states[BEARING_DEFLECTION, i], joint_rate, dt
        )
        tooth, tooth_slope = tooth_torque(
            states[TWIST, i], rate - joint_rate, p[HALF_GAP], p[TOOTH_STIFFNESS], p[TOOTH_DAMPING], dt
        )
        through, through_slope, change, share = on_joint(
            torque + friction_torque, slope + friction_slope, p[ARMATURE], tooth, tooth_slope, dt
        )
        work.rows[TEETH, i] = tooth
        work.rows[TEETH_SLOPE, i] = tooth_slope
        work.rows[BEARING, i] = bearing
        work.rows[BEARING_SLOPE, i] = bearing_slope
        work.rows[MOTOR_CHANGE, i] = change
        work.rows[MOTOR_SHARE, i] = share
        generalised_force[column] += through + bearing + stop
        work.armature[column] = dt * (through_slope + bearing_slope + stop_slope)


@kernel
def settle_joints(
    joints: Joints,
    old_velocity: FloatArray,
    velocity: FloatArray,
    dt: float,
    rows: FloatArray,
    states: FloatArray,
    readings: JointReadings,
) -> float:
    """Applied torques, currents, friction states and energies of a step that has been solved.

    Args:
        old_velocity, velocity: (nv,) rates at the start and the end of the step.
        rows: of the step's work. states: (STATE_ROWS, joints), advanced in place. readings: written.

    Returns:
        electrical power of all motors at their terminals [W].
    """
    kinds, columns, energy = joints.kinds, joints.columns, readings.energy
    efforts, currents, load_power = readings.efforts, readings.currents, readings.load_power
    load_power[:] = 0.0
    total = 0.0
    for i in range(kinds.shape[0]):
        p = joints.parameters[i]
        rate = velocity[columns[i]]
        old_rate = old_velocity[columns[i]]
        change = rate - old_rate
        mean_rate = 0.5 * (rate + old_rate)
        stop = rows[STOP, i] - rows[STOP_SLOPE, i] * change
        spring = -p[SPRING_STIFFNESS] * (states[ANGLE, i] - p[SPRING_REST])
        states[ANGLE, i] += rate * dt
        energy[STOP_HEAT] -= stop * mean_rate * dt
        through = 0.0
        has_play = p[TOOTH_STIFFNESS] > 0.0
        if has_play:  # from here on the rates are the motor's
            bearing = rows[BEARING, i] - rows[BEARING_SLOPE, i] * change
            states[BEARING_DEFLECTION, i] = _slipped(states[BEARING_DEFLECTION, i], rate, old_rate, dt)
            energy[FRICTION_HEAT] -= bearing * mean_rate * dt
            joint_change, joint_rate, joint_mean_rate = change, rate, mean_rate
            change = rows[MOTOR_CHANGE, i] + rows[MOTOR_SHARE, i] * joint_change
            old_rate = states[MOTOR_RATE, i]
            rate = old_rate + change
            mean_rate = 0.5 * (rate + old_rate)
            tooth = rows[TEETH, i] + rows[TEETH_SLOPE, i] * (change - joint_change)
            states[MOTOR_RATE, i] = rate
            states[TWIST, i] += dt * (rate - joint_rate)
            energy[FRICTION_HEAT] += tooth * (mean_rate - joint_mean_rate) * dt
            through = tooth + bearing
        torque = rows[MOTOR, i] - rows[MOTOR_SLOPE, i] * change
        friction_torque = rows[GEAR_FRICTION, i] - rows[GEAR_FRICTION_SLOPE, i] * change
        states[DEFLECTION, i] = _slipped(states[DEFLECTION, i], rate, old_rate, dt)
        energy[FRICTION_HEAT] -= friction_torque * mean_rate * dt
        efforts[i] = through if has_play else torque + friction_torque + spring
        if kinds[i] == PASSIVE:
            continue
        series = p[SATURATION] > 0.0
        if rows[BRAKES, i] > 0.0 or (series and torque * mean_rate < 0.0):  # a brake, not the motor
            currents[i] = 0.0
            energy[FRICTION_HEAT] -= torque * mean_rate * dt
            continue
        if series:
            current = series_current(p[TORQUE_CONSTANT], p[SATURATION], abs(torque) / p[RATIO])
            current = math.copysign(current, torque)
        else:
            current = torque / (p[RATIO] * p[TORQUE_CONSTANT])
        heat = p[RESISTANCE] * current * current
        power = heat + torque * mean_rate
        currents[i] = current
        load_power[joints.loads[i]] += power
        total += power
        energy[ELECTRICAL] += power * dt
        energy[WINDING_HEAT] += heat * dt
    return total
