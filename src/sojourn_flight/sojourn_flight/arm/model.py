"""The arm alone, cut out of a rover's URDF: inertias, collision shapes and the chain in arrays.

All joints that are not the arm's are locked (at zero or at `locked_positions`), so that the rover becomes
one rigid body that carries the arm. The model is then re-based: its universe frame is `base_link`, in which
every position, direction and gravity vector of this chapter is given.

Collision pairs: every shape of a moving arm link against every shape of the rest of the rover, and against
the shapes of arm links that are not neighbours. Neighbours are links that share a joint. Shapes must be
primitives (box, sphere, cylinder): meshes would be files.

Source: rigid body algorithms and model reduction of Pinocchio (Carpentier et al., SII 2019). Not
thread-safe: `data` and `geometry_data` are scratch memory that every call overwrites; they carry no state.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio
from numpy.typing import NDArray

from sojourn_flight.arm.chain import Chain, stretched_length
from sojourn_flight.arm.collision_pairs import add_collision_pairs, link_name, rebase_shapes
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.serial_arm import chain_of, rebase
from sojourn_flight.arm.surface_points import SurfacePoints, surface_points
from sojourn_flight.arm.urdf_chain import ArmModelError
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ArmModel:
    """What every function of the chapter reads. Arrays are per joint in chain order; do not write to them."""

    joint_names: tuple[str, ...]
    chain: Chain
    lower: FloatArray  # (n,) [rad or m]
    upper: FloatArray  # (n,) [rad or m]
    max_velocity: FloatArray  # (n,) [rad/s or m/s]
    max_acceleration: FloatArray  # (n,) [rad/s2]
    max_jerk: FloatArray  # (n,) [rad/s3]
    max_effort: FloatArray  # (n,) [N m or N]
    reach: float  # length of the chain stretched out, without what lies before its first joint [m]; 1 where it has none
    rotor_inertia: FloatArray  # (n,) at the joints [kg m2 or kg]
    pinocchio_model: Any
    data: Any
    geometry_model: Any
    geometry_data: Any
    pairs: tuple[tuple[str, str], ...]  # link names of each collision pair
    pair_shapes: NDArray[np.int64]  # (pairs, 2) indices in the geometry model
    shape_centres: FloatArray  # (shapes, 3) in base_link [m]; only those that do not move are up to date
    shape_parents: NDArray[np.int64]  # (shapes,) joint that moves each, counted from 1; 0 for none
    shape_places: FloatArray  # (shapes, 3) centre in that joint's frame [m]
    shape_radii: FloatArray  # (shapes,) of a sphere about the centre that holds the shape [m]
    arm_shapes: tuple[tuple[int, str], ...]  # index in the geometry model, link name
    pair_reach: FloatArray  # (pairs, n) bound of the relative speed of a pair's points per joint rate [m/rad]
    shape_reach: FloatArray  # (arm_shapes, n) the same for each arm shape in base_link
    surface: SurfacePoints  # of the arm_shapes
    turns: tuple[bool, ...]  # whether each joint turns, or slides; also of one that is held
    held: tuple[int, ...] = ()  # joints that stay where they are: their limits, both

    @property
    def joint_count(self) -> int:
        """Number of joints [-]."""
        return len(self.joint_names)

    @property
    def moving_count(self) -> int:
        """Number of joints that are not held [-]."""
        return len(self.joint_names) - len(self.held)

    def unit(self, joint: int) -> str:
        """Of a joint's position, for texts."""
        return "rad" if self.turns[joint] else "m"

    def effort_unit(self, joint: int) -> str:
        """Of a joint's effort, for texts."""
        return "N m" if self.turns[joint] else "N"


def reach_from_base(model: ArmModel) -> float:
    """Most that the tip may be from the origin of the base [m]."""
    return model.reach + float(np.linalg.norm(model.chain.translation[0]))


