"""Measures how far off the odometry is, over seeds of ground, soil and sensors; no seed knows of another.

    scripts/lib/python -m sojourn_studies.measure_odometry --seeds 20
    scripts/lib/python -m sojourn_studies.measure_odometry --scenario lunar_route --machine omni --set soil=rigid_rock
    scripts/lib/python -m sojourn_studies.measure_odometry --scenario lunar_curves --seeds 20 --first 6

Each seed drives the first route of a scenario in plant, sensors and drive (see `closed_loop`). Its ground, rocks and
all noise are those of the seed; its soil is the scenario's with parameters off by SPREAD, while the drive believes what
its file says. Told are the error at the end over the distance, whether it lies within the 95 % ellipse of the stated
covariance, and how far the rover truly is from the end of its route. `--set drive.terrain_match=null` leaves the camera
out, `--set 'faults=[{joint: wheel_middle_left_joint, kind: motor_dead, at: 15}]'` has a motor fail.
"""

import math
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import NamedTuple

import numpy as np

from sojourn_config import command_line
from sojourn_config.command_errors import UsageError
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_flight.planning.goal import Goal
from sojourn_machine.errors import InvalidValueError
from sojourn_operator.steps.drive_route import DriveRouteStep
from sojourn_studies.closed_loop import ClosedLoop

SPREAD = {"shear_modulus": 0.15, "k_phi": 0.25, "cohesion": 0.3}
"""Standard deviation of a soil's parameter over its value [-]: a soil of known kind at an unknown place (Heiken et al.
1991, Lunar Sourcebook, sec. 9.1: the scatter of the Apollo soils at one depth). Cut off at two deviations.
"""
FRICTION_SPREAD_DEG = 1.5
STANDING_S, LONGEST_S = 2.0, 600.0
CHI_SQUARE_95 = 5.991
"""Of two degrees of freedom."""


class SeedResult(NamedTuple):
    """One seed: distance gone [m], true error at the end in x and y [m], error over its deviations squared, error and
    deviation of the heading [rad], true distance from the last point of the route [m], how the goal ended.
    """

    seed: int
    distance: float
    error: float
    squared: float
    heading_error: float
    heading_sigma: float
    missed: float
    outcome: str


def soil_of(scenario: LoadedScenario, seed: int) -> list[str]:
    """Overrides of the soil for a seed."""
    random = np.random.default_rng(seed)
    soil, found = scenario.soil, []
    for name, spread in SPREAD.items():
        value = getattr(soil, name)
        if value is not None:
            found.append(f"soil.{name}={value * (1.0 + spread * np.clip(random.standard_normal(), -2.0, 2.0)):.6g}")
    off = FRICTION_SPREAD_DEG * np.clip(random.standard_normal(), -2.0, 2.0)
    return [*found, f"soil.friction_angle_deg={soil.friction_angle_deg + off:.6g}"]


def route_of(scenario: LoadedScenario) -> Goal:
    """The first route among the steps.

    Raises:
        UsageError: there is none.
    """
    for step in scenario.config.steps:
        if isinstance(step.action, DriveRouteStep):
            return Goal.along(step.action.corners)
    raise UsageError(f"scenario {scenario.name}: no step drives a route; allowed is one with drive_route")


def drive(name: str, overrides: Sequence[str], seed: int) -> SeedResult:
    """One seed."""
    nominal = load_scenario(name, overrides)
    scenario = load_scenario(name, [*overrides, f"seed={seed}", *soil_of(nominal, seed)])
    try:
        loop, goal = ClosedLoop(scenario), route_of(nominal)
    except InvalidValueError as error:
        raise UsageError(f"scenario {name}, seed {seed}: {error}") from None
    for _ in range(round(STANDING_S / CONTROL_PERIOD_S)):
        loop.step()
    output, distance, before = loop.step(goal=goal), 0.0, loop.true_pose
    while not output.outcomes and loop.period * CONTROL_PERIOD_S < LONGEST_S:
        output = loop.step()
        now = loop.true_pose
        distance, before = distance + math.dist(now[:2], before[:2]), now
    if distance == 0.0:
        said = output.outcomes[0].reason if output.outcomes else f"not done in {LONGEST_S:.0f} s"
        raise UsageError(f"scenario {name}, seed {seed}: {said}; allowed is a route that this rover can drive")
    estimate, truth = output.odometry, loop.true_pose
    off = np.array((estimate.x - truth[0], estimate.y - truth[1]))
    return SeedResult(
        seed,
        distance,
        float(np.linalg.norm(off)),
        float(off @ np.linalg.solve(estimate.covariance[:2, :2], off)),
        math.remainder(estimate.yaw - truth[2], 2.0 * math.pi),
        math.sqrt(estimate.covariance[2, 2]),
        math.dist(truth[:2], goal.points[-1]),
        output.outcomes[0].kind if output.outcomes else "not done",
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; status 1 where a bound is not kept or a seed could not be driven."""
    parser = command_line.Parser(prog="measure_odometry", description="Error of /odom over seeds of ground and soil.")
    command_line.add_scenario(parser, "lunar_sample", "whose first route")
    parser.add_argument(
        "--seeds", type=command_line.count, default=20, metavar="N", help="so many (default: %(default)s)"
    )
    parser.add_argument("--first", type=int, default=1, metavar="SEED", help="the first of them (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="at a time (default: %(default)s)")
    given = parser.parse_args(arguments)
    overrides = command_line.changes_of(given)
    route_of(load_scenario(given.scenario, overrides))
    results: list[SeedResult] = []
    with ProcessPoolExecutor(given.jobs) as pool:
        seeds = range(given.first, given.first + given.seeds)
        for driven in [pool.submit(drive, given.scenario, overrides, seed) for seed in seeds]:
            try:
                results.append(driven.result())
                print(in_words(results[-1]), flush=True)
            except UsageError as error:  # the other seeds tell what they tell without it
                print(error, flush=True)
    refused = given.seeds - len(results)
    if refused:
        print(f"not driven: {refused} of {given.seeds} seeds")
    return 0 if results and judged(results) and not refused else 1


def in_words(result: SeedResult) -> str:
    """One seed, in a line."""
    return (
        f"seed {result.seed:3d}: {result.outcome}, {result.distance:5.2f} m, error {result.error:.3f} m "
        f"({100.0 * result.error / result.distance:.2f} %), {math.sqrt(result.squared):.2f} sigma, heading "
        f"{1e3 * result.heading_error:+.2f} mrad ({abs(result.heading_error) / result.heading_sigma:.2f}), "
        f"{result.missed:.2f} m from the goal"
    )


def judged(results: Sequence[SeedResult]) -> bool:
    """Print what all of them come to; whether the bounds are kept."""
    parts = np.array([result.error / result.distance for result in results])
    inside = np.array([result.squared <= CHI_SQUARE_95 for result in results])
    print(
        f"error over distance: median {100.0 * np.median(parts):.2f} %, root mean square "
        f"{100.0 * math.sqrt(np.mean(parts**2)):.2f} %, worst {100.0 * parts.max():.2f} %, under 3 % in "
        f"{int((parts < 0.03).sum())} of {len(parts)}"
    )
    print(f"inside the stated 95 % ellipse: {int(inside.sum())} of {len(inside)}")
    return bool(inside.mean() >= 0.9 and np.median(parts) < 0.03)


if __name__ == "__main__":
    command_line.run_script(main)
