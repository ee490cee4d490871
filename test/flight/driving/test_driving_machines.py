"""The laws of steering on the plant: what is asked of a machine is what it does, also with a motor that has failed."""

import math

import numpy as np
import pytest
from driven_plant import DrivenPlant

from sojourn_flight.mobility.twist import PlanarTwist
from sojourn_flight.mobility.wheel_twist import twist_from_wheels
from sojourn_flight.planning.goal import Goal
from wheel_drive import WheelOutput

ROCK = "soil=rigid_rock"


def moved(machine: DrivenPlant, twist: PlanarTwist, seconds: float) -> tuple[float, float, float]:
    """Way ahead and to the left in the frame at the start [m], and turn [rad]."""
    (x, y), yaw = machine.position, machine.yaw
    machine.run(seconds, twist=twist)
    ahead, left = machine.position[0] - x, machine.position[1] - y
    return (
        math.cos(yaw) * ahead + math.sin(yaw) * left,
        math.cos(yaw) * left - math.sin(yaw) * ahead,
        math.remainder(machine.yaw - yaw, 2.0 * math.pi),
    )


@pytest.mark.parametrize(
    "twist", [(0.15, 0.0, 0.0), (0.0, 0.15, 0.0), (0.1, -0.1, 0.0), (0.0, 0.0, 0.3), (0.0, 0.1, 0.2)]
)
def test_omni_drives_in_every_direction_on_rock(twist: tuple[float, float, float]) -> None:
    machine = DrivenPlant("flat_drive", ["machine=omni", ROCK])
    asked = PlanarTwist(*twist)
    machine.run(3.0, twist=asked)  # until it is up to speed
    ahead, left, turn = moved(machine, asked, 4.0)
    assert turn == pytest.approx(4.0 * asked.yaw_rate, abs=0.02)
    # a constant twist moves along an arc
    half = 0.5 * turn
    chord = 4.0 * (math.sin(half) / half if half else 1.0)
    wanted_ahead = chord * (asked.v_x * math.cos(half) - asked.v_y * math.sin(half))
    wanted_left = chord * (asked.v_x * math.sin(half) + asked.v_y * math.cos(half))
    assert (ahead, left) == pytest.approx((wanted_ahead, wanted_left), abs=0.015)


def test_articulated_folds_at_a_stand_and_keeps_to_its_curve() -> None:
    machine = DrivenPlant("flat_drive", ["machine=articulated"])
    asked = PlanarTwist(0.12, 0.0, 0.06)
    start = machine.position
    dragged: list[float] = []

    def watch(machine: DrivenPlant, output: WheelOutput) -> None:
        rolling = output.wheel_rates * (1.0 - machine.drive.params.odometry.mean_slip)  # what they do on the ground
        found = twist_from_wheels(machine.drive.table, rolling, output.steer_angles, 1.0, output.steer_rates)
        dragged.append(found.residual)

    machine.run(1.5, twist=asked, watch=watch)
    assert math.dist(start, machine.position) < 0.02  # first the joint, then the way
    assert abs(machine.state.joints[0, machine.plant.joint_index["articulation_joint"]]) > 0.05
    machine.run(8.0, twist=asked, watch=watch)
    assert max(dragged) < 0.01
    ahead, left, turn = moved(machine, asked, 10.0)
    assert turn == pytest.approx(0.6, rel=0.06)
    assert math.hypot(ahead, left) == pytest.approx(2.0 * 2.0 * math.sin(0.3), rel=0.05)  # the slip is driven out


def test_ten_metres_with_a_steering_locked_at_twenty_degrees() -> None:
    fault = "{joint: steer_front_left_joint, kind: servo_locked, at: 10.0, angle_deg: 20.0}"
    machine = DrivenPlant("flat_drive", [f"faults=[{fault}]", "terrain.size_x=40"])
    said: dict[str, float] = {}

    def watch(machine: DrivenPlant, output: WheelOutput) -> None:
        said.setdefault(str(output.status["failed_motors"]), machine.time)

    outcome = machine.run(200.0, Goal.at(9.0, 0.0), watch=watch)
    assert outcome is not None
    assert outcome.kind == "reached"
    assert list(said) == ["", "steering of front_left stands at 20.0 degrees"]
    assert said["steering of front_left stands at 20.0 degrees"] < 10.0 + 1.5 + 3.0  # the way there, and steer_time
    locked = machine.state.joints[0, machine.plant.joint_index["steer_front_left_joint"]]
    assert np.degrees(locked) == pytest.approx(20.0, abs=0.5)
    assert math.dist(machine.position, (9.0, 0.0)) < 0.5
