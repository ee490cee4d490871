"""What a run looks like at one moment, as a plain value, and how it changes with each message.

A scene knows nothing of where messages come from, nor of how it is drawn. Places are in map, which is odom where only
the drive's estimate is known.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from sojourn_console.feed import FeedMessage
from sojourn_console.ruts import touching
from sojourn_contract.clouds import columns_of, points_of
from sojourn_contract.codecs import decode
from sojourn_contract.decoding import refusing
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.ground import NAMES as GROUND_NAMES
from sojourn_contract.heartbeat import RUNNING, read_heartbeats, status_values
from sojourn_contract.values import Image, Message, OccupancyGrid
from sojourn_machine.params import FloatArray
from sojourn_operator.alarms.beats import Beats

TRACK = 4000
"""Points of the way behind that are kept."""
TRACK_STEP = 0.05
"""Distance between two of them [m]."""
CONTACT_NAMES = ("x", "y", "z", "sinkage", "slip_ratio", "force_x", "force_y", "force_z")
COSTMAP = "/local_costmap/costmap"
STATUSES = ("/drive/status", "/arm/status", "/power/status")
NOTHING = np.zeros((0, 3))
MISSED = 5
"""Seconds in which others have beaten and a role that says it runs has not, from which on it is silent."""
HANDFUL = 64
"""Of what has passed so much is taken out of a scene at a time: a tuple is copied whole whenever it grows."""
CHARGE_TOLERANCE = 1e-7
"""By which a charge may lie beyond 0 to 1, as the contract has it."""


class PixelKind(NamedTuple):
    """Bytes of a number, and how many numbers a pixel has."""

    bytes: int
    numbers: int


PIXELS: Mapping[str, PixelKind] = {
    **dict.fromkeys(("mono8", "8UC1"), PixelKind(1, 1)),
    **dict.fromkeys(("mono16", "16UC1"), PixelKind(2, 1)),
    **dict.fromkeys(("rgb8", "bgr8"), PixelKind(1, 3)),
}
"""Encodings of images that can be drawn."""


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
        contacts: with the ground; passed: x, y and sinkage [m] of what has touched it since the scene was shown last,
            (n, 3), a message each.
        lowered: nodes of /truth/ground that have changed since the scene was shown last, a message each: columns x, y,
            and by how much lower [m].
        costmap: what the drive takes for closed round it, None where it has not told.
        images: newest by topic. statuses: newest keys and values by topic. charge: by the power manager, 0 to 1;
            None where it is not known, battery_heard or not.
        states: of the nodes by role, as their heartbeats tell; beats: when each has been heard.
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
    passed: tuple[FloatArray, ...] = ()
    lowered: tuple[FloatArray, ...] = ()
    costmap: OccupancyGrid | None = None
    images: Mapping[str, Image] = field(default_factory=dict)
    statuses: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    charge: float | None = None
    battery_heard: bool = False
    states: Mapping[str, str] = field(default_factory=dict)
    beats: Beats = field(default_factory=Beats)
    refused: Mapping[str, int] = field(default_factory=dict)

    def status(self, topic: str) -> Mapping[str, str]:
        """Keys and values of a status, none before the first."""
        return self.statuses.get(topic, {})

    @property
    def silent(self) -> dict[str, float]:
        """Roles that said they run and of which nothing is heard any more, and for how long [s of simulation]."""
        return {role: gone for role, gone in self.beats.silent(MISSED).items() if self.states[role] == RUNNING}


def after_all(scene: RunScene, heard: Iterable[FeedMessage]) -> RunScene:
    """The scene after messages in their order, since a scene was shown: `passed` and `lowered` have come with them. One
    that cannot be read is counted and changes nothing else.
    """
    passed, lowered, refused, stamp = list[FloatArray](), list[FloatArray](), dict(scene.refused), scene.stamp
    scene = replace(scene, passed=(), lowered=())
    for one in heard:
        name = one.row.name
        take = _TAKES.get(name) or _TAKES_OF_TYPE.get(one.row.type)
        if take is None:
            continue
        try:
            with refusing(name, f"a {one.row.type} that can be shown"):
                scene = take(scene, name, decode(one.row, one.data))
        except RefusedMessageError:
            refused[name] = refused.get(name, 0) + 1
            continue
        if one.row.publisher != "all":  # anybody speaks there, by whatever clock
            stamp = max(stamp, one.time)
        if len(scene.passed) + len(scene.lowered) >= HANDFUL:
            passed += scene.passed
            lowered += scene.lowered
            scene = replace(scene, passed=(), lowered=())
    passed, lowered = [*passed, *scene.passed], [*lowered, *scene.lowered]
    return replace(scene, stamp=stamp, passed=tuple(passed), lowered=tuple(lowered), refused=refused)


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
    nodes = touching(places, forces, contacts.sinkage)
    return replace(scene, contacts=contacts, passed=(*scene.passed, nodes))


def _ground(scene: RunScene, name: str, message: Message) -> RunScene:
    if not message.width * message.height:
        return scene
    columns = columns_of(name, message, GROUND_NAMES)
    nodes = np.stack([columns[one] for one in GROUND_NAMES], axis=1).astype(np.float64)
    return replace(scene, lowered=(*scene.lowered, nodes))


def _costmap(scene: RunScene, _: str, message: Message) -> RunScene:
    return replace(scene, costmap=message if message.width * message.height else None)


def _image(scene: RunScene, name: str, message: Message) -> RunScene:
    kind = PIXELS.get(message.encoding)
    if kind is None:
        raise RefusedMessageError(name, "encoding", message.encoding, " or ".join(PIXELS))
    row, size = message.width * kind.bytes * kind.numbers, len(message.data)
    if message.step < row or size < message.step * message.height:
        found = f"{size} bytes in {message.height} rows of {message.step}"
        raise RefusedMessageError(name, "data", found, f"rows of at least {row} bytes, all of them")
    return replace(scene, images={**scene.images, name: message})


def _status(scene: RunScene, name: str, message: Message) -> RunScene:
    return replace(scene, statuses={**scene.statuses, name: status_values(message)})


def _battery(scene: RunScene, name: str, message: Message) -> RunScene:
    charge = message.percentage
    if np.isnan(charge):  # the word of the contract for what is not known
        return replace(scene, charge=None, battery_heard=True)
    if not -CHARGE_TOLERANCE <= charge <= 1.0 + CHARGE_TOLERANCE:
        raise RefusedMessageError(name, "percentage", charge, "0 to 1, or NaN where it is not known")
    return replace(scene, charge=min(max(charge, 0.0), 1.0), battery_heard=True)


def _heartbeats(scene: RunScene, _: str, message: Message) -> RunScene:
    states, beats = dict(scene.states), scene.beats
    for beat in read_heartbeats(message):
        states[beat.role], beats = beat.state, beats.after(beat)
    return replace(scene, states=states, beats=beats)


Take = Callable[[RunScene, str, Any], RunScene]
_TAKES: Mapping[str, Take] = {
    "/odom": _odometry,
    "/truth/odom": _truth,
    "/truth/joint_states": _joints,
    "/joint_states": _joints,
    "/plan": _plan,
    "/hazcam/points": _cloud,
    COSTMAP: _costmap,
    "/truth/contacts": _contacts,
    "/truth/ground": _ground,
    "/battery_state": _battery,
    "/diagnostics": _heartbeats,
    **dict.fromkeys(STATUSES, _status),
}
_TAKES_OF_TYPE: Mapping[str, Take] = {"sensor_msgs/Image": _image}
SHOWN = tuple(_TAKES)
"""Topics that a scene is made of, images apart."""
