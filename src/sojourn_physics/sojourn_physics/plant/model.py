"""A machine on its ground, ready to be stepped: multibody, tables for the kernels, working memory.

Rigid-body dynamics by Pinocchio (Carpentier et al. 2019, IEEE/SICE SII) on a free-flying base. Couplings
between joints (rocker differential) are linear constraints on the rates, solved with multipliers:

    [M + dt B   Aᵀ] [ q̈ ]   [τ - h + τ_contact]
    [A          0 ] [-λ ] = [ -A q̇/dt - 0.1 A q/dt² ]

(Featherstone 2008, Rigid Body Dynamics Algorithms, ch. 8). The right side of the constraint brings both the
rate and the drift of the closed loop back to zero. B holds the slopes of the joint torques (see
`joint_drive`).

A base that is fixed (an arm on a stand) has six more rows, A = [1 0] on its own six rates: -λ is then the wrench on
the foundation, and the state of every machine has one form.
"""

import copy
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sojourn_machine.contact_report import REPORT_COLUMNS
from sojourn_machine.drives import SeriesMotorParams
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import MachineParams
from sojourn_machine.params import FloatArray, IntArray
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.loads import BusParams
from sojourn_machine.tools import ObjectParams, ToolParams
from sojourn_physics.actuators import drive_condition, joint_drive
from sojourn_physics.contact.soil_needs import needs_of_soil
from sojourn_physics.contact.support_tables import support_tables
from sojourn_physics.plant.params import SimulationParams
from sojourn_physics.plant.tools.mounted_tool import MountedTool, with_tool
from sojourn_physics.plant.working_memory import WorkingMemory
from sojourn_physics.plant.wrist import WristLoad
from sojourn_physics.soil.params import SoilParams, kernel_table
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.memory import GroundMemory, MemoryBoard

PLACEMENT_SIZE = 12
BASE_RATES = 6
STIFFEST_SPRING = 0.3
"""Largest angular frequency of a spring and what hangs on it, times the physics step [-]."""


@dataclass(frozen=True, slots=True)
class JointTables:
    """Joints with one degree of freedom, as arrays for the kernels; (joints, ...)."""

    names: tuple[str, ...]
    parameters: FloatArray
    kinds: IntArray
    columns: IntArray
    loads: IntArray
    armature: FloatArray
    """(nv,) reflected rotor inertia of motors that turn as one with their joints [kg m^2]."""
    rotors: FloatArray
    """(joints,) reflected rotor inertia of motors behind a gear with play [kg m^2]."""

    def tables(self, parameters: FloatArray) -> joint_drive.Joints:
        """For the kernels, with the parameters as they are now."""
        return joint_drive.Joints(parameters, self.kinds, self.columns, self.loads)


class Site(NamedTuple):
    """Where a machine is."""

    terrain: HeightField
    soils: Sequence[SoilParams]
    """Those that the terrain names, in any order."""
    gravity: float
    """[m/s^2]"""
    memory_cell: float = 0.0
    """Distance of the nodes at which the ground remembers wheels [m]; 0: it does not."""
    objects: Sequence[ObjectParams] = ()
    """That lie about, for a gripper."""


