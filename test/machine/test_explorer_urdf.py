"""The explorer's URDF: every link physically valid, and the machine of the MER class that it claims to be."""

import math
from collections.abc import Iterator
from functools import cache
from itertools import combinations, product
from xml.etree import ElementTree

import coal
import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from sojourn_config.arm_config import ArmConfig
from sojourn_config.load import load_params
from sojourn_config.machine import MachineConfig
from sojourn_config.machine_reader import joined_machine

EXPLORER = joined_machine("explorer")
TEXT = EXPLORER.urdf.text
ROOT = ElementTree.fromstring(TEXT)
GROUND = -0.47
"""Height of flat ground in base_link at zero pose [m]."""
FRAMES = {"navcam_link", "hazcam_link", "arm_tip_link"}
"""Links that are frames only."""
MASSIVE = [link for link in ROOT.findall("link") if link.get("name") not in FRAMES]
SIDES = ("left", "right")
CORNERS = tuple(f"{row}_{side}" for row in ("front", "rear") for side in SIDES)
WHEELS = tuple(f"{row}_{side}" for row in ("front", "middle", "rear") for side in SIDES)
ARM = tuple(f"arm_{name}_joint" for name in ("azimuth", "elevation", "elbow", "wrist", "turret"))
POSES = load_params("arms", "explorer_arm", ArmConfig).named_poses
STOW, READY = POSES["stow"], POSES["unfold"]

Array = NDArray[np.float64]


def name_of(link: ElementTree.Element) -> str:
    return str(link.get("name"))


def numbers(text: str | None) -> Array:
    return np.array([float(part) for part in (text or "0 0 0").split()])


def inertial(link: ElementTree.Element) -> tuple[float, Array, Array]:
    """Mass [kg], centre of mass [m], inertia about it [kg m2], read without any robotics library."""
    entry = link.find("inertial")
    assert entry is not None, name_of(link)
    tensor = entry.find("inertia").attrib
    value = {key: float(text) for key, text in tensor.items()}
    matrix = np.array(
        [
            [value["ixx"], value["ixy"], value["ixz"]],
            [value["ixy"], value["iyy"], value["iyz"]],
            [value["ixz"], value["iyz"], value["izz"]],
        ]
    )
    return float(entry.find("mass").get("value")), numbers(entry.find("origin").get("xyz")), matrix


def shapes(link: ElementTree.Element) -> Iterator[tuple[coal.ShapeBase, Array, Array]]:
    """Collision primitives with centre and rotation in the link."""
    for collision in link.findall("collision"):
        origin = collision.find("origin")
        shape = collision.find("geometry")[0]
        if shape.tag == "box":
            solid = coal.Box(*numbers(shape.get("size")))
        else:
            assert shape.tag == "cylinder", "primitives only"
            solid = coal.Cylinder(float(shape.get("radius")), float(shape.get("length")))
        yield solid, numbers(origin.get("xyz")), pin.rpy.rpyToMatrix(numbers(origin.get("rpy")))


@pytest.fixture(scope="module")
def model() -> pin.Model:
    return pin.buildModelFromXML(TEXT, pin.JointModelFreeFlyer())


@pytest.fixture(scope="module")
def rover() -> MachineConfig:
    return EXPLORER.config


def posture(model: pin.Model, arm: tuple[float, ...] = STOW, **joints: float) -> Array:
    q = pin.neutral(model)
    for name, value in (*zip(ARM, arm, strict=True), *joints.items()):
        q[model.joints[model.getJointId(name)].idx_q] = value
    return q


def placement(model: pin.Model, frame: str, q: Array) -> pin.SE3:
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    return data.oMf[model.getFrameId(frame)]


# --- links ---


@pytest.mark.parametrize("link", MASSIVE, ids=name_of)
def test_inertia_is_physically_valid(link: ElementTree.Element) -> None:
    mass, _, matrix = inertial(link)
    a, b, c = np.linalg.eigvalsh(matrix)
    assert mass > 0.0
    assert a > 0.0, "positive definite"
    assert a + b >= c * (1.0 - 1e-3), "principal moments obey the triangle inequality"


