"""Any serial arm, cut out of a URDF: geometry in arrays, rigid bodies, limits, motors and friction.

The arm is the line of joints from `base_link` to `tip_link`; every other joint of the machine is locked at zero. The
model is re-based: its universe frame is `base_link`. A continuous joint gets limits of one turn to either side; speed
and effort that are not given (or 0) are without limit.

Motors: the inertia of a rotor is felt at the joint as J_m G^2 and added to the diagonal of the mass matrix
(Corke & Armstrong-Helouvry, ICRA 1994); the gyroscopic torques of the rotors are left out, as usual for G >> 1.

Not thread-safe: `data` is scratch memory of Pinocchio that every call overwrites; it carries no state.
"""

import dataclasses
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio

from sojourn_flight.arm.chain import Chain, stretched_length
from sojourn_flight.arm.collision_pairs import add_collision_pairs, rebase_shapes
from sojourn_flight.arm.friction import JointFriction
from sojourn_flight.arm.urdf_chain import UNLIMITED, ArmModelError, read_chain
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class SerialArm:
    """An arm of n joints. Arrays are in chain order; do not write to them."""

    name: str
    joint_names: tuple[str, ...]
    base_link: str
    tip_link: str
    chain: Chain
    lower: FloatArray  # (n,) [rad or m]
    upper: FloatArray  # (n,) [rad or m]
    max_velocity: FloatArray  # (n,) [rad/s or m/s]
    max_effort: FloatArray  # (n,) [N m or N]
    motor_inertia: FloatArray  # (n,) rotor inertia at the joint, J_m G^2 [kg m2 or kg]
    friction: JointFriction
    pinocchio_model: Any
    data: Any
    shapes: Any  # Pinocchio geometry model of the primitive shapes, with the pairs that may collide

    @property
    def joint_count(self) -> int:
        """Number of joints [-]."""
        return len(self.joint_names)

    @property
    def revolute(self) -> tuple[bool, ...]:
        """Whether each joint turns (or else slides)."""
        return tuple(bool(flag > 0.5) for flag in self.chain.revolute)

    @property
    def reach(self) -> float:
        """Length of the chain stretched out, without what lies before its first joint [m]; 1 where it has none."""
        return stretched_length(self.chain, self.lower, self.upper)


def build_serial_arm(
    urdf_xml: str,
    base_link: str | None = None,
    tip_link: str | None = None,
    tool_axis: tuple[float, float, float] = (0.0, 0.0, 1.0),
    ignored_pairs: Collection[frozenset[str]] = (),
) -> SerialArm:
    """The arm between two links of a URDF.

    Args:
        urdf_xml: the XML itself, not a path.
        base_link: link that carries the arm; the outermost one if left out.
        tip_link: link at the arm's end; if left out, the end of the longest line of joints.
        tool_axis: unit vector in the tip frame that points.
        ignored_pairs: names of links that may overlap.

    Raises:
        ArmModelError: malformed XML, no such link, no moving joint between them.
    """
    line = read_chain(urdf_xml, base_link, tip_link)
    try:
        full = pinocchio.buildModelFromXML(line.urdf_xml)
        geometry = pinocchio.buildGeomFromUrdfString(full, line.urdf_xml, pinocchio.GeometryType.COLLISION)
    except (ValueError, RuntimeError) as error:
        raise ArmModelError(f"the URDF could not be read: {error}") from error
    locked = [i for i in range(1, full.njoints) if full.names[i] not in line.joint_names]
    model, shapes = pinocchio.buildReducedModel(full, geometry, locked, pinocchio.neutral(full))
    rebase_shapes(model, shapes, line.base_link)
    add_collision_pairs(model, shapes, ignored_pairs)
    rebase(model, line.base_link)
    model.armature = np.array(line.motor_inertia)
    return SerialArm(
        name=line.name,
        joint_names=line.joint_names,
        base_link=line.base_link,
        tip_link=line.tip_link,
        chain=chain_of(model, line.tip_link, tool_axis),
        lower=np.array(model.lowerPositionLimit),
        upper=np.array(model.upperPositionLimit),
        max_velocity=_unlimited(model.upperVelocityLimit),
        max_effort=_unlimited(model.upperEffortLimit),
        motor_inertia=np.array(line.motor_inertia),
        friction=line.friction,
        pinocchio_model=model,
        data=model.createData(),
        shapes=shapes,
    )


