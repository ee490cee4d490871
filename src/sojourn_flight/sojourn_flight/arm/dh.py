"""Denavit-Hartenberg tables: what may stand in one, and the geometry that both conventions share.

Standard (Denavit & Hartenberg 1955; Paul 1981):   A_i = Rz(theta_i) Tz(d_i) Tx(a_i) Rx(alpha_i)
Modified (Khalil & Kleinfinger 1986; Craig 1989):  A_i = Rx(alpha_i-1) Tx(a_i-1) Rz(theta_i) Tz(d_i)
A joint's variable adds to theta (revolute) or to d (prismatic).

Written out along the chain, both are the same product; they cut it at different places:
    T = base  [Tx(a_0) Rx(alpha_0)]  Rz(theta_1) Tz(d_1)  [Tx(a_1) Rx(alpha_1)]  Rz(theta_2) Tz(d_2)  ...  tool.
So a standard table is one with a_0 = alpha_0 = 0 and a modified one has a_n = alpha_n = 0; what the other
convention has no column for goes into its base or its tool. `DhGeometry` holds the product.

Masses in a table are in frame i of its own convention, inertias about the centre of mass; motor figures are
those of the motor's shaft. Valid for serial chains of joints of one degree of freedom.
"""

import math
from dataclasses import dataclass
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from sojourn_machine.params import FloatArray, Params

Convention = Literal["standard", "modified"]
Length = Annotated[float, Field(ge=-1.0e3, le=1.0e3)]
Degrees = Annotated[float, Field(ge=-1.0e4, le=1.0e4)]
Vector = tuple[Length, Length, Length]