@pytest.mark.parametrize("link", MASSIVE, ids=name_of)
def test_centre_of_mass_is_inside_the_bounding_box(link: ElementTree.Element) -> None:
    _, centre, _ = inertial(link)
    corners = []
    for solid, position, rotation in shapes(link):
        solid.computeLocalAABB()
        box = solid.aabb_local
        half = 0.5 * (box.max_ - box.min_)
        corners += [position + rotation @ (half * signs) for signs in product((-1.0, 1.0), repeat=3)]
    assert np.all(centre >= np.min(corners, axis=0) - 1e-9)
    assert np.all(centre <= np.max(corners, axis=0) + 1e-9)


@pytest.mark.parametrize("link", MASSIVE, ids=name_of)
def test_inertia_is_that_of_the_uniform_solids_of_its_collision_geometry(link: ElementTree.Element) -> None:
    mass, centre, matrix = inertial(link)
    parts = [(solid.computeVolume(), solid.computeMomentofInertia(), p, r) for solid, p, r in shapes(link)]
    volume = sum(part[0] for part in parts)
    wanted_centre = sum(v * p for v, _, p, _ in parts) / volume
    wanted = np.zeros((3, 3))
    for v, moment, position, rotation in parts:
        arm = position - wanted_centre
        wanted += rotation @ moment @ rotation.T + v * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    assert centre == pytest.approx(wanted_centre, abs=2e-5)
    assert matrix == pytest.approx(wanted * mass / volume, rel=1e-3, abs=2e-6 * mass)


@pytest.mark.parametrize("link", ROOT.findall("link"), ids=name_of)
def test_what_is_seen_is_what_collides(link: ElementTree.Element) -> None:
    def sketch(tag: str) -> list[tuple[dict[str, str], str, dict[str, str]]]:
        shapes = [(entry.find("origin"), entry.find("geometry")[0]) for entry in link.findall(tag)]
        return [(origin.attrib, shape.tag, shape.attrib) for origin, shape in shapes]

    assert sketch("visual") == sketch("collision")
    assert (name_of(link) in FRAMES) == (not sketch("collision"))


def test_closed_forms_of_a_wheel() -> None:
    """A solid cylinder: m r^2 / 2 about the axle, m (3 r^2 + w^2) / 12 across."""
    link = next(entry for entry in MASSIVE if name_of(entry) == "wheel_front_left_link")
    mass, centre, matrix = inertial(link)
    assert centre == pytest.approx(np.zeros(3))
    across = mass * (3 * 0.125**2 + 0.16**2) / 12
    assert matrix == pytest.approx(np.diag([across, mass * 0.125**2 / 2, across]), abs=1e-6)


# --- the machine ---


def test_every_agreed_joint_is_there_with_its_axis(model: pin.Model) -> None:
    axes = {joint.get("name"): joint.find("axis") for joint in ROOT.findall("joint")}
    kinds = {joint.get("name"): joint.get("type") for joint in ROOT.findall("joint")}
    wanted = {f"{part}_{side}_joint": ("revolute", "0 1 0") for part in ("rocker", "bogie") for side in SIDES}
    wanted |= {f"steer_{corner}_joint": ("revolute", "0 0 1") for corner in CORNERS}
    wanted |= {f"wheel_{wheel}_joint": ("continuous", "0 1 0") for wheel in WHEELS}
    wanted |= dict(
        zip(ARM, [("revolute", axis) for axis in ("0 0 1", "0 1 0", "0 1 0", "0 1 0", "1 0 0")], strict=True)
    )
    moving = {name: (kinds[name], axes[name].get("xyz")) for name in kinds if kinds[name] != "fixed"}
    assert moving == wanted
    assert set(model.names) == {"universe", "root_joint", *wanted}
    links = {name_of(link) for link in ROOT.findall("link")}
    assert {name.replace("_joint", "_link") for name in wanted} <= links
    assert {"base_link", "mast_link", "imu_link", "arm_tip_link"} <= links


