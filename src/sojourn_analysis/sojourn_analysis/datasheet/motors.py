"""Motors: what each kind of drive of a machine gives, bears and holds."""

import math
from collections.abc import Iterable

from sojourn_analysis.datasheet.figures import Figure, Section
from sojourn_analysis.datasheet.subject import Subject
from sojourn_machine.actuator_choice import ActuatorParams
from sojourn_machine.drives import BrushlessMotorParams, JointDriveParams, MotorParams
from sojourn_physics.actuators import brushless
from sojourn_physics.actuators.dc_motor import (
    greatest_efficiency,
    mechanical_time_constant,
    no_load_rate,
    stall_torque,
)
from sojourn_physics.actuators.motor_thermal import (
    continuous_current,
    demagnetisation_current,
    steady_temperatures,
    warm_resistance,
)


def motors(subject: Subject) -> Section | None:
    """Of a machine of the plant, at the bus voltage; one set of figures for each drive of its file."""
    if subject.machine is None:
        return None
    return motors_of(subject.machine.machine.drives, subject.vehicle.bus_voltage)


def motors_of(drives: Iterable[ActuatorParams], voltage: float) -> Section:
    """Figures of each drive at a voltage of the bus [V]."""
    figures = [figure for drive in drives for figure in _drive(drive, voltage)]
    text = f"At {voltage:.3g} V, torques at the joint without its friction; of each kind of drive, "
    return Section("Motors", tuple(figures), (), text + "named by its first joint.")


def _drive(drive: ActuatorParams, voltage: float) -> list[Figure]:
    joint = drive.joints[0].removesuffix("_joint")
    name = joint.replace("_", " ")
    geared = drive if isinstance(drive, JointDriveParams) else None
    unit = "N m" if geared is None or geared.screw is None else "N"
    largest = Figure(f"motor_torque_{joint}", f"Largest torque, {name}", drive.motor_effort, unit)
    return [largest] if geared is None else [largest, *_geared_motor(geared, voltage, joint, unit)]


def _geared_motor(drive: JointDriveParams, voltage: float, joint: str, unit: str) -> list[Figure]:
    name = joint.replace("_", " ")
    motor, gear = drive.electric, drive.transmission
    figures: list[Figure] = []
    if isinstance(motor, MotorParams):
        fastest, best = no_load_rate(motor, voltage) / gear.ratio, greatest_efficiency(motor, voltage)
        figures += [
            Figure(f"stall_torque_{joint}", f"Stall torque, {name}", gear.ratio * stall_torque(motor, voltage), unit),
            Figure(f"no_load_rate_{joint}", f"Rate without load, {name}", fastest, "1/s"),
            Figure(f"best_efficiency_{joint}", f"Best efficiency of the motor, {name}", best),
            Figure(
                f"time_constant_{joint}",
                f"Mechanical time constant of the motor, {name}",
                1000.0 * mechanical_time_constant(motor),
                "ms",
            ),
        ]
    back = gear.back_efficiency or 1.0 / (2.0 - gear.efficiency)
    locks = drive.screw is not None and drive.screw.locks_itself
    figures.append(
        Figure(f"back_efficiency_{joint}", f"Efficiency, the load driving, {name}", 0.0 if locks else back, "")
    )
    if isinstance(drive.motor, BrushlessMotorParams):
        rate = 1.2 * voltage / (math.sqrt(3.0) * drive.motor.pole_pairs * drive.motor.flux)
        torque = gear.ratio * brushless.largest_torque(drive.motor, rate, voltage)[0]
        note = "by weakening the field; the plant does without"
        words = f"Torque a fifth beyond the rate without load, {name}"
        figures.append(Figure(f"weakened_torque_{joint}", words, torque, unit, note))
    if drive.brake is not None:
        held = drive.brake.holding_torque * gear.ratio
        figures.append(Figure(f"brake_{joint}", f"Brake holds, {name}", held, unit, "closed without current"))
    if drive.thermal is not None and isinstance(motor, MotorParams):
        current = min(continuous_current(drive.thermal, motor.resistance), motor.max_current)
        lasting = current * motor.torque_constant * gear.ratio
        figures.append(Figure(f"continuous_torque_{joint}", f"Torque that it bears for ever, {name}", lasting, unit))
        loss = current**2 * warm_resistance(motor.resistance, drive.thermal.largest_temperature)
        for state, housing in (
            ("cold", drive.thermal.surroundings),
            ("warm", steady_temperatures(drive.thermal, loss).housing),
        ):
            figures.append(
                Figure(
                    f"demagnetisation_{state}_{joint}",
                    f"Current that takes the magnets past their knee, {state}, {name}",
                    demagnetisation_current(drive.thermal, housing),
                    "A",
                    f"magnets at {housing - 273.15:.0f} °C",
                )
            )
    return figures
