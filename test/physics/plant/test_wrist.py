"""The load on the wrist's sensor, against weight, lever and contact in closed form."""

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from sojourn_machine.errors import InvalidValueError
from sojourn_physics.plant.step import step
from sojourn_physics.plant.wrist import WristLoad

TURRET = 2.0
LEVER = -0.00813
"""Of the turret's centre of mass along z of its link [m] (URDF)."""


def test_at_rest_it_feels_the_turret_hanging(flat: Any) -> None:
    rover = flat
    _, output = step(rover.model, rover.start, rover.hold())
    data = rover.model.multibody.createData()
    pin.framesForwardKinematics(rover.model.multibody, data, rover.start.configuration)
    rotation = data.oMf[rover.model.multibody.getFrameId("arm_turret_link")].rotation
    weight = rotation.T @ np.array([0.0, 0.0, -TURRET * rover.model.gravity])
    expected = np.concatenate([weight, np.cross([0.0, 0.0, LEVER], weight)])
    assert output.wrist_wrench == pytest.approx(expected, abs=1e-3)


def test_in_free_fall_it_feels_nothing(flat: Any) -> None:
    """All of the machine falls alike; what the arm's servos still give is part of it."""
    rover = flat
    load = rover.model.wrist
    gravity = np.zeros(rover.model.multibody.nv)
    gravity[2] = -rover.model.gravity
    level = rover.start.configuration.copy()
    level[3:7] = [0.0, 0.0, 0.0, 1.0]
    still = np.zeros_like(gravity)
    wrench = load.wrench(level, still, gravity, np.zeros_like(rover.model.report))
    assert wrench == pytest.approx(np.zeros(6), abs=1e-9)


def test_a_contact_acts_at_its_place(flat: Any) -> None:
    rover = flat
    load = rover.model.wrist
    names = rover.model.supports.names
    assert [names[i] for i in load.contacts] == ["arm_tip"]
    report = np.zeros_like(rover.model.report)
    free = load.at_rest(rover.start.configuration, report)
    data = rover.model.multibody.createData()
    pin.framesForwardKinematics(rover.model.multibody, data, rover.start.configuration)
    frame = data.oMf[rover.model.multibody.getFrameId("arm_turret_link")]
    force, place = np.array([3.0, -5.0, 11.0]), frame.act(np.array([0.01, 0.02, -0.1]))
    report[load.contacts[0], 0:3], report[load.contacts[0], 6:9] = place, force
    added = load.at_rest(rover.start.configuration, report) - free
    local = frame.rotation.T @ force
    assert added == pytest.approx(np.concatenate([local, np.cross([0.01, 0.02, -0.1], local)]), abs=1e-9)
    report[0, 6:9] = 100.0  # a wheel is not beyond the wrist
    assert load.at_rest(rover.start.configuration, report) - free == pytest.approx(added, abs=1e-9)


def test_an_accelerated_turret_pushes_back(flat: Any) -> None:
    """Newton: the force on the sensor is less weight by mass times the acceleration of the centre of mass."""
    rover = flat
    multibody = rover.model.multibody
    still, acceleration = np.zeros(multibody.nv), np.zeros(multibody.nv)
    acceleration[multibody.joints[multibody.getJointId("arm_azimuth_joint")].idx_v] = 2.0
    empty = np.zeros_like(rover.model.report)
    added = rover.model.wrist.wrench(rover.start.configuration, still, acceleration, empty) - rover.model.wrist.at_rest(
        rover.start.configuration, empty
    )
    data = multibody.createData()
    pin.forwardKinematics(multibody, data, rover.start.configuration, still, acceleration)
    joint = multibody.getJointId("arm_turret_joint")
    motion = data.a[joint]
    of_centre = motion.linear + np.cross(motion.angular, [0.0, 0.0, LEVER])
    assert added[:3] == pytest.approx(-TURRET * of_centre, abs=1e-9)


def test_a_machine_without_the_sensor_tells_nothing(flat: Any) -> None:
    rover = flat
    multibody, bodies = rover.model.multibody, rover.model.supports.bodies
    for link in ("nothing_link", "base_link", "arm_tip_link"):
        with pytest.raises(InvalidValueError, match="wrench_sensor_link"):
            WristLoad(multibody, link, bodies)
    wrist, rover.model.wrist = rover.model.wrist, None
    _, output = step(rover.model, replace(rover.start.copy()), rover.hold())
    rover.model.wrist = wrist
    assert output.wrist_wrench is None
