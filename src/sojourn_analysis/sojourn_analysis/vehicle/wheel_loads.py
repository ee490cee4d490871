"""Static forces on the wheels of any machine, on any ground: equalising suspensions and hyperstatic ones alike.

Machine: URDF with passive joints (rockers, bogies) and couplings A q' = 0 (differential); motors hold all others, and
springs stay where they are: what they give counts as compliance of their wheels. Z spans the motions that are left
free, base and passive joints. With the Jacobian J of the contact points and gravity g(q), statics is

    Z^T J^T f = Z^T g(q)                     (principle of virtual work)

and the forces f are, among all that do so, those of least complementary energy (Castigliano; Menabrea 1858):

    min  sum_i c_i f_i^2/2 + sum_i d_i N_i,     N_i >= 0

c compliance of wheel and ground at the contact, far larger along the ground than along its normal, so that wheels do
not push against one another more than the balance needs (what a parked machine has locked in is its history), d gap of
the unloaded wheel over the ground. A rocker-bogie on six wheels has as many equations as normal forces: they do not
depend on c nor, pose apart, on the ground (equalising). Four wheels on a rigid body are hyperstatic: c and d decide. A
wheel that would pull is lifted and the rest solved again.

Pose: the free motions are such that every wheel touches: [(p_i - ground) n_i] = r_i, in the least squares of the gaps
where there are more wheels than motions.
(Genta and Genta 2017, sec. 5.3; Lindemann and Voorhees 2005.) Assumptions: point contacts straight below the wheel's
centre along the normal of the ground, exact on planes; small compliance; frictionless passive joints; at rest.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple, TypeAlias

import numpy as np
import pinocchio as pin
from scipy.linalg import null_space
from scipy.optimize import least_squares

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import MachineParams
from sojourn_machine.params import FloatArray
from sojourn_machine.rotations import quaternion_of

Ground: TypeAlias = Callable[[float, float], float]
"""Height of the ground [m] at x, y [m]."""
SLOPE_STEP = 1e-4
"""For the ground's slope by differences [m]."""
COMPLIANCE = 1e-6
"""Of a contact along its normal where nothing else is said [m/N]."""
SOFTER_ALONG = 1e5
"""Compliance along the ground over the one along the normal."""


class Stance(NamedTuple):
    """A machine standing: configuration (nq,), contact points and normals of the wheels (wheels, 3), gaps (wheels,)
    [m].
    """

    configuration: FloatArray
    contacts: FloatArray
    normals: FloatArray
    gaps: FloatArray


class WheelLoads(NamedTuple):
    """Forces of the ground: vectors in the world (wheels, 3), normal and tangential parts (wheels,) [N]."""

    forces: FloatArray
    normal: FloatArray
    tangential: FloatArray


