"""Measures in the plant how well the drive keeps to a path: lateral error in truth, slip, energy.

    scripts/lib/python -m sojourn_studies.measure_path --scenario lunar_route

Plant, sensors and drive run in one loop without ROS (closed_loop) along the first route of the scenario. The lateral
error in truth is that of the true place of base_link to the path, the one in odom what the drive believes: their
difference is the odometry's. Slip is the part of the travel of the grouser tips that does not become way."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sojourn_config import command_line
from sojourn_config.command_errors import CommandError
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_flight.planning.energy_forecast import SECONDS_PER_HOUR
from sojourn_flight.planning.goal import Goal
from sojourn_flight.planning.path import PlannedPath
from sojourn_operator.scenario_steps import script_steps
from sojourn_operator.steps.drive_route import DriveRouteStep
from sojourn_studies.measure_energy import MeteredLoop

LONGEST_S = 3600.0


@dataclass(frozen=True, slots=True)
class PathFigures:
    """What a drive along a path has shown."""

    outcome: str
    reason: str
    length: float
    """Of the path [m]."""
    seconds: float
    rms_true: float
    max_true: float
    """Lateral error in truth [m]."""
    rms_odom: float
    max_odom: float
    """The same as the drive believes [m]."""
    end_error: float
    """Distance between the true place and that in odom at the end [m]."""
    slip: float
    """Mean over the way [-]."""
    forecast: float
    spent: float
    """Energy, before and after [J]."""


class TruePlace:
    """Follows the true place along the path."""

    def __init__(self, path: PlannedPath) -> None:
        self.path = path
        self._leg, self._near = 0, 0.0
        self.square = self.gone = self.most = 0.0

    def take(self, leg: int, x: float, y: float) -> None:
        """The place while the drive is on a leg."""
        if leg != self._leg:
            self._leg, self._near = leg, 0.0
        place = self.path.legs[leg].nearest(x, y, self._near)
        step = max(place.distance - self._near, 0.0)
        self._near = max(place.distance, self._near)
        self.square += place.lateral**2 * step
        self.gone += step
        self.most = max(self.most, abs(place.lateral))


def follow_path(scenario: LoadedScenario, goal: Goal) -> PathFigures:
    """Drive along a path. Raises CommandError if it is refused or does not end within LONGEST_S."""
    loop = MeteredLoop(scenario)
    output = loop.tick(goal)
    way = loop.drive_state.follower
    if way is None:
        raise CommandError(f"the route of {scenario.name}: {loop.drive_state.text}")
    true = TruePlace(way.path)
    joints = loop.plant.reference_rows([wheel.joint for wheel in loop.plant.machine.wheels])
    radii = np.array([wheel.shear_radius for wheel in loop.plant.machine.wheels])
    driven = travelled = 0.0
    while not output.outcomes:
        place, angles = loop.truth.configuration[:3], loop.truth.joints[0, joints]
        output = loop.tick()
        now = loop.drive_state.follower
        if now is not None and now.path is way.path and now.phase == "drive":
            x, y, _ = loop.true_pose
            true.take(now.leg, x, y)
            driven += float(np.linalg.norm(loop.truth.configuration[:3] - place))
            travelled += float(np.mean(radii * np.abs(loop.truth.joints[0, joints] - angles)))
        if loop.period * loop.plant.simulation.control_period > LONGEST_S:
            raise CommandError(f"the route of {scenario.name} did not end within {LONGEST_S:.0f} s")
    (outcome,) = output.outcomes
    forecast = loop.drive_state.energy.forecast
    x, y, _ = loop.true_pose
    return PathFigures(
        outcome.kind,
        outcome.reason,
        way.path.length,
        loop.period * loop.plant.simulation.control_period,
        math.sqrt(true.square / max(true.gone, 1e-9)),
        true.most,
        outcome.lateral_rms,
        outcome.lateral_max,
        math.hypot(output.odometry.x - x, output.odometry.y - y),
        1.0 - driven / max(travelled, 1e-9),
        forecast.total if forecast is not None else math.nan,
        loop.spent.motion + loop.spent.house,
    )


def route_of(scenario: LoadedScenario) -> Goal:
    """The first route of a scenario. Raises CommandError if it has none."""
    for step, _ in script_steps(scenario):
        if isinstance(step, DriveRouteStep):
            return Goal.along(step.corners, step.yaw)
    raise CommandError(f"scenario {scenario.name} has no drive_route among its steps")


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print, one line a seed."""
    parser = command_line.Parser(prog="measure_path", description="Measure how well the drive keeps to a path.")
    command_line.add_scenario(parser, "lunar_route", "whose route")
    parser.add_argument("--seeds", type=int, nargs="+", default=[11], help="of ground and sensors")
    given = parser.parse_args(arguments)
    for seed in given.seeds:
        scenario = load_scenario(given.scenario, [*command_line.changes_of(given), f"seed={seed}"])
        found = follow_path(scenario, route_of(scenario))
        print(
            f"seed {seed}: {found.outcome} ({found.reason}), {found.length:.1f} m in {found.seconds:.0f} s, slip "
            f"{100 * found.slip:.1f} %; lateral error in truth {found.rms_true:.3f} m RMS, {found.max_true:.3f} m at "
            f"most, in odom {found.rms_odom:.3f} and {found.max_odom:.3f} m; odometry is {found.end_error:.2f} m off "
            f"at the end; {found.spent / SECONDS_PER_HOUR:.2f} Wh, forecast {found.forecast / SECONDS_PER_HOUR:.2f} Wh",
            flush=True,
        )
    return 0


if __name__ == "__main__":
    command_line.run_script(main)