def test_every_joint_axis_is_upright_at_zero_pose(model: pin.Model) -> None:
    """No joint frame is turned: pitch axes are parallel, and steering is vertical."""
    data = model.createData()
    pin.forwardKinematics(model, data, pin.neutral(model))
    for i in range(1, model.njoints):
        assert data.oMi[i].rotation == pytest.approx(np.eye(3), abs=1e-12), model.names[i]


def test_total_mass_is_of_the_mer_class(model: pin.Model) -> None:
    by_hand = sum(inertial(link)[0] for link in MASSIVE)
    assert 174.0 <= by_hand <= 186.0
    assert pin.computeTotalMass(model) == pytest.approx(by_hand, rel=1e-12)
    arm = {name_of(link): inertial(link)[0] for link in MASSIVE if name_of(link).startswith("arm_")}
    assert arm.pop("arm_turret_link") == pytest.approx(2.0)
    arm.pop("arm_mount_link")
    assert sum(arm.values()) == pytest.approx(4.0)


def test_wheelbase_track_radius_and_clearance(model: pin.Model, rover: MachineConfig) -> None:
    q = pin.neutral(model)
    centre = {wheel: placement(model, f"wheel_{wheel}_link", q).translation for wheel in WHEELS}
    for side in SIDES:
        assert centre[f"front_{side}"][0] - centre[f"rear_{side}"][0] == pytest.approx(1.41)
    for row in ("front", "middle", "rear"):
        assert centre[f"{row}_left"][1] - centre[f"{row}_right"][1] == pytest.approx(1.06)
    for wheel in rover.wheels:
        link = next(entry for entry in MASSIVE if name_of(entry) == f"wheel_{wheel.name}_link")
        solid, position, rotation = next(shapes(link))
        assert (solid.radius, 2 * solid.halfLength) == pytest.approx((wheel.radius, wheel.width))
        assert wheel.radius == pytest.approx(0.125)
        assert position == pytest.approx(np.zeros(3))
        assert abs(rotation[:, 2]) == pytest.approx([0.0, 1.0, 0.0])
        assert centre[wheel.name][2] - wheel.radius == pytest.approx(GROUND), "all wheels touch one plane"
    chassis = next(shapes(next(entry for entry in MASSIVE if name_of(entry) == "base_link")))
    assert -chassis[0].halfSide[2] - GROUND == pytest.approx(0.30)
    assert 0.005 <= rover.wheels[0].grouser_height <= 0.008


def test_steering_axis_goes_through_the_wheel_centre(model: pin.Model) -> None:
    for corner in CORNERS:
        for angle in (-1.6, 0.0, 1.1):
            q = posture(model, **{f"steer_{corner}_joint": angle})
            offset = (
                placement(model, f"wheel_{corner}_link", q).translation
                - placement(model, f"steer_{corner}_link", q).translation
            )
            assert offset[:2] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_left_and_right_are_mirror_images(model: pin.Model) -> None:
    mirror = np.diag([1.0, -1.0, 1.0])
    by_name = {name_of(link): link for link in MASSIVE}
    pairs = [name for name in by_name if "_left" in name]
    assert len(pairs) == 2 + 2 + 3
    q = pin.neutral(model)
    for name in pairs:
        other = name.replace("_left", "_right")
        mass, centre, matrix = inertial(by_name[name])
        other_mass, other_centre, other_matrix = inertial(by_name[other])
        assert other_mass == mass
        assert other_centre == pytest.approx(mirror @ centre)
        assert other_matrix == pytest.approx(mirror @ matrix @ mirror)
        place = placement(model, other, q).translation
        assert place == pytest.approx(mirror @ placement(model, name, q).translation)


def test_limits_allow_crab_and_point_turn(model: pin.Model) -> None:
    for corner in CORNERS:
        joint = model.joints[model.getJointId(f"steer_{corner}_joint")]
        assert model.upperPositionLimit[joint.idx_q] > math.pi / 2
        assert model.lowerPositionLimit[joint.idx_q] < -math.pi / 2
        assert model.upperVelocityLimit[joint.idx_v] > 0.0
    for name in ARM:
        joint = model.joints[model.getJointId(name)]
        assert 30.0 <= model.upperEffortLimit[joint.idx_v] <= 80.0
        assert 0.1 <= model.upperVelocityLimit[joint.idx_v] <= 0.3


