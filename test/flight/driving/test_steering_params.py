"""Parameters of the steering chapter: what is accepted and what is refused."""

import numpy as np
import pytest
from pydantic import ValidationError

from placements import geometry_from_placements
from sojourn_flight.mobility.rolling_params import SteeringTransitionParams
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams, WheelGeometry
from sojourn_flight.planning.follower_params import GoalFollowerParams
from sojourn_flight.supervision.params import DriveParams
from wheel_drive import rolling_limits


def test_geometry_keeps_the_order_and_the_numbers_of_the_placements() -> None:
    geometry = geometry_from_placements(
        ["b", "a"], np.array([[1.0, 2.0, 9.0], [3.0, 4.0, 9.0]]), [0.1, 0.2], [(-0.5, 0.7), None]
    )
    assert geometry.names == ("b", "a")
    assert geometry.steered == (True, False)
    expected = np.array([[1.0, 2.0, 0.1, 1.0, -0.5, 0.7], [3.0, 4.0, 0.2, 0.0, 0.0, 0.0]])
    np.testing.assert_array_equal(geometry.table()[:, :6], expected)


def wheel(name: str, **changes: object) -> dict[str, object]:
    return {"name": name, "x": 0.0, "y": 0.5, "radius": 0.1, "steered": False} | changes


@pytest.mark.parametrize(
    ("second", "message"),
    [
        (wheel("a", y=-0.5), "names must differ"),
        (wheel("b"), "apart"),
        (wheel("b", y=-0.5, radius=0.0), "greater than 0"),
        (wheel("b", y=float("nan")), "finite"),
        (wheel("b", y=-0.5, steered=True, steer_min=0.2, steer_max=0.2), "steer_min"),
        (wheel("b", y=-0.5, steer_max=0.2), "fixed wheel"),
        (wheel("b", y=-0.5, steer_maximum=0.2), "steer_maximum"),
    ],
)
def test_bad_wheels_are_refused_with_the_reason(second: dict[str, object], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        SteeringGeometryParams.model_validate({"wheels": [wheel("a"), second]})


def test_one_wheel_is_not_enough() -> None:
    with pytest.raises(ValidationError, match="wheels"):
        SteeringGeometryParams(wheels=(WheelGeometry.model_validate(wheel("a")),))


def test_shipped_file_is_valid_and_its_limits_fit_together(
    drive_params: DriveParams, explorer: SteeringGeometryParams
) -> None:
    limits = drive_params.limits
    assert drive_params.cmd_vel_timeout + limits.max_speed / limits.max_deceleration <= 0.45  # of 0.5 s to stand in
    assert drive_params.follower.position_tolerance == 0.1
    assert 0.05 <= drive_params.limits.max_speed <= 0.15
    radius = explorer.wheels[0].radius
    assert rolling_limits(drive_params).max_wheel_rate * radius >= drive_params.limits.max_speed


def test_thresholds_in_the_wrong_order_are_refused(drive_params: DriveParams) -> None:
    transition = drive_params.mobility.transition.model_dump() | {"full_speed_error": 0.5, "stop_error": 0.4}
    with pytest.raises(ValidationError, match=r"full_speed_error = 0\.5"):
        SteeringTransitionParams.model_validate(transition)
    follower = drive_params.follower.model_dump() | {"align_tolerance": 0.4, "realign_angle": 0.3}
    with pytest.raises(ValidationError, match=r"align_tolerance = 0\.4"):
        GoalFollowerParams.model_validate(follower)