def build_arm_model(urdf_xml: str, params: ArmParams) -> ArmModel:
    """Arm model from the text of a URDF.

    Args:
        urdf_xml: the XML itself, not a path.
        params: the arm's parameters.

    Raises:
        ArmModelError: malformed XML, a joint or link that is missing, joints not in chain order, meshes.
        InvalidValueError: a named pose out of the URDF's limits, a speed limit above the URDF's.
    """
    full, geometry = _parse(urdf_xml)
    for name in params.joint_names:
        if not full.existJointName(name):
            raise ArmModelError(f"joint_names: '{name}' is not a joint of the URDF; there are {list(full.names)[1:]}")
    reference = pinocchio.neutral(full)
    for name, value in params.locked_positions.items():
        if not full.existJointName(name) or full.joints[full.getJointId(name)].nq != 1:
            raise ArmModelError(f"locked_positions: '{name}' is not a joint with limits of the URDF")
        reference[full.joints[full.getJointId(name)].idx_q] = value
    locked = [i for i in range(1, full.njoints) if full.names[i] not in params.joint_names]
    model, shapes = pinocchio.buildReducedModel(full, geometry, locked, reference)
    for link in (params.base_link, params.tip_link):
        if not model.existFrame(link):
            raise ArmModelError(f"'{link}' is not a link of the URDF")
    _check_chain(model, params)
    rebase_shapes(model, shapes, params.base_link)
    rebase(model, params.base_link)
    if params.reflected_inertia:
        model.armature = np.array(params.reflected_inertia)
    _check_links(model, params)
    add_collision_pairs(model, shapes, {frozenset(pair) for pair in params.ignored_link_pairs})
    objects = shapes.geometryObjects
    reach = _reach(model, shapes)
    moving = tuple((i, link_name(model, g.parentFrame)) for i, g in enumerate(objects) if g.parentJoint > 0)
    chain = chain_of(model, params.tip_link, params.tool_axis)
    lower, upper = np.array(model.lowerPositionLimit), np.array(model.upperPositionLimit)
    arm = ArmModel(
        joint_names=params.joint_names,
        chain=chain,
        lower=lower,
        upper=upper,
        max_velocity=np.array(params.max_velocity),
        max_acceleration=np.array(params.max_acceleration),
        max_jerk=np.array(params.max_jerk),
        max_effort=np.array(model.upperEffortLimit),
        reach=stretched_length(chain, lower, upper),
        rotor_inertia=np.array(model.armature),
        pinocchio_model=model,
        data=model.createData(),
        geometry_model=shapes,
        geometry_data=shapes.createData(),
        pairs=tuple(
            (link_name(model, objects[p.first].parentFrame), link_name(model, objects[p.second].parentFrame))
            for p in shapes.collisionPairs
        ),
        pair_shapes=np.array([(p.first, p.second) for p in shapes.collisionPairs], dtype=np.int64).reshape(-1, 2),
        shape_centres=np.array([g.placement.translation for g in objects]).reshape(-1, 3),
        shape_parents=np.array([int(g.parentJoint) for g in objects], dtype=np.int64),
        shape_places=np.array([g.placement.translation for g in objects]).reshape(-1, 3),
        shape_radii=np.array([_radius(g) for g in objects]),
        arm_shapes=moving,
        surface=surface_points(objects, tuple(index for index, _ in moving)),
        pair_reach=_pair_reach(shapes, reach),
        turns=tuple(bool(flag > 0.5) for flag in chain.revolute),
        shape_reach=np.array([reach[i] for i, g in enumerate(objects) if g.parentJoint > 0]).reshape(-1, len(reach.T)),
    )
    _check_limits(arm, params, np.array(model.upperVelocityLimit))
    return arm


def _parse(urdf_xml: str) -> tuple[Any, Any]:
    try:
        full = pinocchio.buildModelFromXML(urdf_xml)
        geometry = pinocchio.buildGeomFromUrdfString(full, urdf_xml, pinocchio.GeometryType.COLLISION)
    except (ValueError, RuntimeError) as error:
        raise ArmModelError(f"the URDF could not be read (meshes are not accepted): {error}") from error
    return full, geometry