class DhMotor(Params):
    """Motor and gear of a joint. Torques and speeds at the motor's shaft; for a prismatic joint a metre of travel
    takes the place of a radian, so that gear_ratio is in rad/m."""

    rotor_inertia: float = Field(..., ge=0.0, le=1.0e4, description="of rotor and gear input [kg m2]")
    gear_ratio: float = Field(..., description="shaft per joint; its sign is the sense of turn [- or rad/m]")
    viscous_friction: float = Field(default=0.0, ge=0.0, description="[N m s/rad]")
    coulomb_friction: tuple[float, float] = Field(
        default=(0.0, 0.0), description="sliding friction of the joint's forward and backward motion, both >= 0 [N m]"
    )
    static_friction: float = Field(default=0.0, ge=0.0, description="breakaway above the Coulomb friction [N m]")
    stribeck_velocity: float = Field(
        default=0.01, gt=0.0, description="joint speed at which the breakaway has faded to 1/e [rad/s or m/s]"
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.gear_ratio == 0.0 or min(self.coulomb_friction) < 0.0:
            raise ValueError("allowed is a gear_ratio other than 0 and coulomb_friction of at least 0")
        return self


class DhTube(Params):
    """A cylinder from one point to another: a part of a body's shape."""

    start: Vector = Field(..., description="middle of one end [m]")
    end: Vector = Field(..., description="middle of the other end [m]")
    radius: float = Field(..., gt=0.0, le=100.0, description="[m]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if math.dist(self.start, self.end) < 1.0e-6:
            raise ValueError(f"start and end are both {self.start}: allowed are two places")
        return self


class DhLink(Params):
    """The body that a joint moves."""

    mass: float = Field(default=0.0, ge=0.0, le=1.0e6, description="[kg]")
    com: Vector = Field(default=(0.0, 0.0, 0.0), description="centre of mass in frame i [m]")
    inertia: tuple[float, float, float, float, float, float] = Field(
        default=(0.0,) * 6, description="ixx iyy izz ixy iyz ixz about the centre of mass, axes of frame i [kg m2]"
    )
    radius: float = Field(
        default=0.0, ge=0.0, le=100.0, description="of a tube along its length a, as its shape [m]; 0: none"
    )
    tubes: tuple[DhTube, ...] = Field(default=(), description="its shape, in frame i, beside that tube")


class DhJoint(Params):
    """One row of the table."""

    name: str = Field(default="", description="left out: joint_1, joint_2, ...")
    kind: Literal["revolute", "prismatic"] = "revolute"
    theta_deg: Degrees = Field(default=0.0, description="joint angle, or its offset [deg]")
    d: Length = Field(default=0.0, description="link offset, or its offset [m]")
    a: Length = Field(default=0.0, description="link length [m]: a_i (standard), a_i-1 (modified)")
    alpha_deg: Degrees = Field(default=0.0, description="link twist [deg]: alpha_i (standard), alpha_i-1 (modified)")
    lower: float | None = Field(default=None, description="lowest position [deg, or m]; left out: -180 deg")
    upper: float | None = Field(default=None, description="highest position [deg, or m]; left out: 180 deg")
    velocity: float | None = Field(default=None, gt=0.0, description="largest speed [rad/s or m/s]; left out: any")
    effort: float | None = Field(default=None, gt=0.0, description="largest torque [N m] or force [N]; left out: any")
    link: DhLink = DhLink()
    motor: DhMotor | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.kind == "prismatic" and (self.lower is None or self.upper is None):
            raise ValueError(f"{self.name}: lower and upper: a joint that slides needs both [m]")
        if not self.limits[0] < self.limits[1]:
            raise ValueError(f"{self.name}: lower = {self.lower}, upper = {self.upper}: allowed is lower below upper")
        return self

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest position [rad or m]."""
        low = -180.0 if self.lower is None else self.lower
        high = 180.0 if self.upper is None else self.upper
        return (low, high) if self.kind == "prismatic" else (math.radians(low), math.radians(high))


def _named(rows: tuple[DhJoint, ...]) -> tuple[DhJoint, ...]:
    """Rows with a name each."""
    return tuple(row if row.name else row.model_copy(update={"name": f"joint_{i + 1}"}) for i, row in enumerate(rows))


class DhTable(Params):
    """An arm as a Denavit-Hartenberg table."""

    name: str = Field(..., pattern=r"[A-Za-z][A-Za-z0-9_]*")
    convention: Convention
    base_xyz: Vector = (0.0, 0.0, 0.0)
    base_rpy_deg: tuple[Degrees, Degrees, Degrees] = (0.0, 0.0, 0.0)
    base_tubes: tuple[DhTube, ...] = Field(default=(), description="shape of what carries the arm, in the base's frame")
    tool_xyz: Vector = (0.0, 0.0, 0.0)
    tool_rpy_deg: tuple[Degrees, Degrees, Degrees] = (0.0, 0.0, 0.0)
    joints: Annotated[tuple[DhJoint, ...], AfterValidator(_named)] = Field(..., min_length=1, max_length=20)

    @model_validator(mode="after")
    def _check(self) -> Self:
        names = [joint.name for joint in self.joints]
        if len(set(names)) != len(names):
            raise ValueError(f"joints: a name is there twice in {names}")
        return self


@dataclass(frozen=True, slots=True, eq=False)
class DhGeometry:
    """The product of the module header for n joints."""

    revolute: tuple[bool, ...]
    theta: FloatArray  # (n,) [rad]
    d: FloatArray  # (n,) [m]
    a: FloatArray  # (n+1,) a_0 to a_n [m]
    alpha: FloatArray  # (n+1,) alpha_0 to alpha_n [rad]
    base: FloatArray  # (4, 4) frame 0 in the base
    tool: FloatArray  # (4, 4) tip in frame n


def geometry_of(table: DhTable) -> DhGeometry:
    """Geometry of a table, in its own convention."""
    rows = table.joints
    before = [0.0] if table.convention == "standard" else []
    after = [] if table.convention == "standard" else [0.0]
    return DhGeometry(
        revolute=tuple(row.kind == "revolute" for row in rows),
        theta=np.radians([row.theta_deg for row in rows]),
        d=np.array([row.d for row in rows]),
        a=np.array([*before, *(row.a for row in rows), *after]),
        alpha=np.radians([*before, *(row.alpha_deg for row in rows), *after]),
        base=pose(table.base_xyz, np.radians(table.base_rpy_deg)),
        tool=pose(table.tool_xyz, np.radians(table.tool_rpy_deg)),
    )


def in_convention(geometry: DhGeometry, convention: Convention) -> DhGeometry:
    """The same arm with the columns of a convention: what it has no column for is put into base or tool."""
    a, alpha = geometry.a.copy(), geometry.alpha.copy()
    base, tool = geometry.base, geometry.tool
    if convention == "standard":
        base = base @ twist(a[0], alpha[0])
        a[0] = alpha[0] = 0.0
    else:
        tool = twist(a[-1], alpha[-1]) @ tool
        a[-1] = alpha[-1] = 0.0
    return DhGeometry(geometry.revolute, geometry.theta, geometry.d, a, alpha, base, tool)


def twist(a: float, alpha: float) -> FloatArray:
    """Tx(a) Rx(alpha), (4, 4)."""
    c, s = _cosine_sine(alpha)
    return np.array([[1.0, 0.0, 0.0, a], [0.0, c, -s, 0.0], [0.0, s, c, 0.0], [0.0, 0.0, 0.0, 1.0]])


def screw(theta: float, d: float) -> FloatArray:
    """Rz(theta) Tz(d), (4, 4)."""
    c, s = _cosine_sine(theta)
    return np.array([[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, d], [0.0, 0.0, 0.0, 1.0]])


def pose(xyz: tuple[float, float, float], rpy: FloatArray) -> FloatArray:
    """Transform (4, 4) of a place [m] and roll, pitch, yaw about fixed axes [rad], as URDF counts them."""
    roll, pitch, yaw = twist(0.0, float(rpy[0])), np.eye(4), screw(float(rpy[2]), 0.0)
    c, s = _cosine_sine(float(rpy[1]))
    pitch[0, 0], pitch[0, 2], pitch[2, 0], pitch[2, 2] = c, s, -s, c
    transform = yaw @ pitch @ roll
    transform[:3, 3] = xyz
    return np.asarray(transform, dtype=np.float64)


def _cosine_sine(angle: float) -> tuple[float, float]:
    """Cosine and sine, exact at multiples of a right angle: tables are full of them."""
    quarter = round(angle / (0.5 * math.pi))
    if abs(angle - quarter * 0.5 * math.pi) < 1e-12:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[quarter % 4]
    return math.cos(angle), math.sin(angle)
