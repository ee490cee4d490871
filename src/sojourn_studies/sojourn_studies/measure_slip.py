"""Measures in the plant what the odometry expects of the slip, for `odometry:` in a machine's flight.yaml.

    scripts/lib/python -m sojourn_studies.measure_slip --machine explorer

The machine drives straight ahead on planes of the scenario's soil, up, down and across, at a steady rate of its wheels
near its top speed. Slip is the part of the travel of the grouser tips that does not become way; side slip is the way
aside over the way ahead, both as the machine is headed. They are means over the way after the first metres, so that
rear wheels run in the ruts of the front ones.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
import pinocchio as pin

from sojourn_config import command_line
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import step
from sojourn_plant.start import build_plant

GRADES_DEG = (-8.0, -4.0, 0.0, 4.0, 8.0)
ACROSS_DEG = (2.0, 4.0, 8.0)
PART_OF_SPEED = 0.8
"""Speed of the rims as a part of the largest speed that the drive may ask for [-]."""
BEGIN, LENGTH = 2.0, 3.0
"""Travel of the rims [m] at full speed before the measurement, and in it."""


def on_plane(scenario: str, overrides: Sequence[str], slope_deg: float, uphill_deg: float) -> LoadedScenario:
    """The scenario on a plane instead of its own ground."""
    plane = ["terrain.kind=flat"]
    if slope_deg:
        plane = ["terrain.kind=slope", f"terrain.slope_deg={slope_deg}", f"terrain.slope_direction_deg={uphill_deg}"]
    start = ["start.x=0.0", "start.y=0.0", "start.yaw=0.0", "steps=[]"]
    return load_scenario(scenario, [*overrides, "terrain.size_x=160.0", "terrain.size_y=20.0", *plane, *start])


def drive(scenario: LoadedScenario) -> tuple[float, float]:
    """Slip along and way to the left over way ahead [-]."""
    model, state = build_plant(scenario)
    command = zeros_command(len(model.joints.names), len(model.loads))
    command.reference[0] = state.motor_angles
    wheels = model.reference_rows([wheel.joint for wheel in model.machine.rolling])
    radii = np.array([wheel.shear_radius for wheel in model.machine.rolling])
    speed = PART_OF_SPEED * scenario.drive.limits.max_speed
    speeding_up = speed / scenario.drive.limits.max_acceleration
    period = model.simulation.control_period
    for number in range(round((2.0 * speeding_up + BEGIN / speed) / period)):
        command.reference[1, wheels] = min(number * period / speeding_up, 1.0) * speed / radii
        state, _ = step(model, state, command)
    angles = state.joints[0, wheels].copy()
    way = np.zeros(2)
    for _ in range(round(LENGTH / speed / period)):
        before = state.configuration[:3]
        state, _ = step(model, state, command)
        moved = pin.Quaternion(state.configuration[3:7]).toRotationMatrix().T @ (state.configuration[:3] - before)
        way += moved[:2]
    turned = float(np.mean(radii * (state.joints[0, wheels] - angles)))
    return 1.0 - float(way[0]) / turned, float(way[1] / way[0])


def expected_slip(scenario: str, overrides: Sequence[str], say: Callable[[str], None]) -> dict[str, float]:
    """What the odometry expects, by the keys of `drive.odometry`; `say` hears of each plane."""
    slips, aside = {}, {}
    for grade in GRADES_DEG:
        slips[grade], _ = drive(on_plane(scenario, overrides, abs(grade), 0.0 if grade > 0.0 else 180.0))
        say(f"grade {grade:+.0f} deg: slip {slips[grade]:.3f}")
    for slope in ACROSS_DEG:
        _, drift = drive(on_plane(scenario, overrides, slope, 90.0))
        aside[slope] = -drift / math.tan(math.radians(slope))
        say(f"across {slope:.0f} deg: side slip for each grade {aside[slope]:.2f}")
    return {
        "mean_slip": round(slips[0.0], 3),
        "slip_per_grade": round((slips[4.0] - slips[-4.0]) / (2.0 * math.tan(math.radians(4.0))), 2),
        "side_slip_per_grade": round(aside[4.0], 2),
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print."""
    parser = command_line.Parser(prog="measure_slip", description="Measure the slip that the odometry should expect.")
    command_line.add_scenario(parser, "flat_drive", "whose machine, soil and body")
    given = parser.parse_args(arguments)
    overrides = command_line.changes_of(given)
    for name, value in expected_slip(given.scenario, overrides, command_line.say).items():
        print(f"{name}: {value}")
    return 0


if __name__ == "__main__":
    command_line.run_script(main)
