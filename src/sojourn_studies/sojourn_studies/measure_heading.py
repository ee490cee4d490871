"""Measures how honest the stated deviation of the heading is, over seeds of ground and of sensors.

    scripts/lib/python -m sojourn_studies.measure_heading --grounds 5 --sensors 8

A plant drives a course of straights, curves, stops and turns on the spot, drawn from the seed of its ground. What it
did is then felt by many sets of sensors, each with a drive of its own, whose answers move nothing: heading comes from
gyro and Sun, which do not ask what the wheels were told. Told are the heading's error over its stated deviation,
squared: its mean, which is one where the deviation is honest, at the end and over all samples, and the worst error in
deviations (normalised estimation error squared: Bar-Shalom, Li and Kirubarajan 2001, sec. 5.4). The camera is left out.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sojourn_config import command_line
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_machine.params import FloatArray
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantOutput, PlantState
from sojourn_studies.closed_loop import ClosedLoop

STANDING_S, SAMPLE_S = 2.0, 10.0
MEAN_BOUNDS = 0.7, 1.3
WORST = 3.5
"""Errors beyond so many deviations are more than chance."""
MOVES = ((4.0, 0.1, 0.0), (3.0, -0.1, 0.0), (6.0, 0.09, 0.03), (5.0, 0.0, 0.12), (9.0, 0.0, -0.12), (1.5, 0.0, 0.0))
"""Time [s], speed [m/s] and yaw rate [rad/s]."""
BLIND = "drive.terrain_match=null"
SENSOR_SEEDS = 1000
"""Seeds of sensors begin here, so that none is that of a ground."""


class RecordedMotion(NamedTuple):
    """What a plant did: its model, its first state, and for each period command, state and output."""

    plant: PlantModel
    first: PlantState
    periods: list[tuple[PlanarTwist | None, PlantState, PlantOutput]]


class ReplayedLoop(ClosedLoop):
    """A loop whose plant does what another did.

    Args:
        scenario: with the seed of the sensors. motion: of the plant.
    """

    def __init__(self, scenario: LoadedScenario, motion: RecordedMotion) -> None:
        super().__init__(scenario, (motion.plant, motion.first))
        self._driven = motion

    def _move(self, stamp: int) -> None:
        _, self.truth, self.plant_output = self._driven.periods[self.period - 1]


def course(seed: int, seconds: float) -> list[PlanarTwist | None]:
    """A command for each period: a stand, and moves drawn at random; None to stand."""
    random, periods = np.random.default_rng(seed), round(seconds / CONTROL_PERIOD_S)
    told: list[PlanarTwist | None] = [None] * round(STANDING_S / CONTROL_PERIOD_S)
    while len(told) < periods:
        time, speed, turn = MOVES[random.integers(len(MOVES))]
        twist = PlanarTwist(speed, 0.0, turn) if speed or turn else None
        told += [twist] * round(time * random.uniform(0.5, 1.5) / CONTROL_PERIOD_S)
    return told[:periods]


def drive(scenario: LoadedScenario, seconds: float) -> RecordedMotion:
    """What the plant does on the course of the scenario's seed."""
    loop = ClosedLoop(scenario)
    motion = RecordedMotion(loop.plant, loop.truth, [])
    for twist in course(scenario.config.seed, seconds):
        loop.step(twist=twist)
        if loop.plant_output is not None:
            motion.periods.append((twist, loop.truth, loop.plant_output))
    return motion


def errors(scenario: LoadedScenario, motion: RecordedMotion) -> FloatArray:
    """Errors of the heading and its stated deviations at every sample, shape (samples, 2) [rad]."""
    loop, found = ReplayedLoop(scenario, motion), []
    every = round(SAMPLE_S / CONTROL_PERIOD_S)
    for period, (twist, _, _) in enumerate(motion.periods, start=1):
        true_heading = loop.true_pose[2]  # of what is measured in this period
        loop.step(twist=twist)
        if period % every == 0:
            odometry = loop.drive_state.odometry
            error = math.remainder(odometry.yaw - true_heading, 2.0 * math.pi)
            found.append((error, math.sqrt(odometry.covariance[2, 2])))
    return np.array(found)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; status 1 where a bound is not kept."""
    parser = command_line.Parser(prog="measure_heading", description="Error of the heading over its stated deviation.")
    command_line.add_scenario(parser, "lunar_sample", "whose machine and ground")
    parser.add_argument(
        "--grounds", type=int, default=5, metavar="N", help="seeds of the ground (default: %(default)s)"
    )
    parser.add_argument("--sensors", type=int, default=8, metavar="N", help="sets on each (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=80.0, metavar="T", help="of a course (default: %(default)s)")
    given = parser.parse_args(arguments)
    runs = []
    changes = command_line.changes_of(given)
    for ground in range(1, given.grounds + 1):
        motion = drive(load_scenario(given.scenario, [BLIND, *changes, f"seed={ground}"]), given.seconds)
        for number in range(given.sensors):
            seed = SENSOR_SEEDS + ground * given.sensors + number
            # what the wheels slip by is of no use to the heading
            sensors = load_scenario(given.scenario, [BLIND, "drive.mobility.slip=null", *changes, f"seed={seed}"])
            runs.append(errors(sensors, motion))
            error, sigma = 1e3 * runs[-1][-1]
            print(f"ground {ground}, sensors {seed}: {error:+.2f} mrad, {error / sigma:+.2f} sigma", flush=True)
    ratios = np.array([run[:, 0] / run[:, 1] for run in runs])
    at_end, over_all, worst = np.mean(ratios[:, -1] ** 2), np.mean(ratios**2), np.abs(ratios).max()
    print(f"normalised squared error of {len(runs)} runs: {at_end:.2f} at the end, {over_all:.2f} over all samples")
    print(f"worst: {worst:.2f} sigma")
    low, high = MEAN_BOUNDS
    return 0 if low <= at_end <= high and low <= over_all <= high and worst <= WORST else 1


if __name__ == "__main__":
    command_line.run_script(main)
