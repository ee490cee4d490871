"""Measures in the plant how far a machine goes downhill while it turns on the spot, for `turn_drift_per_grade`.

    scripts/lib/python -m sojourn_studies.measure_turn_drift --machine skid

The machine makes four quarter turns on a plane of the scenario's soil by the laws of its own drive, each from another
heading and on fresh ground: in ruts of its own it would be held. The way downhill over the angle and the sine of the
slope is their mean. Wheels that slide sideways bear no load beside their slide: a rover that skids creeps down by a
metre where one that steers its wheels does by decimetres.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from sojourn_config import command_line
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_studies.closed_loop import ClosedLoop
from sojourn_studies.measure_slip import on_plane

SLOPES_DEG = (2.0, 4.0, 8.0)
PART_OF_RATE = 0.5
"""Yaw rate as a part of the largest that the drive may ask for [-]."""
STANDING_S, LONGEST_S = 1.0, 600.0
TAKEN_DEG = 4.0
"""The slope whose figure is taken, as for the side slip."""
HEADINGS_DEG = (0.0, 90.0, 180.0, 270.0)
"""Of the way uphill, seen from the machine."""
QUARTER = 0.5 * math.pi


def drift(loop: ClosedLoop, slope_deg: float, uphill_deg: float) -> float:
    """Way downhill in a quarter turn over its angle and the sine of the slope [m/rad]."""
    for _ in range(round(STANDING_S / loop.plant.simulation.control_period)):
        loop.step()
    twist = PlanarTwist(0.0, 0.0, PART_OF_RATE * loop.drive.params.limits.max_yaw_rate)
    begin, uphill = loop.true_pose, math.radians(uphill_deg)
    last = loop.period + round(LONGEST_S / loop.plant.simulation.control_period)
    while (turned := math.remainder(loop.true_pose[2] - begin[2], 2.0 * math.pi)) < QUARTER and loop.period < last:
        loop.step(twist=twist)
    x, y, _ = loop.true_pose
    down = -(x - begin[0]) * math.cos(uphill) - (y - begin[1]) * math.sin(uphill)
    return down / (turned * math.sin(math.radians(slope_deg)))


def expected_drift(scenario: str, overrides: Sequence[str], say: Callable[[str], None]) -> dict[str, float]:
    """What the odometry expects, by the key of `drive.odometry`; nothing of a machine that cannot turn on the spot."""
    found = {}
    for slope in SLOPES_DEG:
        drifts = []
        for uphill in HEADINGS_DEG:
            loop = ClosedLoop(on_plane(scenario, overrides, slope, uphill))
            if not loop.drive.mobility.ability.turning.on_the_spot:
                return {}
            drifts.append(drift(loop, slope, uphill))
        found[slope] = float(np.mean(drifts))
        say(f"turning on {slope:.0f} deg: downhill by {found[slope]:.2f} m/rad for each grade")
    return {"turn_drift_per_grade": max(round(found[TAKEN_DEG], 2), 0.0)}


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print."""
    parser = command_line.Parser(
        prog="measure_turn_drift", description="Measure the drift downhill in turns that the odometry should expect."
    )
    command_line.add_scenario(parser, "flat_drive", "whose machine, soil and body")
    given = parser.parse_args(arguments)
    overrides = command_line.changes_of(given)
    for name, value in expected_drift(given.scenario, overrides, command_line.say).items():
        print(f"{name}: {value}")
    return 0


if __name__ == "__main__":
    command_line.run_script(main)
