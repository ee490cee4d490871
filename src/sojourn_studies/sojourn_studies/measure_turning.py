"""Measures in the plant how far apart the free-rolling centres of a skid-steered machine lie: its `track_ratio`.

    scripts/lib/python -m sojourn_studies.measure_turning --machine skid

The machine drives curves and turns on the spot on level ground of the scenario's soil, its wheels turning at steady
rates that differ from side to side. With the speeds V of the grouser tips on the two sides, the track B and the true
yaw rate w, the treads' instantaneous centres of rotation lie

    y_left - y_right = (V_right - V_left) (1 - s) / w = track_ratio B,        x = -v_y / w,

apart and ahead of base_link; s is the slip that the drive expects straight ahead and adds to all rates itself. The
ratio told at the end is the least-squares fit of w over all motions.

Sources: Martinez, Mandow, Morales, Pedraza & Garcia-Cerezo (2005), Int. J. Robotics Research 24(10):867, and Mandow et
al. (2007), IEEE/RSJ Int. Conf. Intelligent Robots and Systems, 1222 (centres of rotation of treads and of wheels, and
how they are measured); Wong (2008), Theory of Ground Vehicles, sec. 6.1 (turning with slip of the two sides).
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sojourn_config import command_line
from sojourn_config.command_errors import UsageError
from sojourn_config.scenario import LoadedScenario
from sojourn_flight.mobility.wheel_table import scrubs
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import step
from sojourn_plant.start import build_plant
from sojourn_studies.measure_slip import on_plane

SPEEDING_UP_S = 2.0
TURN = 2.0
"""Angle that the measurement takes, and half of it before, as a machine without slip turns [rad]."""
PARTS = ((0.0, 0.5), (0.0, 1.0), (0.7, 0.3), (0.7, -0.3), (0.7, 0.15))
"""Motions: speed and yaw rate over the largest that the drive may ask for, the latter of a machine without slip [-]."""


class MeasuredTurn(NamedTuple):
    """What came of one motion."""

    difference: float
    """Speed of the grouser tips on the right less that on the left [m/s]."""
    yaw_rate: float
    """True [rad/s]."""
    ahead: float
    """Of the centre of rotation, before base_link [m]."""
    slip: float
    """Of the mean of both sides; not a number on the spot [-]."""


def turn(scenario: LoadedScenario, speed: float, yaw_rate: float, angle: float = TURN) -> MeasuredTurn:
    """Drive one motion: speed [m/s], yaw rate [rad/s] and angle [rad] of a machine without slip."""
    model, state = build_plant(scenario)
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    wheels = model.reference_rows([wheel.joint for wheel in model.machine.rolling])
    radii = np.array([wheel.shear_radius for wheel in model.machine.rolling])
    sides = np.array([wheel.y for wheel in scenario.steering.wheels])
    rates = (speed - yaw_rate * sides) / radii
    period = model.simulation.control_period
    for number in range(round((SPEEDING_UP_S + 0.5 * angle / abs(yaw_rate)) / period)):
        command.reference[1, wheels] = min(number * period / SPEEDING_UP_S, 1.0) * rates
        state, _ = step(model, state, command)
    angles, way, turned, count = state.joints[0, wheels].copy(), np.zeros(2), 0.0, round(angle / abs(yaw_rate) / period)
    for _ in range(count):
        before = state.configuration[:3]
        state, _ = step(model, state, command)
        way += (pin.Quaternion(state.configuration[3:7]).toRotationMatrix().T @ (state.configuration[:3] - before))[:2]
        turned += float(state.velocity[5]) * period
    tips = radii * (state.joints[0, wheels] - angles)
    right, left = float(tips[sides < 0.0].mean()), float(tips[sides > 0.0].mean())
    slip = 1.0 - float(way[0]) / (0.5 * (right + left)) if speed else float("nan")
    return MeasuredTurn((right - left) / (count * period), turned / (count * period), -float(way[1]) / turned, slip)


def track_ratio(turns: Sequence[MeasuredTurn], track: float, slip: float) -> float:
    """Least squares of the yaw rates: w = difference (1 - slip) / (ratio track)."""
    kinematic = np.array([(1.0 - slip) * one.difference / track for one in turns])
    rates = np.array([one.yaw_rate for one in turns])
    return float(kinematic @ kinematic / (kinematic @ rates))


def measured_ratio(scenario: LoadedScenario, say: Callable[[str], None]) -> float:
    """Over all motions of a machine that scrubs, on the level; `say` hears of each."""
    limits, slip = scenario.drive.limits, scenario.drive.odometry.mean_slip
    sides = [wheel.y for wheel in scenario.steering.wheels]
    track, turns = max(sides) - min(sides), []
    for part_of_speed, part_of_rate in PARTS:
        speed, rate = part_of_speed * limits.max_speed, part_of_rate * limits.max_yaw_rate
        one = turn(scenario, speed, rate)
        turns.append(one)
        say(
            f"{speed:.3f} m/s, {rate:+.3f} rad/s: turns at {one.yaw_rate:+.4f} rad/s, ratio "
            f"{track_ratio([one], track, slip):.2f}, centre {one.ahead:+.3f} m ahead, slip {one.slip:.3f}"
        )
    return track_ratio(turns, track, slip)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print."""
    parser = command_line.Parser(
        prog="measure_turning", description="Measure the effective track of a skid-steered rover."
    )
    command_line.add_scenario(parser, "flat_drive", "whose machine, soil and body")
    given = parser.parse_args(arguments)
    overrides = command_line.changes_of(given)
    scenario = on_plane(given.scenario, overrides, 0.0, 0.0)
    if not scrubs(scenario.steering.wheels):
        raise UsageError(
            f"{scenario.config.machine}: all of its wheels can roll in a turn; allowed is a machine that skids"
        )
    print(f"track_ratio: {measured_ratio(scenario, command_line.say):.2f}")
    return 0


if __name__ == "__main__":
    command_line.run_script(main)
