"""The slip estimate in the plant, with all sensors: up a slope of loose soil, and where it cannot be climbed."""

import numpy as np

from sojourn_bringup.closed_loop import ClosedLoop
from sojourn_bringup.measure_slip import on_plane
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_mechanics.steering.goal import Goal
from sojourn_mechanics.steering.kinematics import PlanarTwist
from sojourn_mechanics.steering.slip_estimation import trouble


def standing(loop: ClosedLoop, seconds: float) -> None:
    for _ in range(round(seconds / CONTROL_PERIOD_S)):
        loop.step()


def test_slip_of_each_wheel_up_a_slope_of_twelve_degrees() -> None:
    """Median error within 5 percentage points for each wheel, from the start until the rear wheels are in ruts."""
    loop = ClosedLoop(on_plane("flat_drive", (), 12.0, 0.0))
    standing(loop, 2.0)
    errors, deviations = [], []
    for _ in range(round(22.0 / CONTROL_PERIOD_S)):
        loop.step(twist=PlanarTwist(0.06, 0.0, 0.0))
        slip = loop.drive_state.slip
        assert slip is not None
        errors.append(slip.slip - loop.true_slip)
        deviations.append((slip.shared - float(loop.true_slip.mean())) / max(slip.sigma, 1e-6))
    late = np.array(errors)[50:]
    assert np.all(np.median(np.abs(late), axis=0) < 0.05)
    assert np.mean(np.abs(deviations[50:]) < 2.0) > 0.9, "the stated deviation holds"
    assert loop.told is not None
    wheels = loop.drive.geometry.names
    told, true = np.array([loop.output.status[f"slip_{name}"] for name in wheels]), loop.told.contacts[: len(wheels), 4]
    np.testing.assert_allclose(told, true, atol=0.1)  # the same slip as in /truth/contacts, on the rim
    np.testing.assert_allclose(told - true, late[-1] / (1.0 - loop.drive.params.slip.free_slip), atol=2e-3)
    odometry = loop.drive_state.odometry
    error = odometry.x - loop.true_pose[0]
    assert abs(error) < 2.0 * np.sqrt(odometry.covariance[0, 0])


def test_wheels_that_spin_on_the_spot_end_a_goal_within_two_seconds() -> None:
    """Sixteen degrees of this soil cannot be climbed: the machine comes to a halt with all wheels turning."""
    loop = ClosedLoop(on_plane("flat_drive", (), 16.0, 0.0))
    standing(loop, 2.0)
    output, spinning = loop.step(goal=Goal.at(5.0, 0.0)), 0.0
    while not output.outcomes and loop.period * CONTROL_PERIOD_S < 30.0:
        output = loop.step()
        spinning = spinning + CONTROL_PERIOD_S if loop.true_slip.min() > 0.9 else 0.0
    slip, params = loop.drive_state.slip, loop.drive.params.slip
    assert slip is not None and params is not None
    assert spinning <= 2.0
    (outcome,) = output.outcomes
    assert outcome.kind == "stopped"
    assert outcome.reason.startswith("spinning without headway")
    assert all(wheel in outcome.reason for wheel in ("front_left", "middle_right", "rear_left"))
    assert outcome.reason == trouble(params, slip, loop.drive.geometry.names)
