"""A scene after the messages of the reference run says what the bag says."""

import numpy as np
import pytest

from sojourn_bags.reading import Bag
from sojourn_console.feed import FeedMessage
from sojourn_console.model import TRACK_STEP, RunScene, after_all
from sojourn_console.world import World


def played(bag: Bag, world: World, *names: str, scene: RunScene | None = None) -> RunScene:
    scene = scene or RunScene()
    return after_all(
        scene,
        [
            FeedMessage(world.table.topic(name), data, time)
            for name in names
            for time, data in zip(bag[name].log_times, bag[name].data, strict=True)
        ],
    )


def test_the_estimate_is_that_of_the_bag(reference: Bag, world: World) -> None:
    scene = played(reference, world, "/odom")
    odometry = reference["/odom"]
    place = odometry.columns(*(f"pose.pose.position.{axis}" for axis in "xyz"))
    assert scene.pose is not None
    assert scene.pose.position == pytest.approx(place[-1], abs=1e-12)
    assert scene.covariance.ravel() == pytest.approx(odometry.column("pose.covariance")[-1])
    assert scene.stamp == odometry.log_times[-1]
    steps = np.linalg.norm(np.diff(scene.track[:, :2], axis=0), axis=1)
    assert (steps > TRACK_STEP).all() and (steps < 2.0 * TRACK_STEP).all()
    driven = np.linalg.norm(np.diff(place[:, :2], axis=0), axis=1).sum()
    assert driven - 2.0 * TRACK_STEP < steps.sum() <= driven


def test_joints_contacts_and_statuses(reference: Bag, world: World) -> None:
    scene = played(reference, world, "/joint_states", "/truth/contacts", "/drive/status", "/battery_state")
    joints = reference["/joint_states"].joints()
    assert scene.joints["wheel_front_left_joint"] == joints.position[-1, joints.index("wheel_front_left_joint")]
    points = reference["/truth/contacts"].points()
    assert scene.contacts is not None
    assert scene.contacts.forces[:, 2] == pytest.approx(points["force_z"][-1])
    assert len(scene.passed) == len(reference["/truth/contacts"])
    assert scene.status("/drive/status")["state"] == reference["/drive/status"].statuses()[-1]["state"]
    assert scene.charge == pytest.approx(reference["/battery_state"].column("percentage")[-1], abs=1e-7)


def test_what_cannot_be_read_is_counted_and_changes_nothing_else(reference: Bag, world: World) -> None:
    before = played(reference, world, "/odom")
    scene = after_all(before, [FeedMessage(world.table.topic("/odom"), b"\0\1\0\0nonsense", before.stamp + 1)])
    assert scene.refused == {"/odom": 1}
    assert scene.pose is before.pose and scene.stamp == before.stamp
    unknown = after_all(before, [FeedMessage(world.table.topic("/power/forecast"), b"", before.stamp + 1)])
    assert unknown.stamp == before.stamp and not unknown.refused
