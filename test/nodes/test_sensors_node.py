"""The node of the sensors, alone: truth in, measurements out."""

import math
from functools import partial

import numpy as np
import pytest
from node_bench import ARM, JOINTS, STEERS, WHEELS, Bench, at, battery, imu, joints, loads, odometry, stamp_of

from ros_messages import value_of
from sojourn_contract.clouds import points_of
from sojourn_sensors.node import SensorsNode

TRUTH = ("/truth/odom", "/truth/joint_states", "/truth/motor_states", "/truth/electrical", "/truth/loads")
TWIST = 0.01
"""By which the motors of the arm are ahead of their joints [rad]."""


def feed(bench: Bench, period: int, angle: float = 0.0, first: str = "/truth/odom") -> None:
    """The truth of one period, in one of two orders."""
    angles = dict.fromkeys(JOINTS, angle)
    messages = {"/truth/odom": odometry(period), "/truth/joint_states": joints(period, angles)}
    messages["/truth/motor_states"] = joints(period, angles | dict.fromkeys(ARM, angle + TWIST))
    if period % 5 == 0:
        messages["/truth/electrical"] = battery(period)
        messages["/truth/loads"] = loads(period, imu=12.0, cameras=9.0)
    for name in sorted(messages, key=lambda name: name != first):
        bench.send(name, messages[name])


def test_answers_each_period_once_with_its_stamp(bench: Bench) -> None:
    node = bench.start(SensorsNode, "plant", "sensors")
    bench.connect(node)
    for period in range(1, 13):
        feed(bench, period, first="/truth/joint_states" if period % 2 else "/truth/odom")
        bench.answer("/joint_states", period)
        bench.answer("/imu/data", period)
    assert [stamp_of(message) for message in bench.received["/joint_states"]] == [at(p) for p in range(1, 13)]
    assert [stamp_of(message) for message in bench.received["/imu/data"]] == [at(p) for p in range(1, 13)]
    assert [stamp_of(message) for message in bench.received["/bus/state"]] == [at(5), at(10)]
    bus = bench.received["/bus/state"][0]
    assert (bus.voltage, bus.current) == pytest.approx((29.0, -2.0), abs=0.5)
    assert math.isnan(bus.percentage), "the charge is not measured"
    assert not node.counters.refused


def test_encoders_are_as_good_as_their_resolution(bench: Bench) -> None:
    node = bench.start(SensorsNode, "plant", "sensors")
    bench.connect(node)
    for period in range(1, 8):
        feed(bench, period, angle=0.1234 * period)
        measured = bench.answer("/joint_states", period)
        assert set((*WHEELS, *STEERS, *ARM)) <= set(measured.name) <= set(JOINTS)
        position = dict(zip(measured.name, measured.position, strict=True))
        for group in node.app.params.joint_groups.values():
            encoder = group.encoder
            step = 2 * math.pi / 2**encoder.bits / (encoder.gear_ratio if encoder.side == "motor" else 1.0)
            for name in group.joints:
                twist = TWIST if name in ARM else 0.0
                assert position[name] == pytest.approx(0.1234 * period + twist, abs=step)
    true_rate = 0.1234 / 0.02
    rates = dict(zip(measured.name, measured.velocity, strict=True))
    assert rates["wheel_front_left_joint"] == pytest.approx(true_rate, rel=0.01)


def test_imu_at_rest_feels_gravity(bench: Bench) -> None:
    bench.connect(bench.start(SensorsNode, "plant", "sensors"))
    felt = []
    for period in range(1, 21):
        feed(bench, period)
        reading = bench.answer("/imu/data", period)
        felt.append(np.array([getattr(reading.linear_acceleration, axis) for axis in "xyz"]))
        assert reading.header.frame_id == "imu_link"
        assert reading.orientation_covariance[0] > 0.0
    assert np.linalg.norm(np.mean(felt, axis=0)) == pytest.approx(1.625, abs=0.05)


def test_the_hazard_camera_looks_once_a_second(bench: Bench) -> None:
    """Level ground, the base where a machine at rest has it."""
    node = bench.start(SensorsNode, "plant", "sensors")
    bench.connect(node)
    for period in range(1, 101):
        raised = odometry(period)
        raised.pose.pose.position.z = 0.47
        bench.send("/truth/odom", raised)
        bench.send("/truth/joint_states", joints(period))
        bench.send("/truth/motor_states", joints(period))
        if period % 5 == 0:
            bench.send("/truth/electrical", battery(period))
            bench.send("/truth/loads", loads(period, imu=12.0, cameras=9.0))
        bench.answer("/imu/data", period)
    first, second = bench.answer("/hazcam/points", 50), bench.answer("/hazcam/points", 100)
    assert [stamp_of(message) for message in bench.received["/hazcam/points"]] == [at(50), at(100)]
    assert first.header.frame_id == "base_link" and bytes(first.data) != bytes(second.data), "its noise goes on"
    for message in (first, second):
        points = points_of("/hazcam/points", value_of(message))
        assert len(points) > 700 and 0.4 < points[:, 0].min() < points[:, 0].max() < 5.5
        assert abs(points[:, 2] + 0.47).max() < 0.05


def test_a_machine_without_a_hazard_camera_says_so_with_empty_clouds(bench: Bench) -> None:
    """In lock-step the drive waits for its answer, so there is one."""
    node = bench.start(SensorsNode, "plant", "sensors", overrides=["sensors.hazcam=null"])
    bench.connect(node)
    assert node.app.params.first_on("/hazcam/points") is None
    for period in range(1, 51):
        feed(bench, period)
        bench.answer("/imu/data", period)
    assert bench.answer("/hazcam/points", 50).width == 0