class StandingMachine:
    """A machine of a URDF, for statics.

    Args:
        urdf_xml: text of the URDF. machine: wheels, drives and couplings. gravity: [m/s^2].
    """

    def __init__(self, urdf_xml: str, machine: MachineParams, gravity: float) -> None:
        self.model = pin.buildModelFromXML(urdf_xml, pin.JointModelFreeFlyer())
        self.model.gravity.linear = np.array([0.0, 0.0, -gravity])
        self.data = self.model.createData()
        self.machine = machine
        self.gravity = gravity
        self.mass = float(sum(inertia.mass for inertia in self.model.inertias))
        self.wheels = [self._joint(wheel.joint) for wheel in machine.wheels]
        self.radii = np.array([wheel.radius for wheel in machine.wheels])
        driven = {name for drive in machine.drives for name in drive.joints}
        self.sprung = {joint: spring for spring in machine.suspensions for joint in spring.joints}
        self.passive = tuple(
            name for name in list(self.model.names)[2:] if name not in driven and name not in self.sprung
        )
        self.free = self._free_motions()

    def stand(
        self,
        ground: Ground,
        x: float = 0.0,
        y: float = 0.0,
        yaw: float = 0.0,
        angles: Mapping[str, float] | None = None,
    ) -> Stance:
        """The pose on a ground with base_link over (x, y) and a heading.

        Args:
            ground: height at a place. angles: of driven joints with limits, by name; the others are at 0 [rad].

        Raises:
            InvalidValueError: no pose was found.
        """
        start = self.posture(angles)
        start[:2] = x, y
        start[3:7] = quaternion_of(pin.rpy.rpyToMatrix(0.0, 0.0, yaw))
        lowest = min(self._places(start)[:, 2] - self.radii)
        start[2] = ground(x, y) - lowest
        # turn about the heading and slide along the ground stay as asked: heave, roll, pitch, passive joints are free
        motions = self.free[:, [2, 3, 4, *range(6, self.free.shape[1])]]

        def gaps(amount: FloatArray) -> FloatArray:
            return self._gaps(self._moved(start, motions @ amount), ground)[2]

        found = least_squares(gaps, np.zeros(motions.shape[1]), xtol=1e-14, ftol=1e-14, gtol=1e-14)
        if not found.success:
            raise InvalidValueError("ground", "as given", "one on which the machine can stand")
        configuration = self._moved(start, motions @ found.x)
        contacts, normals, left = self._gaps(configuration, ground)
        return Stance(configuration, contacts, normals, left)

    def posture(self, angles: Mapping[str, float] | None = None) -> FloatArray:
        """Configuration (nq,) with base_link level at the origin; angles as in `stand`."""
        configuration = np.array(pin.neutral(self.model))
        for name, angle in (angles or {}).items():
            configuration[self.model.joints[self._joint(name)].idx_q] = angle
        return configuration

    def place(self, link: str, position: tuple[float, float, float]) -> FloatArray:
        """Of a point of a link, in the world at the last kinematics, shape (3,) [m]."""
        frame = self.model.frames[self.model.getFrameId(link)]
        return np.array(self.data.oMi[frame.parentJoint].act(frame.placement.act(np.array(position))))

    def loads(self, stance: Stance, compliance: FloatArray | float | None = None) -> WheelLoads:
        """Forces on the wheels at rest.

        Args:
            compliance: of each contact, wheel and suspension together [m/N], (wheels,) or one for all; if left out,
                that of a stiff wheel on the springs of the machine.

        Raises:
            InvalidValueError: no forces hold the machine: it falls over.
        """
        count = len(self.wheels)
        given = COMPLIANCE + self.spring_compliance(stance) if compliance is None else compliance
        softness = np.broadcast_to(np.asarray(given, dtype=np.float64), (count,))
        gravity = pin.computeGeneralizedGravity(self.model, self.data, stance.configuration)
        frames = [_frame(normal) for normal in stance.normals]
        rows = np.concatenate([self._jacobian(stance, wheel, frame) for wheel, frame in enumerate(frames)])
        matrix, right = self.free.T @ rows.T, self.free.T @ gravity
        stiffness = np.repeat(1.0 / softness, 3)
        stiffness[0::3] /= SOFTER_ALONG
        stiffness[1::3] /= SOFTER_ALONG
        gap = np.zeros(3 * count)
        gap[2::3] = stance.gaps
        found = least_energy_forces(matrix, right, stiffness, gap)
        local = found.reshape(count, 3)
        forces = np.array([frame.T @ force for frame, force in zip(frames, local, strict=True)])
        return WheelLoads(forces, local[:, 2].copy(), np.hypot(local[:, 0], local[:, 1]))

    def spring_compliance(self, stance: Stance) -> FloatArray:
        """Of the springs, as each wheel's centre feels it upwards: sum (dz/dq)^2/k, (wheels,) [m/N]; 0 without."""
        pin.computeJointJacobians(self.model, self.data, stance.configuration)
        total = np.zeros(len(self.wheels))
        for number, wheel in enumerate(self.wheels):
            lift = pin.getJointJacobian(self.model, self.data, wheel, pin.LOCAL_WORLD_ALIGNED)[2]
            for name in self.sprung:
                column = self.model.joints[self._joint(name)].idx_v
                total[number] += float(lift[column]) ** 2 / self.sprung[name].stiffness
        return total

    def centre_of_mass(self, configuration: FloatArray) -> FloatArray:
        """In the world, shape (3,) [m]."""
        return np.array(pin.centerOfMass(self.model, self.data, configuration))

    def _joint(self, name: str) -> int:
        if not self.model.existJointName(name):
            raise InvalidValueError("joint", name, "one of " + ", ".join(list(self.model.names)[2:]))
        return int(self.model.getJointId(name))

    def _free_motions(self) -> FloatArray:
        """Z, shape (nv, free motions): six of the base, then those of the passive joints that the couplings leave."""
        columns = [self.model.joints[self._joint(name)].idx_v for name in self.passive]
        rows = np.zeros((len(self.machine.couplings), len(columns)))
        for row, coupling in zip(rows, self.machine.couplings, strict=True):
            row[self.passive.index(coupling.first)] = 1.0
            row[self.passive.index(coupling.second)] = coupling.ratio
        left = null_space(rows) if len(rows) else np.eye(len(columns))
        free = np.zeros((self.model.nv, 6 + left.shape[1]))
        free[:6, :6] = np.eye(6)
        free[columns, 6:] = left
        return free

    def _moved(self, configuration: FloatArray, motion: FloatArray) -> FloatArray:
        return np.asarray(pin.integrate(self.model, configuration, motion))

    def _places(self, configuration: FloatArray) -> FloatArray:
        pin.forwardKinematics(self.model, self.data, configuration)
        return np.array([self.data.oMi[wheel].translation for wheel in self.wheels])

    def _gaps(self, configuration: FloatArray, ground: Ground) -> tuple[FloatArray, FloatArray, FloatArray]:
        places = self._places(configuration)
        normals = np.array([_normal(ground, float(p[0]), float(p[1])) for p in places])
        below = np.array([[0.0, 0.0, p[2] - ground(float(p[0]), float(p[1]))] for p in places])
        gaps = np.sum(below * normals, axis=1) - self.radii
        return places - self.radii[:, None] * normals, normals, gaps

    def _jacobian(self, stance: Stance, wheel: int, frame: FloatArray) -> FloatArray:
        """Rows (3, nv): velocity of the contact point along the contact's axes."""
        pin.computeJointJacobians(self.model, self.data, stance.configuration)
        jacobian = pin.getJointJacobian(self.model, self.data, self.wheels[wheel], pin.LOCAL_WORLD_ALIGNED)
        arm = stance.contacts[wheel] - self.data.oMi[self.wheels[wheel]].translation
        at_point = jacobian[:3] - pin.skew(arm) @ jacobian[3:]
        return np.asarray(frame @ at_point)


