"""Measures in the plant what the slip estimate believes of the soil: `slip: fresh, rut` in flight.yaml.

    scripts/lib/python -m sojourn_studies.measure_traction --scenario flat_drive

The machine drives straight ahead on planes of the scenario's soil, up and down, at a steady rate of its wheels: first
all of them on fresh ground, then the rear ones in the ruts of the front ones. The curves of torque against slip (see
`sojourn_flight.odometry.traction`) are those that fit the sum of the torques best, with the loads that the drive
expects; so errors of these loads are in the curves.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from sojourn_config import command_line
from sojourn_config.command_errors import UsageError
from sojourn_config.scenario import LoadedScenario
from sojourn_flight.mobility.wheel_load_map import wheel_load_map
from sojourn_flight.odometry.traction import coefficient, in_rut
from sojourn_machine.contact_report import ReportColumn
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import step
from sojourn_plant.start import build_plant
from sojourn_studies.measure_slip import PART_OF_SPEED, on_plane

GRADES_DEG = (-8.0, -4.0, 0.0, 4.0, 8.0, 11.0, 13.0, 16.0)
LENGTH_S, BEGIN_S, EVERY_S = 45.0, 3.0, 1.0
LONGEST = 30.0
"""Travel of the rims at most [m]: the plane goes on for 40 m."""
STEADY = 0.01
"""Change of the slip from one look to the next that counts as steady [-]."""
START = (0.5, 0.3, 0.05, 0.5, 0.0)


class Sample(NamedTuple):
    """One look at a machine: slip, sum of torques over sum of levers, levers over their sum, curve of each wheel."""

    slip: float
    torque: float
    levers: FloatArray
    kinds: IntArray


def samples(scenario: LoadedScenario, grade_deg: float, loads: FloatArray, rut_width: float) -> list[Sample]:
    """What a drive up a plane shows, a look a second, while the slip is steady."""
    model, state = build_plant(scenario)
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    rows = model.reference_rows([wheel.joint for wheel in model.machine.wheels])
    table, period = scenario.steering.table(), model.simulation.control_period
    speed = PART_OF_SPEED * scenario.drive.limits.max_speed
    command.reference[1, rows] = speed / table[:, 2]
    pitch = -math.radians(grade_deg)
    levers = table[:, 2] * (loads @ np.array((math.cos(pitch), math.sin(pitch), 0.0)))
    begin, found, before = state.configuration[:3].copy(), [], math.nan
    for tick in range(1, round(min(LENGTH_S, LONGEST / speed) / period) + 1):
        state, output = step(model, state, command)
        if tick * period < BEGIN_S or tick % round(EVERY_S / period):
            continue
        way = float(np.linalg.norm(state.configuration[:3] - begin))
        kinds = np.array([int(in_rut(table, i, 1.0, 0.0, rut_width, way)) for i in range(len(rows))])
        # the plant counts on the rim, the drive on the grouser tips
        ground = 1.0 - output.contacts[: len(rows), ReportColumn.SLIP_RATIO]
        slip = 1.0 - float(np.mean(ground * [wheel.radius for wheel in model.machine.wheels] / table[:, 2]))
        steady, before = abs(slip - before) < STEADY, slip
        if not steady:
            continue
        found.append(Sample(slip, float(output.efforts[rows].sum() / levers.sum()), levers / levers.sum(), kinds))
    return found


def fit(looks: Sequence[Sample]) -> FloatArray:
    """Rows fresh and rut of limit, softness and offset; the limit, that of the soil's strength, is one for both."""

    def curves(values: FloatArray) -> FloatArray:
        limit, *rest = values
        return np.array([[limit, *rest[:2]], [limit, *rest[2:]]])

    def misfit(values: FloatArray) -> FloatArray:
        tried = curves(values)
        needed = [
            sum(
                lever * coefficient(tried[kind], look.slip) for lever, kind in zip(look.levers, look.kinds, strict=True)
            )
            for look in looks
        ]
        return np.array(needed) - np.array([look.torque for look in looks])

    bounds = ((0.05, 0.02, -0.1, 0.02, -0.1), (3.0, 3.0, 0.5, 3.0, 0.5))
    return curves(least_squares(misfit, START, loss="soft_l1", f_scale=0.01, bounds=bounds).x)


def measured_curves(scenario: str, overrides: Sequence[str], say: Callable[[str], None]) -> dict[str, dict[str, float]]:
    """The keys `fresh` and `rut` of `drive.mobility.slip`; `say` hears of each plane. Raises UsageError for a machine
    without wheels.
    """
    looks: list[Sample] = []
    for grade in GRADES_DEG:
        plane = on_plane(scenario, overrides, abs(grade), 0.0 if grade > 0.0 else 180.0)
        body = plane.machine_body()
        if not body.machine.wheels or body.machine.tracks:
            raise UsageError(f"{plane.config.machine} has no wheels that pull alone; allowed is one that has")
        loads = wheel_load_map(body.urdf_xml, body.machine, body.gravity, body.stowed)
        found = samples(plane, grade, loads, 0.5 * body.machine.wheels[0].width)
        looks += found
        told = f"slip {found[-1].slip:.3f}, torque coefficient {found[-1].torque:.3f}" if found else "no steady slip"
        say(f"grade {grade:+.0f} deg: {told}")
    keys = ("limit", "softness", "offset")
    return {
        name: {key: round(float(value), 3) for key, value in zip(keys, row, strict=True)}
        for name, row in zip(("fresh", "rut"), fit(looks), strict=True)
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print."""
    parser = command_line.Parser(
        prog="measure_traction", description="Measure torque against slip for the drive's belief."
    )
    command_line.add_scenario(parser, "flat_drive", "whose machine, soil and body")
    given = parser.parse_args(arguments)
    for name, curve in measured_curves(given.scenario, command_line.changes_of(given), command_line.say).items():
        print(f"{name}: {{{', '.join(f'{key}: {value:.3f}' for key, value in curve.items())}}}")
    return 0


if __name__ == "__main__":
    command_line.run_script(main)