# --- balance ---


def wheel_loads(model: pin.Model, q: Array, gravity: float) -> Array:
    """Vertical forces of the wheels on flat ground [N], from statics with the torque of the differential."""
    data = model.createData()
    model.gravity.linear = np.array([0.0, 0.0, -gravity])
    wanted = np.array(pin.computeGeneralizedGravity(model, data, q))
    pin.computeJointJacobians(model, data, q)
    columns = []
    for wheel in WHEELS:
        joint = model.getJointId(f"wheel_{wheel}_joint")
        columns.append(pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)[2])
    names = [f"{part}_{side}_joint" for part in ("rocker", "bogie") for side in SIDES]
    passive = [model.joints[model.getJointId(name)].idx_v for name in names]
    differential = np.zeros(model.nv)
    differential[passive[:2]] = 1.0
    rows = [*range(6), *passive]
    matrix = np.array([*columns, differential]).T[rows]
    loads, _, rank, _ = np.linalg.lstsq(matrix, wanted[rows], rcond=None)
    assert rank == 7, "statically determinate"
    assert matrix @ loads == pytest.approx(wanted[rows], abs=1e-9), "the six wheels can hold the machine"
    return loads[:6]


def test_six_wheels_share_the_weight(model: pin.Model) -> None:
    loads = wheel_loads(model, posture(model), 1.624)
    weight = pin.computeTotalMass(model) * 1.624
    assert loads.sum() == pytest.approx(weight)
    assert loads == pytest.approx(np.full(6, weight / 6), rel=0.03)


def test_wheels_stay_loaded_with_the_arm_stretched_out(model: pin.Model) -> None:
    loads = wheel_loads(model, posture(model, (0.0, 0.0, 0.0, 0.0, 0.0)), 3.728)
    assert np.all(loads > 0.8 * loads.sum() / 6)


def test_stable_to_45_degrees(model: pin.Model) -> None:
    data = model.createData()
    centre = pin.centerOfMass(model, data, posture(model))
    height = centre[2] - GROUND
    assert math.atan2(1.06 / 2 - abs(centre[1]), height) > math.radians(45.0)
    assert math.atan2(1.41 / 2 - abs(centre[0]), height) > math.radians(45.0)


# --- the arm ---


def fold(x: float, y: float, z: float) -> tuple[float, ...]:
    """Closed form for the tool straight down at (x, y, z): two links in the plane of the azimuth."""
    upper, fore, wrist, tool = 0.41, 0.40, 0.12, 0.10
    dx, dy = x - 0.60, y + 0.14
    along = math.hypot(dx, dy) - 0.05 - wrist
    above = z + tool - (GROUND + 0.42)
    elbow = math.acos((along**2 + above**2 - upper**2 - fore**2) / (2 * upper * fore))
    shoulder = -math.atan2(above, along) - math.atan2(fore * math.sin(elbow), upper + fore * math.cos(elbow))
    return (math.atan2(dy, dx), shoulder, elbow, -shoulder - elbow, 0.0)


@cache
def checked_shapes(moving: str) -> tuple[pin.Model, pin.GeometryModel]:
    """Pairs of links that do not share a joint; only those with a link whose name starts with `moving`."""
    model = pin.buildModelFromXML(TEXT, pin.JointModelFreeFlyer())
    geometry = pin.buildGeomFromUrdfString(model, TEXT, pin.GeometryType.COLLISION)
    mount = model.getJointId("arm_azimuth_joint")
    objects = list(enumerate(geometry.geometryObjects))
    for (i, first), (j, second) in combinations(objects, 2):
        a, b = first.parentJoint, second.parentJoint
        adjacent = a == b or model.parents[a] == b or model.parents[b] == a
        at_mount = first.name.startswith("arm_mount") and b == mount
        if not adjacent and not at_mount and any(o.name.startswith(moving) for o in (first, second)):
            geometry.addCollisionPair(pin.CollisionPair(i, j))
    return model, geometry