def test_a_sensor_whose_load_is_shed_does_not_work(bench: Bench) -> None:
    """Cameras that were off still gave points; and it works again when its load is back."""
    node = bench.start(SensorsNode, "plant", "sensors")
    bench.connect(node)
    powers = {50: (12.0, 0.0), 100: (0.0, 9.0), 150: (12.0, 9.0)}
    for period in range(1, 151):
        bench.send("/truth/odom", odometry(period))
        bench.send("/truth/joint_states", joints(period))
        bench.send("/truth/motor_states", joints(period))
        if period % 5 == 0:
            bench.send("/truth/electrical", battery(period))
            imu_power, camera_power = powers[-(-period // 50) * 50]
            bench.send("/truth/loads", loads(period, imu=imu_power, cameras=camera_power))
        bench.answer("/imu/data", period)
    points = [bench.answer("/hazcam/points", period).width for period in powers]
    assert points[0] == 0 and min(points[1:]) > 100
    rates = [bench.answer("/imu/data", period) for period in powers]
    assert [math.isnan(message.angular_velocity.z) for message in rates] == [False, True, False]
    assert [math.isnan(message.orientation.w) for message in rates] == [False, True, False]
    assert not node.counters.refused


def test_truth_that_is_none_is_refused(bench: Bench) -> None:
    """The sensors say what they said last, so that a run goes on, and why they do."""
    node = bench.start(SensorsNode, "plant", "sensors")
    bench.connect(node)
    feed(bench, 1)
    bench.answer("/joint_states", 1)
    bad = odometry(2)
    bad.pose.pose.position.x = math.nan
    bench.send("/truth/odom", bad)
    bench.send("/truth/joint_states", joints(2))
    bench.send("/truth/motor_states", joints(2))
    bench.until(lambda: node.counters.refused, "the truth is refused")
    feed(bench, 3)
    bench.answer("/joint_states", 3)
    assert node.counters.refused == {"/truth/odom": 1}
    assert "/truth/odom.pose.pose.position.x = nan" in node.counters.last_refusal
    repeated = bench.answer("/joint_states", 2)
    assert list(repeated.position) == list(bench.answer("/joint_states", 1).position)


def test_a_foreign_topic_is_not_read(bench: Bench) -> None:
    node = bench.start(SensorsNode, "plant", "sensors")
    assert set(node.endpoints.readers) == {*TRUTH, "/faults"}
    assert imu(1).header.frame_id == "imu_link"


def has_come(node: SensorsNode, name: str, period: int) -> bool:
    """Whether the latest message on a topic is that of the period."""
    return node.latest.stamp_of(name) == at(period)


def test_in_real_time_the_bus_is_read_at_its_own_rate(bench: Bench) -> None:
    node = bench.start(SensorsNode, "plant", "sensors", lockstep=False)
    bench.connect(node, lockstep=False)
    for period in range(1001, 1013):  # topics do not wait for each other in real time: the trigger goes last
        others = {"/truth/odom": odometry(period), "/truth/joint_states": joints(period)}
        if period % 5 == 0:
            others["/truth/electrical"] = battery(period)
        for name, message in others.items():
            bench.send(name, message)
        for name in others:
            bench.until(partial(has_come, node, name, period), f"{name} has come")
        bench.send("/truth/motor_states", joints(period))
        bench.answer("/joint_states", period)
    bench.answer("/bus/state", 1010)
    assert [stamp_of(message) for message in bench.received["/bus/state"]] == [at(1005), at(1010)]


def test_the_sun_is_seen_once_a_second_in_the_frame_of_its_sensor(bench: Bench) -> None:
    """At the start 30 degrees over the east, and the machine looks there; the deck is level."""
    node = bench.start(SensorsNode, "plant", "sensors")
    bench.connect(node)
    for period in range(1, 51):
        feed(bench, period)
        bench.answer("/imu/data", period)
    reading = bench.answer("/sun_direction", 50)
    assert reading.header.frame_id == "solar_deck_link"
    seen = (reading.vector.x, reading.vector.y, reading.vector.z)
    assert seen == pytest.approx((math.cos(math.pi / 6), 0.0, 0.5), abs=0.01) and math.hypot(*seen) == pytest.approx(
        1.0
    )
    assert len(bench.received["/sun_direction"]) == 1


RIM = "terrain.craters=[{x: 0.0, y: 0.0, diameter: 6.0, depth: 1.2}]"


@pytest.mark.parametrize(
    "overrides",
    [
        ["sun.elevation_deg=-5"],
        ["sun.elevation_deg=5", "sun.ground_hides=true", RIM],
        ["sun.time=2028-12-31T16:53:00Z", "site.latitude_deg=0"],
    ],
    ids=["at night", "in a crater", "in an eclipse"],
)
def test_in_the_dark_no_sun_is_seen(bench: Bench, overrides: list[str]) -> None:
    bench.connect(bench.start(SensorsNode, "plant", "sensors", overrides=overrides))
    for period in range(1, 51):
        feed(bench, period)
        bench.answer("/imu/data", period)
    vector = bench.answer("/sun_direction", 50).vector
    assert (vector.x, vector.y, vector.z) == (0.0, 0.0, 0.0)
