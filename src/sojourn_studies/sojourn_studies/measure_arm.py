"""Measures how near the arm's tip comes to random targets, in truth and at rest, on slopes.

    scripts/lib/python -m sojourn_studies.measure_arm --targets 50 --json errors.json

In one process, without ROS: the plant with the play and give of its gears, all sensors, the laws of the arm's node.
For every five targets the rover is put down on another slope, headed anywhere. A target is a place of the tip and a
direction of the tool, of joint positions drawn evenly from within the limits; those that the arm refuses (its way would
collide with rover or ground) are drawn anew and counted. Errors are of the true joints, by the kinematics of the URDF:
in base_link, where the target was given, and over the ground, where the rover gives way under the arm besides.
`--known 0.8`: the arm's law takes the gears for so much of as soft and loose as they are; 0: for rigid.
"""

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin

from sojourn_config import command_line
from sojourn_config.command_errors import CommandError
from sojourn_config.scenario import LoadedScenario
from sojourn_contract.app import Period
from sojourn_contract.stamps import CONTROL_PERIOD_NS, CONTROL_PERIOD_S
from sojourn_flight.arm import controller
from sojourn_flight.arm.feedforward import gravity_in_body
from sojourn_flight.arm.goals import ArmGoal, NamedGoal, PoseGoal
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_flight.arm.model import build_arm_model
from sojourn_machine.mounting import IMU_LINK, mounting
from sojourn_machine.params import FloatArray
from sojourn_physics.plant.state import zeros_command
from sojourn_physics.plant.step import step
from sojourn_plant.start import build_plant
from sojourn_plant.truth import TruthMessages
from sojourn_sensors.app import SensorsApp
from sojourn_studies.measure_slip import on_plane

STEEPEST_DEG = 15.0
TARGETS_A_SLOPE = 5
REST_S = 2.0
"""After the arm has said that it is there, before its error is read [s]."""
PATIENCE_S = 150.0
MOST_REFUSALS = 300
DISTANCE_M, ANGLE_DEG = 0.002, 0.5
"""Asked for."""


@dataclass(frozen=True, slots=True)
class TipPlacement:
    """One target and how near the tip came to it."""

    tilt_deg: float
    reached: bool
    distance_m: float
    angle_deg: float
    distance_over_ground_m: float
    refused_before: int


class Bench:
    """The rover at rest on a slope, with its arm's node in the loop."""

    def __init__(self, scenario: LoadedScenario, known: float = 1.0) -> None:
        self.model, self.state = build_plant(scenario)
        arm = scenario.carried_arm()
        gears = {key: tuple(known * x for x in getattr(arm, key)) for key in ("gear_compliance", "gear_backlash")}
        self.params = arm.model_copy(update=gears)
        self.arm = build_arm_model(scenario.urdf_xml, self.params)
        self.arm_state = controller.initial_state(self.params)
        self.output: controller.ArmOutput | None = None
        self._truth = TruthMessages(self.model)
        self._imu_to_base = mounting(scenario.urdf_xml, IMU_LINK)[0]
        self._sensors, self._gravity = SensorsApp(scenario), scenario.gravity
        self._sensing = self._sensors.initial_state()
        self._command = zeros_command(len(self.model.joints.names), len(self.model.loads))
        self._command.reference[0] = self.state.motor_angles
        self._rows = self.model.reference_rows(self.params.joint_names)
        self._stamp = CONTROL_PERIOD_NS
        self._messages = dict(self._truth.first(self._stamp, self.state))
        self._ground = self._ground_below()

    @property
    def base_in_map(self) -> pin.SE3:
        """True pose of the rover."""
        return pin.XYZQUATToSE3(self.state.configuration[:7])

    @property
    def true_joints(self) -> FloatArray:
        """Of the arm (n,) [rad]."""
        return np.array(self.state.joints[0, self._rows])

    def period(self, goal: ArmGoal | None = None) -> controller.ArmOutput:
        """Measure, let the arm's law answer, and go on by one control period."""
        measured = self._measure()
        names = measured.names
        places = [names.index(name) for name in self.params.joint_names]
        request = controller.ArmInput(
            positions=measured.position[places],
            velocities=measured.velocity[places],
            gravity_in_base=self._imu_to_base @ gravity_in_body(measured.attitude, self._gravity),
            goal=goal,
            ground=self._ground,
        )
        self.arm_state, answer = controller.step(self.params, self.arm, self.arm_state, request, CONTROL_PERIOD_S)
        for row, values in enumerate((answer.positions, answer.velocities, answer.efforts)):
            self._command.reference[row, self._rows] = values
        self.state, output = step(self.model, self.state, self._command)
        self._stamp += CONTROL_PERIOD_NS
        self._messages = dict(self._truth.messages(self._stamp, self.state, output))
        return answer

    def go(self, goal: ArmGoal) -> controller.ArmOutput:
        """Carry a goal out and let the arm rest; what it says in the end."""
        answer = self.period(goal)
        for _ in range(round(PATIENCE_S / CONTROL_PERIOD_S)):
            if answer.status != "moving":
                break
            answer = self.period()
        if answer.status != "refused":
            for _ in range(round(REST_S / CONTROL_PERIOD_S)):
                self.period()
        return answer

    def _measure(self) -> "_Reading":
        self._sensing, answer = self._sensors.step(self._sensing, Period(self._stamp, self._messages))
        for topic, reason in answer.refusals:
            raise CommandError(f"the sensors refuse {topic}: {reason}")
        said = dict(answer.messages)
        joints = said["/joint_states"]
        return _Reading(joints.names, joints.position, joints.velocity, said["/imu/data"].orientation)

    def _ground_below(self) -> GroundPlane:
        """The plane on which the rover stands, in base_link."""
        base = self.base_in_map
        x, y, _ = base.translation
        normal = np.asarray(self.model.terrain.normal(x, y))
        below = base.actInv(np.array([x, y, self.model.terrain.height(x, y)]))
        in_base = base.rotation.T @ normal
        return GroundPlane(float(in_base @ below), (float(in_base[0]), float(in_base[1]), float(in_base[2])))


