"""What the arm takes for the ground: looked at when a goal comes, and kept until the next one."""

from dataclasses import dataclass, replace

import numpy as np

from sojourn_arm.rover import Rover
from sojourn_config.known_machine import KnownMachine
from sojourn_contract.clouds import points_of
from sojourn_contract.hazcam import TOPIC, hazard_camera_of
from sojourn_contract.values import JointState, PointCloud2
from sojourn_flight.arm.ground import GroundUnderWheels
from sojourn_flight.arm.ground_plane import GroundPlane
from sojourn_flight.arm.params import ArmParams
from sojourn_flight.arm.relief import Ground, relief_of
from sojourn_flight.hazards.obstacle_map import ObstacleMap, empty_map, with_cloud
from sojourn_machine.params import FloatArray

CELL = 0.05
"""Of the map of the ground in reach [m]: half a tool; the hazard camera has a point every 4 cm at 1 m."""


@dataclass(frozen=True, slots=True, eq=False)
class SeenGround:
    """What the hazard camera has seen, and from where it did so last."""

    map: ObstacleMap
    """In odom."""
    position: FloatArray
    rotation: FloatArray
    """Of base_link in odom at the last cloud, shapes (3,) [m] and (3, 3)."""
    driven: float = 0.0
    """Between clouds [m]."""


@dataclass(frozen=True, slots=True)
class KnownGround:
    """What is remembered of it."""

    ground: Ground | None = None
    """That motions are checked against; None for none."""
    seen: SeenGround | None = None
    cloud: int = -1
    """Stamp of the last cloud [ns]."""


class GroundWatch:
    """Finds the ground: a plane, and over it what the hazard camera has seen.

    Args:
        reach: of the arm from base_link [m].
    """

    def __init__(self, params: ArmParams, known: KnownMachine, reach: float) -> None:
        self._fixed: GroundPlane | None = None
        self._under: GroundUnderWheels | None = None
        self._reach = reach
        wheels = [(wheel.joint, wheel.radius + wheel.grouser_height) for wheel in known.machine.wheels]
        if params.avoid_ground and params.ground_height is not None:
            self._fixed = GroundPlane(params.ground_height)
        elif params.avoid_ground and wheels:
            self._under = GroundUnderWheels(known.urdf_xml, wheels, params.base_link)
        self._camera = hazard_camera_of(known) if self._under is not None else None
        self._settings = obstacles = known.drive.obstacles if self._camera is not None else None
        if obstacles is not None:
            near = obstacles.map.model_copy(update={"cell": CELL, "size": 2.0 * reach + 2.0})
            self._settings = obstacles.model_copy(update={"map": near})

    def warm_up(self) -> None:
        """Have its compiled kernels loaded."""
        if self._settings is not None and self._camera is not None:
            nothing = empty_map(self._settings, 0.0, 0.0)
            with_cloud(self._settings, nothing, np.ones((1, 3)), self._camera, np.zeros(3), np.eye(3), 0.0)

    def initial_state(self) -> KnownGround:
        """Before anything has been seen."""
        return KnownGround(self._fixed)

    def after_cloud(self, seen: SeenGround | None, cloud: PointCloud2, rover: Rover) -> SeenGround | None:
        """What has been seen with a new cloud, from where the rover is.

        Raises:
            RefusedMessageError: a cloud, or an odometry, that cannot be used.
        """
        if self._settings is None or self._camera is None:
            return seen
        points, place = points_of(TOPIC, cloud), rover.place()
        if place is None:
            return seen
        position, rotation, driven = np.array(place.translation), np.array(place.rotation), 0.0
        if seen is None:
            known = empty_map(self._settings, float(position[0]), float(position[1]))
        else:
            known, driven = seen.map, seen.driven + float(np.linalg.norm(position - seen.position))
        known = with_cloud(self._settings, known, points, self._camera, position, rotation, driven)
        return SeenGround(known, position, rotation, driven)

    def observe(self, known: KnownGround, joints: JointState) -> KnownGround:
        """The ground found anew, with the suspension as /joint_states tells it."""
        if self._under is None:
            return known
        plane = self._under.plane(dict(zip(joints.names, joints.position, strict=True)))
        seen = known.seen
        if plane is None or seen is None:
            return replace(known, ground=plane)
        return replace(known, ground=relief_of(seen.map, seen.position, seen.rotation, plane, self._reach))