def least_energy_forces(matrix: FloatArray, right: FloatArray, stiffness: FloatArray, gap: FloatArray) -> FloatArray:
    """f of least complementary energy with matrix f = right; every third one is a normal force, at least 0.

    Args:
        matrix: (equations, 3 n). right: (equations,). stiffness: 1/c of each force, (3 n,). gap: d, (3 n,).

    Raises:
        InvalidValueError: no such forces hold.
    """
    active = np.ones(len(stiffness), dtype=bool)
    scale = float(np.abs(right).max()) or 1.0
    while active.any():
        part, soft = matrix[:, active], stiffness[active]
        middle = (part * soft) @ part.T
        multiplier = np.linalg.lstsq(middle, right + part @ (soft * gap[active]), rcond=1e-14)[0]
        force = soft * (part.T @ multiplier - gap[active])
        if np.abs(part @ force - right).max() > 1e-6 * scale:
            break
        found = np.zeros(len(stiffness))
        found[active] = force
        normal = found[2::3]
        if normal.min() >= -1e-9 * scale:
            return found
        worst = int(np.argmin(normal))
        active[3 * worst : 3 * worst + 3] = False
    raise InvalidValueError("pose", "as given", "one in which the ground can hold the machine")


def _normal(ground: Ground, x: float, y: float) -> FloatArray:
    slope_x = (ground(x + SLOPE_STEP, y) - ground(x - SLOPE_STEP, y)) / (2.0 * SLOPE_STEP)
    slope_y = (ground(x, y + SLOPE_STEP) - ground(x, y - SLOPE_STEP)) / (2.0 * SLOPE_STEP)
    normal = np.array([-slope_x, -slope_y, 1.0])
    return np.asarray(normal / np.linalg.norm(normal))


def _frame(normal: FloatArray) -> FloatArray:
    """Rows: two tangents and the normal, in the world."""
    first = np.cross([0.0, 1.0, 0.0], normal)
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(normal, first), normal])