@dataclass(frozen=True, slots=True)
class _Reading:
    names: tuple[str, ...]
    position: FloatArray
    velocity: FloatArray
    attitude: FloatArray


def place(bench: Bench, generator: np.random.Generator) -> TipPlacement:
    """Draw targets until one is accepted, and go there.

    Raises:
        CommandError: all of very many were refused.
    """
    for refused in range(MOST_REFUSALS):
        wanted = forward_kinematics(bench.arm, generator.uniform(bench.arm.lower, bench.arm.upper))
        before = bench.base_in_map
        goal = PoseGoal(tuple(wanted.position), tuple(wanted.tool_direction))
        answer = bench.go(goal)
        if answer.status == "refused":
            continue
        tip = forward_kinematics(bench.arm, bench.true_joints)
        after = bench.base_in_map
        over_ground = after.act(tip.position) - before.act(wanted.position)
        cosine = float(np.clip(tip.tool_direction @ wanted.tool_direction, -1.0, 1.0))
        return TipPlacement(
            tilt_deg=math.degrees(math.acos(min(before.rotation[2, 2], 1.0))),
            reached=answer.status == "reached",
            distance_m=float(np.linalg.norm(tip.position - wanted.position)),
            angle_deg=math.degrees(math.acos(cosine)),
            distance_over_ground_m=float(np.linalg.norm(over_ground)),
            refused_before=refused,
        )
    raise CommandError(f"the arm refused {MOST_REFUSALS} targets one after the other, the last: {answer.reason}")


def placements(
    scenario: str, overrides: Sequence[str], count: int, seed: int, known: float = 1.0
) -> Iterator[TipPlacement]:
    """So many random targets, on random slopes."""
    generator = np.random.default_rng(seed)
    for first in range(0, count, TARGETS_A_SLOPE):
        slope, uphill = generator.uniform(0.0, STEEPEST_DEG), generator.uniform(-180.0, 180.0)
        bench = Bench(on_plane(scenario, [*overrides, f"seed={seed + first}"], slope, uphill), known)
        bench.go(NamedGoal("unfold"))
        for _ in range(min(TARGETS_A_SLOPE, count - first)):
            yield place(bench, generator)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure and print; status 0 if every target was met as asked."""
    parser = command_line.Parser(
        prog="measure_arm", description="Measure how near the arm's tip comes to random targets."
    )
    command_line.add_scenario(parser, "flat_drive", "whose machine, soil and body")
    parser.add_argument("--targets", type=int, default=50, metavar="N", help="how many (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of targets and slopes (default: %(default)s)")
    parser.add_argument("--known", type=float, default=1.0, metavar="PART", help="what the law knows of the gears (1)")
    parser.add_argument("--json", metavar="FILE", help="write every placement")
    given = parser.parse_args(arguments)
    found = []
    changes = command_line.changes_of(given)
    for placement in placements(given.scenario, changes, given.targets, given.seed, given.known):
        found.append(placement)
        print(
            f"{len(found):3d}  tilt {placement.tilt_deg:4.1f} deg: off by {1e3 * placement.distance_m:.2f} mm, "
            f"{placement.angle_deg:.3f} deg; over the ground {1e3 * placement.distance_over_ground_m:.2f} mm"
            + ("" if placement.reached else "  NOT REACHED"),
            flush=True,
        )
    distances = np.array([placement.distance_m for placement in found])
    angles = np.array([placement.angle_deg for placement in found])
    over_ground = np.array([placement.distance_over_ground_m for placement in found])
    print(f"distance: median {1e3 * np.median(distances):.2f}, largest {1e3 * distances.max():.2f} mm (asked 2 mm)")
    print(f"direction: median {np.median(angles):.3f}, largest {angles.max():.3f} deg (asked 0.5 deg)")
    print(f"over the ground: median {1e3 * np.median(over_ground):.2f}, largest {1e3 * over_ground.max():.2f} mm")
    print(f"targets drawn anew because the arm refused them: {sum(placement.refused_before for placement in found)}")
    if given.json:
        Path(given.json).write_text(json.dumps([asdict(placement) for placement in found], indent=1), encoding="utf-8")
    met = [p.reached and p.distance_m <= DISTANCE_M and p.angle_deg <= ANGLE_DEG for p in found]
    return 0 if all(met) else 1


if __name__ == "__main__":
    command_line.run_script(main)
