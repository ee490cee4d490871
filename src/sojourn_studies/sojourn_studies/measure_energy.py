"""Measures in the plant what driving costs: the figures of `energy:` in flight.yaml.

    scripts/lib/python -m sojourn_studies.measure_energy --machine explorer

Plant, sensors and drive run in one loop without ROS (closed_loop). The machine goes straight to a goal on planes of
the scenario's soil, up and down; energy and time for each metre of way are those between the first 1.5 m, after which
rear wheels run in the ruts of the front ones, and the last half metre, or where it speeds up and slows down. Energy is
that of the loads that feed drive and steering, at the bus: motors, gears, soil and grade together. The cost of a stop
is what the whole drive takes more than its metres. A turn on the spot is measured twice: what a larger angle takes
more is the cost of a radian, the rest that of a turn; a machine that does not turn on the spot has none. A fast one
needs more way to speed up and to brake.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from sojourn_config import command_line
from sojourn_config.command_errors import CommandError
from sojourn_config.scenario import LoadedScenario
from sojourn_flight.planning.goal import Goal
from sojourn_flight.supervision.drive_types import DriveOutput
from sojourn_flight.supervision.params import DriveParams
from sojourn_studies.closed_loop import ClosedLoop
from sojourn_studies.measure_slip import on_plane

GRADES_DEG = (-8.0, -4.0, 0.0, 4.0, 8.0)
FIRST, MEASURED, LAST = 1.5, 4.0, 0.5
SETTLES = 3.0
"""Ways of speeding up until it goes evenly: a fast one overshoots its speed first, and lives on that [1]."""
SLOWS_BY = 0.15
"""At the least, towards a goal: a fast machine is shaped to a stop more gently than its wheels could [m/s^2]."""
TURNS = (0.25 * math.pi, 0.75 * math.pi)


class Spent(NamedTuple):
    """Energy of drive and steering, that of all other loads [J], and time [s]."""

    motion: float = 0.0
    house: float = 0.0
    seconds: float = 0.0

    def since(self, earlier: "Spent") -> "Spent":
        """What came after an earlier reading."""
        return Spent(*(now - then for now, then in zip(self, earlier, strict=True)))


class MeteredLoop(ClosedLoop):
    """A closed loop with a meter at its bus."""

    def __init__(self, scenario: LoadedScenario) -> None:
        super().__init__(scenario)
        self.spent = Spent()
        machine = scenario.machine
        moving = machine.loads_of([*(one.joint for one in machine.rolling), *machine.steer_joints])
        self._moves = [load.name in moving for load in self.plant.loads]

    def tick(self, goal: Goal | None = None) -> DriveOutput:
        """One period, with what it took."""
        output = self.step(goal=goal)
        powers = self.plant_output.power.load_power if self.plant_output is not None else ()
        motion = sum(float(power) for power, moves in zip(powers, self._moves, strict=True) if moves)
        period = self.plant.simulation.control_period
        spent, total = self.spent, float(sum(powers))
        self.spent = Spent(
            spent.motion + motion * period, spent.house + (total - motion) * period, spent.seconds + period
        )
        return output

    def to_go(self) -> float:
        """Along the path [m]."""
        return self.drive_state.follower.distance_to_go if self.drive_state.follower is not None else 0.0

    def reach(self, output: DriveOutput) -> None:
        """Go on to the end. Raises CommandError if the goal is not reached."""
        while not output.outcomes:
            output = self.tick()
        (outcome,) = output.outcomes
        if outcome.kind != "reached":
            raise CommandError(f"{self.scenario.name}: {outcome.kind}, {outcome.reason}")


def ends_of_way(drive: DriveParams) -> tuple[float, float]:
    """In which it is not at full speed yet, and not any more [m]."""
    speed = drive.limits.max_speed
    slowing = max(speed / drive.follower.distance_gain, speed**2 / (2.0 * SLOWS_BY))
    return max(FIRST, SETTLES * speed**2 / drive.limits.max_acceleration), max(LAST, slowing)


def on_grade(scenario: str, overrides: Sequence[str], grade_deg: float) -> tuple[Spent, Spent]:
    """For a metre of way on a grade, and for starting and stopping once."""
    loop = MeteredLoop(on_plane(scenario, overrides, abs(grade_deg), 0.0 if grade_deg > 0.0 else 180.0))
    first, last = ends_of_way(loop.scenario.drive)
    output, origin = loop.tick(Goal.at(first + MEASURED + last, 0.0)), loop.truth.configuration[:3]
    while loop.to_go() > MEASURED + last:
        output = loop.tick()
    begin, start = loop.spent, loop.truth.configuration[:3]
    while loop.to_go() > last:
        output = loop.tick()
    part = loop.spent.since(begin)
    way = math.dist(loop.truth.configuration[:3], start)
    metre = Spent(*(value / way for value in part))
    loop.reach(output)
    whole = math.dist(loop.truth.configuration[:3], origin)
    return metre, loop.spent.since(Spent(*(value * whole for value in metre)))


def turning(scenario: str, overrides: Sequence[str]) -> tuple[Spent, Spent]:
    """For a radian of a turn on the spot, and for setting the wheels for it."""
    found = []
    for angle in TURNS:
        loop = MeteredLoop(on_plane(scenario, overrides, 0.0, 0.0))
        if not loop.drive.mobility.ability.turning.on_the_spot:
            return Spent(), Spent()
        loop.reach(loop.tick(Goal.at(0.0, 0.0, angle)))
        found.append(loop.spent)
    radian = Spent(*(value / (TURNS[1] - TURNS[0]) for value in found[1].since(found[0])))
    return radian, found[0].since(Spent(*(value * TURNS[0] for value in radian)))


def cost_of_driving(scenario: str, overrides: Sequence[str]) -> dict[str, float | list[float]]:
    """What driving costs, by the keys of `drive.energy`. A stop or a turn that gives energy back costs none."""
    grades = {grade: on_grade(scenario, overrides, grade) for grade in GRADES_DEG}
    (metre, stop), (radian, turn) = grades[0.0], turning(scenario, overrides)
    return {
        "grades_deg": list(GRADES_DEG),
        "energy_per_metre": [round(max(one.motion, 0.0), 1) for one, _ in grades.values()],
        "time_per_metre": [round(one.seconds, 2) for one, _ in grades.values()],
        "stop_energy": round(max(stop.motion, 0.0), 1),
        "stop_time": round(max(stop.seconds, 0.0), 1),
        "turn_energy": round(max(turn.motion, 0.0), 1),
        "turn_time": round(max(turn.seconds, 0.0), 1),
        "energy_per_radian": round(max(radian.motion, 0.0), 1),
        "time_per_radian": round(radian.seconds, 2),
        "house_power": round(metre.house / metre.seconds, 1),
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print, as flight.yaml has it."""
    parser = command_line.Parser(prog="measure_energy", description="Measure what driving costs.")
    command_line.add_scenario(parser, "flat_drive", "whose machine, soil and body")
    given = parser.parse_args(arguments)
    overrides = command_line.changes_of(given)
    for name, value in cost_of_driving(given.scenario, overrides).items():
        print(f"{name}: {value}")
    return 0


if __name__ == "__main__":
    command_line.run_script(main)
