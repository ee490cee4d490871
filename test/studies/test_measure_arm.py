"""The turret on its target, in truth: gears with play and give, encoders on the motors, a rover that stands tilted."""

import numpy as np

from sojourn_flight.arm.goals import NamedGoal
from sojourn_flight.arm.kinematics import forward_kinematics
from sojourn_studies.measure_arm import ANGLE_DEG, DISTANCE_M, Bench, place
from sojourn_studies.measure_slip import on_plane


def test_the_turret_is_on_its_target_on_a_steep_slope() -> None:
    generator = np.random.default_rng(3)
    bench = Bench(on_plane("flat_drive", (), 15.0, 40.0))
    assert bench.go(NamedGoal("unfold")).status == "reached"
    for _ in range(3):
        found = place(bench, generator)
        assert found.reached and found.distance_m <= DISTANCE_M and found.angle_deg <= ANGLE_DEG
        assert 12.0 < found.tilt_deg < 18.0


def test_what_the_gears_give_is_felt_where_the_law_does_not_know_of_it() -> None:
    """With gears taken for rigid the arm believes that it has arrived: the truth is not what it measures."""
    bench = Bench(on_plane("flat_drive", (), 0.0, 0.0), known=0.0)
    answer = bench.go(NamedGoal("unfold"))
    wanted = forward_kinematics(bench.arm, np.array(bench.params.named_poses["unfold"])).position
    off = float(np.linalg.norm(forward_kinematics(bench.arm, bench.true_joints).position - wanted))
    assert answer.status == "reached" and answer.goal_error < 5e-4
    assert off > 5e-4
