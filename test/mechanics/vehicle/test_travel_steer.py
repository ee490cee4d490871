"""What suspension travel does to wheels: against rotations by hand, on a semi-trailing arm and on the explorer."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sojourn_bringup.wheeled_platform import wheeled_platform
from sojourn_config.bundle import read_machine
from sojourn_mechanics.errors import InvalidValueError
from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.vehicle.travel_steer import (
    roll_steer,
    steering_error,
    suspension_joints,
    travel_rates,
    wheel_pose,
)
from sojourn_mechanics.vehicle.wheel_loads import StandingMachine

TRACK = 1.2
ARM = np.array([-0.4, 0.2, -0.1])
"""From the pivot to the centre of the left wheel [m]."""
PIVOT = np.array([0.25, 0.9, 0.15])
"""Direction of the left pivot's axis; the right one is its mirror image."""


@pytest.fixture(scope="module")
def rover() -> StandingMachine:
    bundle = read_machine("explorer", "moon", "lunar_nominal")
    return StandingMachine(bundle.urdf_xml, bundle.rover, bundle.gravity)


@pytest.fixture(scope="module")
def arms() -> StandingMachine:
    """A platform whose wheels hang on oblique trailing arms; at the front, arms across the vehicle."""
    rover = read_machine("explorer", "moon", "lunar_nominal").rover
    rigid = wheeled_platform([0.5, -0.5], rover.wheels[0], rover.drives[:1], track=TRACK)
    urdf = rigid.urdf_xml.replace("</robot>", "")
    for number in (0, 1):
        for side, sign in (("left", 1.0), ("right", -1.0)):
            name = f"axle_{number}_{side}"
            mirror = np.array([1.0, sign, 1.0])
            axis = np.array([sign, 0.0, 0.0]) if number == 0 else PIVOT * mirror * np.array([sign, sign, sign])
            arm = np.array([0.0, 0.3 * sign, 0.0]) if number == 0 else ARM * mirror
            place = np.array([0.5 - number, 0.5 * sign * TRACK, 0.0]) - arm
            urdf = urdf.replace(
                f'<origin xyz="{0.5 - number} {sign * 0.5 * TRACK} 0"/><parent link="base_link"/>'
                f'<child link="wheel_{name}_link"/>',
                f'<origin xyz="{arm[0]} {arm[1]} {arm[2]}"/><parent link="arm_{name}_link"/>'
                f'<child link="wheel_{name}_link"/>',
            )
            urdf += (
                f'<link name="arm_{name}_link"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"'
                f' ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="arm_{name}_joint" type="revolute">'
                f'<origin xyz="{place[0]} {place[1]} {place[2]}"/><parent link="base_link"/>'
                f'<child link="arm_{name}_link"/><axis xyz="{axis[0]} {axis[1]} {axis[2]}"/>'
                '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
            )
    return StandingMachine(urdf + "</robot>", rigid.machine, 1.6)


def by_hand(angle: float) -> tuple[float, float, FloatArray]:
    """Heading, camber and place from the pivot of the left rear wheel, its arm turned by an angle about its axis."""
    turn = Rotation.from_rotvec(angle * PIVOT / np.linalg.norm(PIVOT))
    axle = turn.apply([0.0, 1.0, 0.0])
    return math.atan2(-axle[0], axle[1]), math.asin(axle[2]), turn.apply(ARM)


def test_semi_trailing_arm(arms: StandingMachine) -> None:
    """dt/dz = n_z/(n x r)_z, dg/dz = n_x/(n x r)_z for a pivot n and an arm r: the rotation of a rigid body."""
    wheel = 2
    assert suspension_joints(arms, wheel) == ("arm_axle_1_left_joint",)
    rates = travel_rates(arms, wheel)
    assert rates is not None
    sweep = np.cross(PIVOT, ARM)
    expected = [PIVOT[2] / sweep[2], PIVOT[0] / sweep[2], sweep[0] / sweep[2], sweep[1] / sweep[2]]
    assert rates == pytest.approx(expected, rel=1e-6)


def test_large_travel_of_a_semi_trailing_arm(arms: StandingMachine) -> None:
    start = wheel_pose(arms, 2, {})
    for angle in (-0.4, 0.3):
        heading, camber, place = by_hand(angle)
        pose = wheel_pose(arms, 2, {"arm_axle_1_left_joint": angle})
        assert pose[:2] == pytest.approx([heading, camber], abs=1e-9)
        assert pose[2:] - start[2:] == pytest.approx(place - ARM, abs=1e-9)
        assert steering_error(arms, 2, 0.0, {"arm_axle_1_left_joint": angle}) == pytest.approx(heading)


def test_roll_steer(arms: StandingMachine) -> None:
    """Arms across the vehicle lean the wheels and do not steer them; oblique ones steer both wheels to one side."""
    front = travel_rates(arms, 0)
    assert front is not None
    assert front.toe == pytest.approx(0.0, abs=1e-9)
    assert abs(front.camber) == pytest.approx(1.0 / 0.3)
    assert roll_steer(arms, (0, 1)) == pytest.approx(0.0, abs=1e-9)
    toe = PIVOT[2] / np.cross(PIVOT, ARM)[2]
    assert roll_steer(arms, (2, 3)) == pytest.approx(-toe * 0.5 * TRACK, rel=1e-6)


def test_rockers_do_not_steer_straight_wheels_but_steered_ones(rover: StandingMachine) -> None:
    """The wheels of a rocker-bogie move in upright planes: tan t = tan d cos c, c the pitch of what carries them."""
    for wheel in range(6):
        rates = travel_rates(rover, wheel)
        assert rates is not None and abs(rates.toe) < 1e-9 and abs(rates.camber) < 1e-9
    names = [wheel.name for wheel in rover.machine.wheels]
    front = names.index("front_left")
    joints = suspension_joints(rover, front)
    travel = {name: 0.15 for name in joints}
    steer, pitch = 0.6, 0.15 * len(joints)
    expected = math.atan(math.tan(steer) * math.cos(pitch)) - steer
    assert steering_error(rover, front, steer, travel) == pytest.approx(expected, rel=1e-6)


def test_rigid_axles_have_no_travel_and_unknown_joints_are_refused(rover: StandingMachine) -> None:
    explorer = read_machine("explorer", "moon", "lunar_nominal").rover
    rigid = wheeled_platform([0.5, -0.5], explorer.wheels[0], explorer.drives[:1])
    machine = StandingMachine(rigid.urdf_xml, rigid.machine, 1.6)
    assert travel_rates(machine, 0) is None
    assert roll_steer(machine, (0, 1)) == 0.0
    with pytest.raises(InvalidValueError, match="rocker_middle"):
        wheel_pose(rover, 0, {"rocker_middle": 0.1})
