"""A machine at a site as truth and belief have it alike: what its files say of it, and what follows from that."""

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sojourn_config.arm_config import ArmConfig
from sojourn_config.errors import MISSING, single
from sojourn_config.machine import MachineConfig
from sojourn_config.machine_body import STOWED, machine_body
from sojourn_config.urdf import UrdfSummary
from sojourn_flight.mobility.steering_geometry import SteeringGeometryParams, steering_geometry
from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_flight.supervision.params import DriveParams
from sojourn_machine.body import MachineBody
from sojourn_machine.disturbance import Disturbance
from sojourn_machine.power.power_params import PowerParams
from sojourn_machine.thermal.thermal_params import ThermalParams
from sojourn_machine.tools import ToolParams
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.gravity.field import GravityField
from sojourn_physics.environment.site import SiteParams
from sojourn_physics.sensors.params import SensorSuiteParams

if TYPE_CHECKING:
    from sojourn_flight.mobility.mobility import Mobility


@dataclass(frozen=True, slots=True, eq=False)
class KnownMachine:
    """A machine at a site.

    Args:
        machine: supports, drives, couplings (also the plant's MachineParams), those of its arm among them.
        urdf: the machine's URDF, with the arm that is mounted on it; `urdf.text` is the XML.
        body: planet or moon. site: where on it; None: anywhere.
        power: stores, sources, converters and loads.
        power_manager: what the power manager believes and its law.
        sensors: set of the sensors' node.
        arm: set of the arm node, None for a machine without one; rotor inertia and friction that its file leaves out
            are filled in from the machine's drives.
        tool: at the end of the arm, None where there is none.
        driving: set of the drive node; None for a machine that stands fast or floats.
        thermal: nodes of its heat; None for a machine whose heat is not looked at.
        disturbances: what happens to messages between the nodes, for those who carry them.
    """

    machine: MachineConfig
    urdf: UrdfSummary
    body: BodyParams
    site: SiteParams | None
    power: PowerParams
    power_manager: PowerManagerParams
    sensors: SensorSuiteParams
    arm: ArmConfig | None
    tool: ToolParams | None
    driving: DriveParams | None
    thermal: ThermalParams | None
    disturbances: tuple[Disturbance, ...] = dataclasses.field(default=(), kw_only=True)

    @property
    def fault_roles(self) -> frozenset[str]:
        """Roles to which something happens by a schedule of faults, as far as it is known."""
        return frozenset()

    @property
    def urdf_xml(self) -> str:
        """The URDF as text."""
        return self.urdf.text

    def carried_arm(self) -> ArmConfig:
        """The set of the arm. Raises ConfigError for a machine without one."""
        if self.arm is None:
            raise single(self.urdf.file, "", MISSING, "this machine has no arm")
        return self.arm

    @property
    def drive(self) -> DriveParams:
        """The set of the drive node. Raises ConfigError for a machine that stands fast."""
        if self.driving is None:
            raise single(self.urdf.file, "", MISSING, f"this machine {self.machine.why_it_stays}: it does not drive")
        return self.driving

    def machine_body(self) -> MachineBody:
        """The machine as its own computer knows it."""
        return machine_body(self.machine, self.urdf, self.gravity, self.arm_pose(STOWED))

    @property
    def steering(self) -> SteeringGeometryParams:
        """The wheels and tracks as the drive node sees them."""
        return steering_geometry(self.machine_body().layout)

    def mobility(self) -> "Mobility[Any]":
        """What moves the machine. Raises ConfigError for a machine that stands fast."""
        return self.drive.mobility.build(self.drive, self.machine_body())

    @property
    def arm_joints(self) -> tuple[str, ...]:
        """Joints of the arm; none where there is no arm."""
        return () if self.arm is None else self.arm.joint_names

    @property
    def pointed_joints(self) -> tuple[str, ...]:
        """Joints held by position that neither drive nor arm moves: a mast's pan and tilt."""
        others = {*self.arm_joints, *(() if self.driving is None else self.driving.mobility.joints(self.machine))}
        held = (joint for drive in self.machine.drives if drive.mode == "position" for joint in drive.joints)
        return tuple(joint for joint in held if joint not in others)

    def arm_pose(self, name: str) -> dict[str, float]:
        """Angles of the arm's joints in a named pose [rad]; none where there is no arm, or no such pose."""
        positions = () if self.arm is None else self.arm.named_poses.get(name, ())
        return dict(zip(self.arm_joints, positions, strict=False))

    @property
    def gravity_field(self) -> GravityField:
        """Gravity in map."""
        if self.machine.floats:
            return self.body.field_in_orbit()
        return self.body.gravity_over(self.site)

    @property
    def gravity(self) -> float:
        """Strength of gravity at the origin of map [m/s2]."""
        return self.gravity_field.gravity

    def known_fields(self) -> dict[str, Any]:
        """The fields that every machine has, by name, to build a larger value from."""
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(KnownMachine)}