def _unlimited(limits: FloatArray) -> FloatArray:
    """Limits with what stands for none made infinite."""
    return np.where(np.asarray(limits) < 0.5 * UNLIMITED, limits, np.inf)


def with_payload(
    arm: SerialArm,
    mass: float,
    com_in_tip: tuple[float, float, float] = (0.0, 0.0, 0.0),
    inertia: FloatArray | None = None,
) -> SerialArm:
    """The same arm holding a body at its tip.

    Args:
        mass: [kg]. com_in_tip: its centre of mass in the tip frame [m].
        inertia: about that centre, in the axes of the tip frame (3, 3) [kg m2]; None for a point mass.
    """
    if not (np.isfinite(mass) and mass >= 0.0 and np.all(np.isfinite(com_in_tip))):
        raise InvalidValueError("payload", (mass, com_in_tip), "a finite mass of at least 0 kg and a finite place")
    model = arm.pinocchio_model.copy()
    body = pinocchio.Inertia(mass, np.array(com_in_tip), np.zeros((3, 3)) if inertia is None else inertia)
    tip = pinocchio.SE3(arm.chain.tip_rotation, arm.chain.tip_translation)
    model.inertias[model.njoints - 1] = model.inertias[model.njoints - 1] + tip.act(body)
    return dataclasses.replace(arm, pinocchio_model=model, data=model.createData())


def with_scaled_masses(arm: SerialArm, factors: FloatArray) -> SerialArm:
    """The same arm with the mass and inertia of each link times a factor (n,): a model that is wrong."""
    model = arm.pinocchio_model.copy()
    for i, factor in enumerate(factors):
        body = model.inertias[i + 1]
        model.inertias[i + 1] = pinocchio.Inertia(body.mass * factor, body.lever, body.inertia * factor)
    return dataclasses.replace(arm, pinocchio_model=model, data=model.createData())


def with_motors(arm: SerialArm, motor_inertia: FloatArray, friction: JointFriction) -> SerialArm:
    """The same arm with other motors: inertia at the joint (n,) [kg m2 or kg], and friction."""
    model = arm.pinocchio_model.copy()
    model.armature = motor_inertia
    return dataclasses.replace(
        arm, motor_inertia=motor_inertia, friction=friction, pinocchio_model=model, data=model.createData()
    )


def rebase(model: Any, base_link: str) -> None:
    """Make a link that no joint moves the universe frame of a Pinocchio model."""
    universe_to_base = model.frames[model.getFrameId(base_link)].placement.inverse()
    model.jointPlacements[1] = universe_to_base * model.jointPlacements[1]
    for frame in model.frames:
        if frame.parentJoint == 0:
            frame.placement = universe_to_base * frame.placement


def chain_of(model: Any, tip_link: str, tool_axis: tuple[float, float, float]) -> Chain:
    """Geometry in arrays of a Pinocchio model that is one chain."""
    joints = range(1, model.njoints)
    subspaces = [np.array(model.joints[i].createData().S).reshape(6) for i in joints]
    revolute = np.array([float(np.linalg.norm(s[3:]) > 0.5) for s in subspaces])
    tip = model.frames[model.getFrameId(tip_link)].placement
    return Chain(
        rotation=np.array([model.jointPlacements[i].rotation for i in joints]),
        translation=np.array([model.jointPlacements[i].translation for i in joints]),
        axis=np.array([s[3:] if r > 0.5 else s[:3] for s, r in zip(subspaces, revolute, strict=True)]),
        revolute=revolute,
        tip_rotation=np.ascontiguousarray(tip.rotation),
        tip_translation=np.array(tip.translation),
        tool_axis=np.array(tool_axis),
    )