def clearance(q: Array, moving: str = "") -> float:
    """Smallest distance of the pairs of `checked_shapes` [m]."""
    model, geometry = checked_shapes(moving)
    geometry_data = geometry.createData()
    pin.computeDistances(model, model.createData(), geometry, geometry_data, q)
    return min(result.min_distance for result in geometry_data.distanceResults)


def inside_limits(model: pin.Model, arm: tuple[float, ...]) -> bool:
    for name, value in zip(ARM, arm, strict=True):
        at = model.joints[model.getJointId(name)].idx_q
        if not model.lowerPositionLimit[at] <= value <= model.upperPositionLimit[at]:
            return False
    return True


def test_reach_from_elevation_joint_to_tip(model: pin.Model) -> None:
    offset = math.atan2(0.10, 0.12)
    elevation = placement(model, "arm_elevation_link", posture(model, READY)).translation
    straight = placement(model, "arm_tip_link", posture(model, (0.0, 0.0, 0.0, -offset, 0.0))).translation
    reach = np.linalg.norm(straight - elevation)
    assert reach == pytest.approx(0.41 + 0.40 + math.hypot(0.12, 0.10))
    assert 0.75 <= reach <= 1.0


@pytest.mark.parametrize(
    ("x", "y"),
    [*product((1.055, 1.2, 1.4), (-0.25, 0.0, 0.2)), (1.455, 0.0), (1.455, -0.3), (0.9, 0.0)],
)
def test_arm_lays_the_tool_square_on_the_ground_ahead(model: pin.Model, x: float, y: float) -> None:
    arm = fold(x, y, GROUND + 0.005)
    tip = placement(model, "arm_tip_link", posture(model, arm))
    assert tip.translation == pytest.approx([x, y, GROUND + 0.005], abs=1e-9)
    assert tip.rotation[:, 2] == pytest.approx([0.0, 0.0, -1.0], abs=1e-9), "z points out of the tool"
    assert inside_limits(model, arm)
    assert clearance(posture(model, arm), "arm_") > 0.01


def test_arm_reaches_ground_that_is_lower_or_higher(model: pin.Model) -> None:
    for z in (GROUND - 0.08, GROUND + 0.15):
        arm = fold(1.2, 0.0, z)
        assert inside_limits(model, arm)
        assert clearance(posture(model, arm), "arm_") > 0.01


@pytest.mark.parametrize("arm", [STOW, READY], ids=["stow", "ready"])
def test_named_postures_are_free_and_inside_the_limits(model: pin.Model, arm: tuple[float, ...]) -> None:
    assert inside_limits(model, arm)
    assert clearance(posture(model, arm)) > 0.01


def test_stowed_arm_is_out_of_the_way(model: pin.Model) -> None:
    q = posture(model)
    for link in ("arm_elbow_link", "arm_wrist_link", "arm_turret_link", "arm_tip_link"):
        place = placement(model, link, q).translation
        assert place[2] > GROUND + 0.33, "above the floor of the chassis"
        assert 0.45 < place[0] < 0.83, "between the front of the chassis and that of the front wheels"
        assert abs(place[1]) < 0.40, "between the front wheels"


@pytest.mark.parametrize("rocker", [-0.45, 0.45])
@pytest.mark.parametrize("bogie", [-0.6, 0.6])
@pytest.mark.parametrize("steer", [-1.6, 0.8])
def test_suspension_is_free_at_its_stops(model: pin.Model, rocker: float, bogie: float, steer: float) -> None:
    joints = {f"steer_{corner}_joint": steer for corner in CORNERS}
    joints |= {"rocker_left_joint": rocker, "rocker_right_joint": -rocker}
    joints |= {"bogie_left_joint": bogie, "bogie_right_joint": bogie}
    assert clearance(posture(model, **joints)) > 0.005
