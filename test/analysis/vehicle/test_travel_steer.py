"""What suspension travel does to wheels: against rotations by hand, on a semi-trailing arm and on the explorer."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sojourn_analysis.vehicle.from_machine import BusSupply, vehicle_of
from sojourn_analysis.vehicle.travel_steer import (
    roll_steer,
    steering_error,
    suspension_joints,
    travel_rates,
    wheel_pose,
)
from sojourn_analysis.vehicle.two_bodies import two_bodies
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_config.bundle import read_machine
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import SuspensionParams
from sojourn_machine.params import FloatArray
from sojourn_studies.wheeled_platform import STRUT_MASS, WHEEL_MASS, Chassis, wheeled_platform

TRACK = 1.2
ARM = np.array([-0.4, 0.2, -0.1])
"""From the pivot to the centre of the left wheel [m]."""
PIVOT = np.array([0.25, 0.9, 0.15])
"""Direction of the left pivot's axis; the right one is its mirror image."""


@pytest.fixture(scope="module")
def rover() -> StandingMachine:
    bundle = read_machine("explorer", "moon", "lunar_nominal")
    return StandingMachine(bundle.urdf_xml, bundle.machine, bundle.gravity)


@pytest.fixture(scope="module")
def arms() -> StandingMachine:
    """A platform whose wheels hang on oblique trailing arms; at the front, arms across the vehicle."""
    rover = read_machine("explorer", "moon", "lunar_nominal").machine
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
    explorer = read_machine("explorer", "moon", "lunar_nominal").machine
    rigid = wheeled_platform([0.5, -0.5], explorer.wheels[0], explorer.drives[:1])
    machine = StandingMachine(rigid.urdf_xml, rigid.machine, 1.6)
    assert travel_rates(machine, 0) is None
    assert roll_steer(machine, (0, 1)) == 0.0
    with pytest.raises(InvalidValueError, match="rocker_middle"):
        wheel_pose(rover, 0, {"rocker_middle": 0.1})


def test_springs_of_a_machine_as_its_wheels_feel_them() -> None:
    """On struts the rate at the wheel is the spring's; what hangs on a strut is unsprung; loads need no friction."""
    explorer = read_machine("explorer", "moon", "lunar_nominal").machine
    spring = SuspensionParams(joints=("pattern",), stiffness=3000.0, damping=400.0)
    platform = wheeled_platform([0.5, -0.3], explorer.wheels[0], explorer.drives[:1], struts=spring)
    machine = StandingMachine(platform.urdf_xml, platform.machine, 1.6)
    assert len(machine.sprung) == 4 and machine.passive == ()
    stance = machine.stand(lambda x, y: 0.0)
    loads = machine.loads(stance).normal
    assert loads.sum() == pytest.approx(machine.mass * 1.6)
    assert machine.spring_compliance(stance) == pytest.approx(np.full(4, 1.0 / 3000.0))
    vehicle = vehicle_of("platform", machine, BusSupply(28.0, 100.0, 0.0), 1.0)
    assert [axle.spring_rate for axle in vehicle.axles] == pytest.approx([3000.0, 3000.0])
    assert [axle.damping for axle in vehicle.axles] == pytest.approx([400.0, 400.0])
    assert [axle.unsprung_mass for axle in vehicle.axles] == pytest.approx([WHEEL_MASS + STRUT_MASS] * 2)
    # a softer ground under one wheel takes load from it and its diagonal: four springs are hyperstatic
    raised = machine.loads(machine.stand(lambda x, y: 0.01 if x > 0.0 and y > 0.0 else 0.0)).normal
    assert raised[0] > loads[0] and raised[3] > loads[3] and raised[1] < loads[1] and raised[2] < loads[2]


def test_two_bodies_of_an_articulated_machine() -> None:
    """The rear axle on a body of its own, 0.1 m behind the middle, which a motor turns about the vertical."""
    rover = read_machine("explorer", "moon", "lunar_nominal").machine
    rigid = wheeled_platform([0.5, -0.6], rover.wheels[0], rover.drives[:1], chassis=Chassis(60.0, centre=(0.2, 0.1)))
    urdf = rigid.urdf_xml.replace("</robot>", "").replace('xyz="-0.6 ', 'xyz="-0.5 ')
    for side in ("left", "right"):
        child = f'<child link="wheel_axle_1_{side}_link"/>'
        urdf = urdf.replace('<parent link="base_link"/>' + child, '<parent link="rear_link"/>' + child)
    urdf += (
        '<link name="rear_link"><inertial><origin xyz="-0.3 0 0.1"/><mass value="40"/><inertia ixx="1" iyy="2" izz="3"'
        ' ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="fold_joint" type="revolute"><origin xyz="-0.1 0 0"/>'
        '<parent link="base_link"/><child link="rear_link"/><axis xyz="0 0 1"/>'
        '<limit lower="-0.7" upper="0.7" effort="100" velocity="1"/></joint></robot>'
    )
    steering = rover.drives[1].model_copy(update={"joints": ("fold_joint",)})
    machine = StandingMachine(urdf, rigid.machine.model_copy(update={"drives": (*rigid.machine.drives, steering)}), 1.6)
    halves = two_bodies(machine, "fold_joint")
    front, rear = halves.front, halves.rear
    assert (front.mass, rear.mass) == pytest.approx((60.0 + 2 * WHEEL_MASS, 40.0 + 2 * WHEEL_MASS))
    assert (front.axle, rear.axle) == pytest.approx((0.6, 0.5))
    assert rear.centre == pytest.approx((40.0 * 0.3 + 2 * WHEEL_MASS * 0.5) / rear.mass)
    wheels = 2 * WHEEL_MASS * (0.5**2 + 0.25 * 0.125**2) + 40.0 * 0.3**2
    assert rear.yaw_inertia == pytest.approx(3.0 + wheels + 0.5 * WHEEL_MASS - rear.mass * rear.centre**2)
    assert halves.joint.stiffness == steering.servo.proportional
    assert halves.largest_angle == pytest.approx(0.7)
    with pytest.raises(InvalidValueError, match="knee"):
        two_bodies(machine, "knee")
    with pytest.raises(InvalidValueError, match="geared_motor"):
        two_bodies(read_and_stand("explorer"), "bogie_left_joint")


def read_and_stand(name: str) -> StandingMachine:
    bundle = read_machine(name, "moon", "lunar_nominal")
    return StandingMachine(bundle.urdf_xml, bundle.machine, bundle.gravity)
