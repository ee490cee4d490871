"""A machine on its ground, ready to be stepped: multibody, tables for the kernels, working memory.

Rigid-body dynamics by Pinocchio (Carpentier et al. 2019, IEEE/SICE SII) on a free-flying base. Couplings
between joints (rocker differential) are linear constraints on the rates, solved with multipliers:

    [M + dt B   Aᵀ] [ q̈ ]   [τ - h + τ_contact]
    [A          0 ] [-λ ] = [ -A q̇/dt - 0.1 A q/dt² ]

(Featherstone 2008, Rigid Body Dynamics Algorithms, ch. 8). The right side of the constraint brings both the
rate and the drift of the closed loop back to zero. B holds the slopes of the joint torques (see
`joint_drive`).

A machine that floats in orbit has the bias forces of `orbital_bias`. A base that is fixed (an arm on a stand) has six
more rows, A = [1 0] on its own six rates: -λ is then the wrench on the foundation, and the state of every machine has
one form.
"""

import copy
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from sojourn_machine.contact_report import REPORT_COLUMNS
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.machine import MachineParams
from sojourn_machine.params import FloatArray, IntArray
from sojourn_machine.power.loads import LoadParams
from sojourn_machine.power.network import PowerNetwork
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.tools import ObjectParams, ToolParams
from sojourn_physics.actuators import joint_drive
from sojourn_physics.actuators.drive_condition import conditions_of
from sojourn_physics.contact.soil_needs import needs_of_soil
from sojourn_physics.contact.support_tables import support_tables
from sojourn_physics.environment.air.wind import MovingAir
from sojourn_physics.environment.gravity.field import MAP_ORIGIN, GravityField
from sojourn_physics.environment.gravity.tide import TidalField
from sojourn_physics.environment.sun.over import SunOver
from sojourn_physics.plant.heat import PlantHeat, PlantHeatState
from sojourn_physics.plant.joint_tables import joint_tables
from sojourn_physics.plant.params import SimulationParams
from sojourn_physics.plant.tools.mounted_tool import MountedTool, with_tool
from sojourn_physics.plant.working_memory import WorkingMemory
from sojourn_physics.plant.wrist import WristLoad
from sojourn_physics.soil.params import SoilParams, kernel_table
from sojourn_physics.terrain.height_field import HeightField, OutsideTerrainError
from sojourn_physics.terrain.memory import GroundMemory, MemoryBoard
from sojourn_physics.thermal.site_heat import SiteHeat

PLACEMENT_SIZE = 12
BASE_RATES = 6
STIFFEST_SPRING = 0.3
"""Largest angular frequency of a spring and what hangs on it, times the physics step [-]."""


class Site(NamedTuple):
    """Where a machine is."""

    terrain: HeightField
    soils: Sequence[SoilParams]
    """Those that the terrain names, in any order."""
    field: GravityField
    """Gravity in map."""
    memory_cell: float = 0.0
    """Distance of the nodes at which the ground remembers wheels [m]; 0: it does not."""
    objects: Sequence[ObjectParams] = ()
    """That lie about, for a gripper."""
    sun: SunOver | None = None
    """What shines on the machine; None: nothing does."""
    air: MovingAir | None = None
    """Where a wind blows."""
    heat: SiteHeat | None = None
    """Round the nodes of a machine whose heat is known."""


class PlantGiven(NamedTuple):
    """What a plant is made of; see `PlantModel`."""

    urdf_xml: str
    machine: MachineParams
    site: Site
    power: PowerParams
    simulation: SimulationParams | None = None
    tool: ToolParams | None = None


class PlantModel:
    """Fixed part of the plant. Its working memory makes it unfit for two threads; make one model for each.

    Args:
        urdf_xml: text of the machine's URDF.
        machine: what the URDF does not say.
        site: where it is.
        power: energy supply and its loads.
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
        power: PowerParams,
        simulation: SimulationParams | None = None,
        tool: ToolParams | None = None,
    ) -> None:
        self.given = PlantGiven(urdf_xml, machine, site, power, simulation, tool)
        gravity, terrain = site.field.gravity, site.terrain
        self.machine = machine = with_tool(machine, tool)
        self.terrain = terrain
        self.power = PowerNetwork(power)
        self.simulation = simulation or SimulationParams()
        self.field, self.gravity = site.field, gravity
        self.tide = site.field if isinstance(site.field, TidalField) else None
        self.air, self.sun = site.air, site.sun
        self.multibody = pin.buildModelFromXML(urdf_xml, pin.JointModelFreeFlyer())
        self.multibody.gravity.linear = self.field.acceleration(MAP_ORIGIN)
        self.mass = float(sum(inertia.mass for inertia in self.multibody.inertias))
        self.joints, self.outside = joint_tables(self.multibody, machine, self.loads)
        by_joint = {joint: drive for drive in machine.drives for joint in drive.joints}
        self.conditions = conditions_of([by_joint.get(name) for name in self.joints.names], self.joints.parameters)
        self.heat = None if site.heat is None else PlantHeat(site.heat, self.power, self.simulation.control_period)
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
        if machine.floats:  # which has no way up
            self.roll_over_cosine = -math.inf
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

    def weigh(self, configuration: FloatArray, velocity: FloatArray) -> FloatArray | None:
        """Let all links weigh what they do where the base is and as it moves, (nq,), (nv,), and be blown at together.

        Returns:
            force of the air in map, (3,) [N]; None where no wind blows.
        """
        if (self.field.uniform or self.tide is not None) and self.air is None:
            return None
        moving = pin.Quaternion(configuration[3:7]) * velocity[:3]
        acceleration = self.field.acceleration(configuration[:3], moving)
        force = None if self.air is None else self.air.force(self._height(configuration), moving)
        self.multibody.gravity.linear = acceleration if force is None else acceleration + force / self.mass
        return force

    def centre_of_mass(self, configuration: FloatArray) -> FloatArray:
        """In map, (3,) [m]."""
        return np.array(pin.centerOfMass(self.multibody, self._aside, configuration))

    def _height(self, configuration: FloatArray) -> float:
        """Of the centre of mass over the ground, or off the map over z = 0 [m]."""
        x, y, z = self.centre_of_mass(configuration).tolist()
        try:
            return float(z - self.terrain.height(x, y))
        except OutsideTerrainError:
            return float(z)

    @property
    def loads(self) -> tuple[LoadParams, ...]:
        """The loads of all buses, in the order of every array."""
        return self.power.params.loads

    def round_drives(self, heat: PlantHeatState | None) -> list[float | None] | None:
        """What is round each drive that has conditions [K]; None where the machine's heat is not known."""
        if heat is None or self.heat is None or self.conditions is None:
            return None
        loads = [self.loads[load].name for load in self.joints.loads[self.conditions.rows]]
        return self.heat.round_drives(heat, loads)

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
        self._aside = model.createData()
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
        self.load_power = np.zeros(len(self.loads))
        self.work = WorkingMemory(self)


def _check_ground(machine: MachineParams, ground: Sequence[SoilParams]) -> None:
    """Every support finds in every soil what its law needs."""
    for soil in ground:
        for support, law, missing in needs_of_soil(machine, soil):
            if missing:
                allowed = f"a soil with what {law} of {support} needs; missing: "
                raise InvalidValueError("soil", soil.name, allowed + ", ".join(missing))