def _check_chain(model: Any, params: ArmParams) -> None:
    if tuple(model.names)[1:] != params.joint_names:
        raise ArmModelError(
            f"joint_names = {params.joint_names}: the order along the chain is {tuple(model.names)[1:]}"
        )
    for i in range(1, model.njoints):
        if model.parents[i] != i - 1:
            raise ArmModelError(f"'{model.names[i]}' does not follow '{model.names[i - 1]}': the arm must be one chain")
        if model.joints[i].nq != 1:
            raise ArmModelError(f"'{model.names[i]}' is continuous: an arm joint needs position limits")
    if model.frames[model.getFrameId(params.base_link)].parentJoint != 0:
        raise ArmModelError(f"base_link '{params.base_link}' moves with the arm")
    if model.frames[model.getFrameId(params.tip_link)].parentJoint != model.njoints - 1:
        raise ArmModelError(f"tip_link '{params.tip_link}' is not carried by '{params.joint_names[-1]}'")


def _check_links(model: Any, params: ArmParams) -> None:
    for name in [n for pair in params.ignored_link_pairs for n in pair] + list(params.ground_contact_links):
        if not model.existFrame(name):
            raise ArmModelError(f"ignored_link_pairs or ground_contact_links: '{name}' is not a link of the URDF")


def _check_limits(arm: ArmModel, params: ArmParams, urdf_velocity: FloatArray) -> None:
    for i, name in enumerate(arm.joint_names):
        if not (np.isfinite(arm.lower[i]) and np.isfinite(arm.upper[i]) and arm.lower[i] < arm.upper[i]):
            raise InvalidValueError(f"limits of {name}", (arm.lower[i], arm.upper[i]), "finite, lower below upper")
        if arm.max_velocity[i] > urdf_velocity[i] * (1.0 + 1e-9):
            raise InvalidValueError(
                f"max_velocity of {name}", arm.max_velocity[i], f"at most the URDF's {urdf_velocity[i]:.4g}"
            )
        for pose, values in params.named_poses.items():
            if not arm.lower[i] - 1e-9 <= values[i] <= arm.upper[i] + 1e-9:
                raise InvalidValueError(
                    f"named_poses.{pose} of {name}",
                    values[i],
                    f"{arm.lower[i]:.4f} to {arm.upper[i]:.4f} (URDF)",
                )


def _radius(shape: Any) -> float:
    shape.geometry.computeLocalAABB()
    return float(shape.geometry.aabb_radius + np.linalg.norm(shape.geometry.aabb_center))


def _reach(model: Any, shapes: Any) -> FloatArray:
    """Bound (shapes, n) of how far a point of each shape is from joint i, whatever the posture [m].

    Zero for joints that do not move the shape; one for prismatic joints (metre per metre).
    """
    count = model.njoints - 1
    prismatic = [
        np.linalg.norm(np.array(model.joints[i].createData().S).reshape(6)[3:]) < 0.5 for i in range(1, count + 1)
    ]
    hop = np.zeros(count)
    for i in range(count):
        hop[i] = np.linalg.norm(model.jointPlacements[i + 1].translation)
        if prismatic[i]:
            hop[i] += max(abs(model.lowerPositionLimit[i]), abs(model.upperPositionLimit[i]))
    reach = np.zeros((len(shapes.geometryObjects), count))
    for k, shape in enumerate(shapes.geometryObjects):
        distance = float(np.linalg.norm(shape.placement.translation)) + _radius(shape)
        for i in range(int(shape.parentJoint) - 1, -1, -1):
            reach[k, i] = 1.0 if prismatic[i] else distance
            distance += hop[i]
    return reach


def _pair_reach(shapes: Any, reach: FloatArray) -> FloatArray:
    """Bound (pairs, n) for the relative motion: only joints between the two shapes count."""
    rows = []
    for pair in shapes.collisionPairs:
        joints = [int(shapes.geometryObjects[index].parentJoint) for index in (pair.first, pair.second)]
        outer = pair.first if joints[0] >= joints[1] else pair.second
        row = reach[outer].copy()
        row[: min(joints)] = 0.0
        rows.append(row)
    return np.array(rows).reshape(-1, reach.shape[1])