class PlantModel:
    """Fixed part of the plant. Its working memory makes it unfit for two threads; make one model for each.

    Args:
        urdf_xml: text of the machine's URDF.
        machine: what the URDF does not say.
        site: where it is.
        battery, bus: energy supply and its loads.
        simulation: steps.
        tool: at the end of the machine's arm, or none.

    Raises:
        InvalidValueError: a joint or link that the URDF does not have, a drive or tool whose load the bus does not
            have, a tool whose pad the machine does not have, a soil that is missing or lacks what the contact model
            of a wheel needs.
    """

    def __init__(
        self,
        urdf_xml: str,
        machine: MachineParams,
        site: Site,
        battery: BatteryParams,
        bus: BusParams,
        simulation: SimulationParams | None = None,
        tool: ToolParams | None = None,
    ) -> None:
        gravity, terrain = site.gravity, site.terrain
        self.machine = machine = with_tool(machine, tool)
        self.terrain = terrain
        self.battery = battery
        self.bus = bus
        self.simulation = simulation or SimulationParams()
        self.gravity = gravity
        self.multibody = pin.buildModelFromXML(urdf_xml, pin.JointModelFreeFlyer())
        self.multibody.gravity.linear = np.array([0.0, 0.0, -gravity])
        self.mass = float(sum(inertia.mass for inertia in self.multibody.inertias))
        self.joints = self._joint_tables(machine, bus)
        self.joint_index = {name: index for index, name in enumerate(self.joints.names)}
        self.coupling = self._coupling_rows(machine)
        by_name = {soil.name: soil for soil in site.soils}
        for name in terrain.soil_names:
            if name not in by_name:
                raise InvalidValueError("soil of the terrain", name, "one of " + ", ".join(sorted(by_name)))
        ground = [by_name[name] for name in terrain.soil_names]
        _check_ground(machine, ground)
        self.soils = kernel_table(ground)
        self.supports = support_tables(self.multibody, machine, ground, gravity)
        self.wrist: WristLoad | None = None
        if machine.wrench_sensor_link is not None:
            self.wrist = WristLoad(self.multibody, machine.wrench_sensor_link, self.supports.bodies)
        self.grid = terrain.grid
        self.untouched_ground = GroundMemory(site.memory_cell, terrain.origin_x, terrain.origin_y)
        self.memory = MemoryBoard(self.untouched_ground)
        self.tool = None if tool is None else MountedTool(self, tool, ground, site.objects)
        self.roll_over_cosine = float(np.cos(np.radians(machine.roll_over_tilt_deg)))
        self._make_workspace()
        self._check_springs()

    def variant(
        self,
        simulation: SimulationParams | None = None,
        terrain: HeightField | None = None,
        memory_cell: float | None = None,
    ) -> "PlantModel":
        """The same machine, stepped in another way, on a ground of the same soils, or on one that remembers otherwise;
        None: as here. It shares the multibody with this one: step them in turn.
        """
        other = copy.copy(self)
        if simulation is not None:
            other.simulation = simulation
        if terrain is not None:
            other.terrain, other.grid = terrain, terrain.grid
        if memory_cell is not None:
            other.untouched_ground = replace(self.untouched_ground, cell=memory_cell)
            other.memory = MemoryBoard(other.untouched_ground)
        other.work = WorkingMemory(other)
        return other

    @property
    def wheel_names(self) -> tuple[str, ...]:
        """Names of the wheels, in the order of the report."""
        return tuple(wheel.name for wheel in self.machine.wheels)

    def reference_rows(self, names: Sequence[str]) -> IntArray:
        """Columns of a command's reference for joints by name.

        Raises:
            InvalidValueError: an unknown name.
        """
        return np.array([self._index_of(name) for name in names], dtype=np.int64)

    def _index_of(self, joint: str) -> int:
        if joint not in self.joint_index:
            raise InvalidValueError("joint", joint, "one of " + ", ".join(self.joints.names))
        return self.joint_index[joint]

    def _joint_tables(self, machine: MachineParams, bus: BusParams) -> JointTables:
        model = self.multibody
        drives = {joint: drive for drive in machine.drives for joint in drive.joints}
        springs = {joint: suspension for suspension in machine.suspensions for joint in suspension.joints}
        load_names = [load.name for load in bus.loads]
        identifiers = range(2, model.njoints)
        names = tuple(model.names[i] for i in identifiers)
        for joint in (*drives, *springs):
            if joint not in names:
                raise InvalidValueError("joint of a drive or a spring", joint, "one of " + ", ".join(names))
        parameters = np.zeros((len(names), joint_drive.JOINT_COLUMNS))
        kinds = np.zeros(len(names), dtype=np.int64)
        loads = np.zeros(len(names), dtype=np.int64)
        columns = np.zeros(len(names), dtype=np.int64)
        armature = np.zeros(model.nv)
        rotors = np.zeros(len(names))
        for i, name in zip(range(len(names)), names, strict=True):
            joint = model.joints[i + 2]
            if joint.nv != 1:
                raise InvalidValueError(f"degrees of freedom of {name}", joint.nv, "1")
            columns[i] = joint.idx_v
            row = parameters[i]
            turns = joint.nq == 2  # a continuous joint is a point on a circle, and has no stops
            row[joint_drive.LOWER] = -np.inf if turns else model.lowerPositionLimit[joint.idx_q]
            row[joint_drive.UPPER] = np.inf if turns else model.upperPositionLimit[joint.idx_q]
            row[joint_drive.STOP_STIFFNESS] = machine.stop_stiffness
            row[joint_drive.STOP_DAMPING] = machine.stop_damping
            row[joint_drive.EFFICIENCY] = 1.0
            row[joint_drive.FRICTION] = machine.passive_joint.friction_torque
            row[joint_drive.VISCOUS] = machine.passive_joint.viscous_friction
            spring = springs.get(name)
            if spring is not None:
                row[joint_drive.SPRING_STIFFNESS] = spring.stiffness
                row[joint_drive.SPRING_REST] = spring.rest
                row[joint_drive.VISCOUS] += spring.damping
            drive = drives.get(name)
            if drive is None:
                continue
            if drive.load not in load_names:
                raise InvalidValueError(f"load of the drive of {name}", drive.load, "one of " + ", ".join(load_names))
            kinds[i] = joint_drive.RATE if drive.servo.mode == "rate" else joint_drive.POSITION
            loads[i] = load_names.index(drive.load)
            if drive.screw is not None and not joint.shortname().startswith("JointModelP"):
                raise InvalidValueError(f"screw of the drive of {name}", joint.shortname(), "a joint that slides")
            motor, gear = drive.electric, drive.transmission
            row[joint_drive.RATIO] = gear.ratio
            if isinstance(motor, SeriesMotorParams):
                row[joint_drive.TORQUE_CONSTANT] = motor.field_constant
                row[joint_drive.RESISTANCE] = motor.series_resistance
                row[joint_drive.SATURATION] = motor.saturation_current
            else:
                row[joint_drive.TORQUE_CONSTANT] = motor.torque_constant
                row[joint_drive.RESISTANCE] = motor.resistance
            row[joint_drive.MAX_CURRENT] = motor.max_current
            row[joint_drive.EFFICIENCY] = gear.efficiency
            if gear.back_efficiency is not None:
                row[joint_drive.BACK_LOSS] = 1.0 / gear.back_efficiency - 1.0 - (1.0 - gear.efficiency)
            row[joint_drive.FRICTION] = drive.friction_torque
            row[joint_drive.VISCOUS] = drive.viscous_friction
            row[joint_drive.PROPORTIONAL] = drive.servo.proportional
            row[joint_drive.INTEGRAL] = drive.servo.integral
            row[joint_drive.DERIVATIVE] = drive.servo.derivative
            row[joint_drive.MAX_TORQUE] = drive.servo.max_torque
            row[joint_drive.MAX_EFFORT] = model.effortLimit[joint.idx_v] or np.inf
            row[joint_drive.MAX_RATE] = model.velocityLimit[joint.idx_v] or np.inf
            row[joint_drive.ARMATURE] = drive.reflected_inertia
            if drive.play is None:
                armature[joint.idx_v] = drive.reflected_inertia
                continue
            rotors[i] = drive.reflected_inertia
            row[joint_drive.HALF_GAP] = 0.5 * drive.play.backlash
            row[joint_drive.TOOTH_STIFFNESS] = drive.play.stiffness
            row[joint_drive.TOOTH_DAMPING] = drive.play.damping
            row[joint_drive.BEARING_FRICTION] = drive.play.bearing_friction
            row[joint_drive.BEARING_VISCOUS] = drive.play.bearing_viscous
            row[joint_drive.SEES_JOINT] = float(drive.servo.encoder == "joint")
        warming = [drives.get(name) for name in names]
        self.conditions = drive_condition.conditions_of(warming, parameters)
        return JointTables(names, parameters, kinds, columns, loads, armature, rotors)

    def _check_springs(self) -> None:
        """Springs are integrated explicitly: each must swing slowly against the step, even if the base stood still."""
        inertia = np.diag(pin.crba(self.multibody, self.data, pin.neutral(self.multibody), pin.Convention.WORLD))
        for name, row, column in zip(self.joints.names, self.joints.parameters, self.joints.columns, strict=True):
            largest = (STIFFEST_SPRING / self.simulation.physics_step) ** 2 * inertia[column]
            if row[joint_drive.SPRING_STIFFNESS] > largest:
                stiffness = float(row[joint_drive.SPRING_STIFFNESS])
                allowed = f"at most {largest:.3g} for this physics_step and what hangs on the joint"
                raise InvalidValueError(f"stiffness of the spring of {name}", stiffness, allowed)

    def _coupling_rows(self, machine: MachineParams) -> FloatArray:
        """A of the constraint A q̇ = 0, shape (couplings, nv); of a fixed base (couplings + 6, nv)."""
        rows = np.zeros((len(machine.couplings) + BASE_RATES * machine.fixed_base, self.multibody.nv))
        if machine.fixed_base:
            rows[-BASE_RATES:, :BASE_RATES] = np.eye(BASE_RATES)
        for row, coupling in zip(rows, machine.couplings, strict=False):
            row[self.joints.columns[self._index_of(coupling.first)]] = 1.0
            row[self.joints.columns[self._index_of(coupling.second)]] = coupling.ratio
        return rows

    def _make_workspace(self) -> None:
        """Working memory, and views on Pinocchio's own, which stays in place as long as the model lives."""
        model = self.multibody
        self.data = model.createData()
        self.jacobian: FloatArray = self.data.J
        self.bias: FloatArray = self.data.nle
        self.mass_matrix: FloatArray = self.data.M
        # The placements lie one after another in memory: rotation (by columns) and position, 12 numbers each.
        # Read one by one through the binding they would cost as much as the dynamics.
        first = self.data.oMi[0].rotation.__array_interface__["data"][0]
        second = self.data.oMi[1].rotation.__array_interface__["data"][0]
        if second - first != PLACEMENT_SIZE * 8:
            raise InvalidValueError("stride of Pinocchio's placements", second - first, str(PLACEMENT_SIZE * 8))
        self.placements: FloatArray = np.lib.stride_tricks.as_strided(
            self.data.oMi[0].rotation.T.reshape(-1), (model.njoints, PLACEMENT_SIZE), (PLACEMENT_SIZE * 8, 8)
        )
        self.report = np.zeros((len(self.supports.names), REPORT_COLUMNS))
        self.efforts = np.zeros(len(self.joints.names))
        self.currents = np.zeros(len(self.joints.names))
        self.load_power = np.zeros(len(self.bus.loads))
        self.work = WorkingMemory(self)


def _check_ground(machine: MachineParams, ground: Sequence[SoilParams]) -> None:
    """Every support finds in every soil what its law needs."""
    for soil in ground:
        for support, law, missing in needs_of_soil(machine, soil):
            if missing:
                allowed = f"a soil with what {law} of {support} needs; missing: "
                raise InvalidValueError("soil", soil.name, allowed + ", ".join(missing))
