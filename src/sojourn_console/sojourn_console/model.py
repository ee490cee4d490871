"""What a run looks like at one moment, as a plain value, and how it changes with each message.

A scene knows nothing of where messages come from, nor of how it is drawn. Places are in map, which is odom where only
the drive's estimate is known.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from sojourn_console.feed import FeedMessage
from sojourn_contract.clouds import columns_of, points_of
from sojourn_contract.codecs import decode
from sojourn_contract.decoding import refusing
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.ground import NAMES as GROUND_NAMES
from sojourn_contract.heartbeat import read_heartbeats, status_values
from sojourn_contract.values import Image, Message, OccupancyGrid
from sojourn_machine.params import FloatArray

TRACK = 4000
"""Points of the way behind that are kept."""
TRACK_STEP = 0.05
"""Distance between two of them [m]."""
CONTACT_NAMES = ("x", "y", "z", "sinkage", "slip_ratio", "force_x", "force_y", "force_z")
STATUSES = ("/drive/status", "/arm/status", "/power/status")
NOTHING = np.zeros((0, 3))


@dataclass(frozen=True, eq=False)
class BasePose:
    """Where base_link is: position (3,) [m] and orientation (4,) x y z w in map."""

    position: FloatArray
    orientation: FloatArray


@dataclass(frozen=True, eq=False)
class Contacts:
    """Where the ground pushes: places (n, 3) [m] in map, forces on the machine (n, 3) [N], sinkage (n,) [m], slip."""

    places: FloatArray
    forces: FloatArray
    sinkage: FloatArray
    slip: FloatArray


@dataclass(frozen=True, eq=False)
class RunScene:
    """Of one moment.

    Args:
        stamp: simulation time [ns]. pose: by the drive's estimate; covariance: (6, 6) of it. truth: as it is.
        speed: of the estimate ahead [m/s]. joints: angles [rad], [m] by joint; measured, or true where told.
        track: places that the estimate has passed, (n, 3). plan: what is left of the way to the goal, (n, 3).
        cloud: newest points of the hazard camera in base_link, (n, 3), and from which pose.
        contacts: with the ground; passed: all that have come since the scene was shown last.
        lowered: newest nodes of /truth/ground, columns x, y, and by how much [m].
        costmap: what the drive takes for closed round it, None where it has not told.
        images: newest by topic. statuses: newest keys and values by topic. charge: by the power manager, 0 to 1.
        states: of the nodes by role, as their heartbeats tell.
        refused: messages that could not be read, by topic.
    """

    stamp: int = 0
    pose: BasePose | None = None
    covariance: FloatArray = field(default_factory=lambda: np.zeros((6, 6)))
    truth: BasePose | None = None
    speed: float = 0.0
    joints: Mapping[str, float] = field(default_factory=dict)
    track: FloatArray = field(default_factory=lambda: NOTHING)
    plan: FloatArray = field(default_factory=lambda: NOTHING)
    cloud: FloatArray = field(default_factory=lambda: NOTHING)
    cloud_pose: BasePose | None = None
    contacts: Contacts | None = None
    passed: tuple[Contacts, ...] = ()
    lowered: FloatArray = field(default_factory=lambda: NOTHING)
    costmap: OccupancyGrid | None = None
    images: Mapping[str, Image] = field(default_factory=dict)
    statuses: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    charge: float | None = None
    states: Mapping[str, str] = field(default_factory=dict)
    refused: Mapping[str, int] = field(default_factory=dict)

    def status(self, topic: str) -> Mapping[str, str]:
        """Keys and values of a status, none before the first."""
        return self.statuses.get(topic, {})


def after(scene: RunScene, heard: FeedMessage) -> RunScene:
    """The scene after a message; one that cannot be read is counted and changes nothing else."""
    name = heard.row.name
    take = _TAKES.get(name) or _TAKES_OF_TYPE.get(heard.row.type)
    if take is None:
        return scene
    try:
        with refusing(name, f"a {heard.row.type} that can be shown"):
            message = decode(heard.row, heard.data)
            found = take(scene, name, message)
    except RefusedMessageError:
        return replace(scene, refused={**scene.refused, name: scene.refused.get(name, 0) + 1})
    return replace(found, stamp=max(scene.stamp, heard.time))


def _odometry(scene: RunScene, _: str, message: Message) -> RunScene:
    pose = BasePose(message.position, message.orientation)
    track = scene.track
    if not len(track) or float(np.hypot(*(pose.position - track[-1])[:2])) > TRACK_STEP:
        track = np.vstack([track, pose.position])[-TRACK:]
    covariance = message.pose_covariance.reshape(6, 6)
    return replace(scene, pose=pose, covariance=covariance, speed=float(message.linear[0]), track=track)


def _truth(scene: RunScene, _: str, message: Message) -> RunScene:
    return replace(scene, truth=BasePose(message.position, message.orientation))


def _joints(scene: RunScene, _: str, message: Message) -> RunScene:
    angles = zip(message.names, message.position.tolist(), strict=False)
    return replace(scene, joints={**scene.joints, **{name: angle for name, angle in angles if np.isfinite(angle)}})


def _plan(scene: RunScene, _: str, message: Message) -> RunScene:
    return replace(scene, plan=np.array([pose.position for pose in message.poses]).reshape(-1, 3))


def _cloud(scene: RunScene, name: str, message: Message) -> RunScene:
    return replace(scene, cloud=points_of(name, message), cloud_pose=scene.pose)


def _contacts(scene: RunScene, name: str, message: Message) -> RunScene:
    columns = columns_of(name, message, CONTACT_NAMES)
    places = np.stack([columns[axis] for axis in "xyz"], axis=1)
    forces = np.stack([columns[f"force_{axis}"] for axis in "xyz"], axis=1)
    contacts = Contacts(places, forces, columns["sinkage"], columns["slip_ratio"])
    return replace(scene, contacts=contacts, passed=(*scene.passed, contacts))


def _ground(scene: RunScene, name: str, message: Message) -> RunScene:
    if not message.width * message.height:
        return scene
    columns = columns_of(name, message, GROUND_NAMES)
    return replace(scene, lowered=np.stack([columns[one] for one in GROUND_NAMES], axis=1).astype(np.float64))


def _costmap(scene: RunScene, _: str, message: Message) -> RunScene:
    return replace(scene, costmap=message if message.width * message.height else None)


def _image(scene: RunScene, name: str, message: Message) -> RunScene:
    return replace(scene, images={**scene.images, name: message})


def _status(scene: RunScene, name: str, message: Message) -> RunScene:
    return replace(scene, statuses={**scene.statuses, name: status_values(message)})


def _battery(scene: RunScene, _: str, message: Message) -> RunScene:
    return replace(scene, charge=message.percentage)


def _heartbeats(scene: RunScene, _: str, message: Message) -> RunScene:
    told = {beat.role: beat.state for beat in read_heartbeats(message)}
    return replace(scene, states={**scene.states, **told})


Take = Callable[[RunScene, str, Any], RunScene]
_TAKES: Mapping[str, Take] = {
    "/odom": _odometry,
    "/truth/odom": _truth,
    "/truth/joint_states": _joints,
    "/joint_states": _joints,
    "/plan": _plan,
    "/hazcam/points": _cloud,
    "/local_costmap/costmap": _costmap,
    "/truth/contacts": _contacts,
    "/truth/ground": _ground,
    "/battery_state": _battery,
    "/diagnostics": _heartbeats,
    **dict.fromkeys(STATUSES, _status),
}
_TAKES_OF_TYPE: Mapping[str, Take] = {"sensor_msgs/Image": _image}
SHOWN = tuple(_TAKES)
"""Topics that a scene is made of, images apart."""
