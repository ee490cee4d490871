"""Nothing that is said on a topic ends or blinds a node: bytes that are no message, and stamps that are no time."""

import gc
import struct
import sys
from collections import Counter
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from node_bench import HIGHEST_STAMP_S, Bench, at, cloud, imu, joints, sun

from ros_messages import ros_time
from sojourn_arm.node import ArmNode
from sojourn_bags.recorder_node import RecorderNode
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_drive.node import DriveNode
from sojourn_operator.node import OperatorNode
from sojourn_plant.node import PlantNode
from sojourn_power.node import PowerNode
from sojourn_sensors.node import SensorsNode
from sojourn_studies.hostile_messages import spoiled, whole

sys.path.insert(0, str(Path(__file__).parents[1] / "contract"))

from hostile_bytes import hostile
from test_drive_node import pose, rates, send_event, step

ROLES: dict[str, tuple[Any, tuple[str, ...]]] = {
    "sensors": (SensorsNode, ("plant", "sensors", "arm")),
    "drive": (DriveNode, ("sensors", "drive", "power", "operator")),
    "arm": (ArmNode, ("sensors", "drive", "arm", "power", "operator")),
    "power": (PowerNode, ("sensors", "power", "operator")),
    "operator": (OperatorNode, ("plant", "drive", "arm", "power", "operator")),
    "plant": (PlantNode, ("plant", "drive", "arm", "power", "operator", "recorder")),
}


@pytest.mark.parametrize("lockstep", [True, False])
@pytest.mark.parametrize("role", ROLES)
def test_no_bytes_end_a_node(bench: Bench, role: str, lockstep: bool) -> None:
    """With the stamp of the period that is due, too, so that the node acts on whatever can be read."""
    kind, participants = ROLES[role]
    node = bench.start(kind, *participants, lockstep=lockstep)
    if role == "plant":
        node._begun = True
    rows = node.endpoints.inputs

    @settings(max_examples=120, deadline=None, suppress_health_check=list(HealthCheck), database=None)
    @given(st.data())
    def fuzz(data: st.DataObject) -> None:
        row = data.draw(st.sampled_from(rows))
        content = data.draw(hostile(row))
        due = node.barrier.stamp if lockstep else node.now + CONTROL_PERIOD_NS
        if len(content) >= 12 and data.draw(st.booleans()):
            content = content[:4] + struct.pack("<iI", due // NANOSECONDS, due % NANOSECONDS) + content[12:]
            content = b"\0\1" + content[2:]
        node._receive(row, content)
        if lockstep:  # whoever is still missing says something, so that the period is acted on
            for missing in node.barrier.missing():
                node.barrier.offer(missing, node.barrier.stamp - missing.lag * CONTROL_PERIOD_NS, None)
            node._advance()
        elif role == "plant":
            node._act_in_real_time()

    fuzz()
    assert not node.finished
    assert node.counters.refused and node.counters.last_refusal
    assert node.now or not lockstep


@pytest.mark.parametrize("role", ["recorder", *ROLES])
def test_nothing_that_is_refused_is_left_for_the_garbage_collector(bench: Bench, tmp_path: Path, role: str) -> None:
    """It comes seldom: under a flood nodes grew by some 40 MB of messages, each held by the error that refused it."""
    kind, participants = ROLES.get(role, (RecorderNode, ("sensors", "drive", "arm", "power", "recorder")))
    own = {"bag": str(tmp_path / "bag")} if role == "recorder" else {}
    node = bench.start(kind, *participants, lockstep=False, **own)
    if role == "plant":
        node._begun = True
    random, rows = np.random.default_rng(3), node.endpoints.inputs

    def flood(rounds: int) -> None:
        for _ in range(rounds):
            for row in rows:
                node._receive(row, spoiled(random, [whole(row)], node.now + CONTROL_PERIOD_NS))
            if role == "plant":
                node._act_in_real_time()

    flood(20)
    gc.collect()
    gc.disable()
    before, found = sum(node.counters.refused.values()), len(gc.garbage)
    gc.set_debug(gc.DEBUG_SAVEALL)
    try:
        flood(20)
        gc.collect()
        kinds = [type(each) for each in gc.garbage[found:]]  # a library that is loaded meanwhile may leave its own
        left = Counter(kind for kind in kinds if kind is FrameType or kind.__module__.startswith("sojourn"))
    finally:
        gc.set_debug(0)
        gc.enable()
        del gc.garbage[found:]
    assert sum(node.counters.refused.values()) > before + len(rows)
    assert not left


def test_garbage_over_the_wire_is_counted_with_its_reason(bench: Bench) -> None:
    """What used to end the executor: the ROS library's own decoding."""
    node = bench.start(ArmNode, "sensors", "drive", "arm")
    bench.connect(node)
    before = len(bench.nodes)
    bench.send("/drive_command", b"\0\1\0\0" + struct.pack("<iI", 0, CONTROL_PERIOD_NS) + b"\xff" * 8)
    bench.until(lambda: node.counters.refused.get("/drive_command"), "it is refused")
    assert "allowed is a serialised sensor_msgs/JointState" in node.counters.last_refusal and len(bench.nodes) == before


def stamped(message: Any, seconds: int) -> Any:
    message.header.stamp = ros_time(seconds * NANOSECONDS)
    return message


@pytest.mark.parametrize("seconds", [HIGHEST_STAMP_S, 1, -5])
@pytest.mark.parametrize("name", ["/joint_states", "/imu/data"])
def test_in_real_time_one_false_stamp_blinds_nobody(bench: Bench, name: str, seconds: int) -> None:
    node = bench.start(DriveNode, "sensors", "drive", lockstep=False)
    bench.connect(node, lockstep=False)
    step(bench, 1)
    send_event(bench, node, "/goal_pose", pose(2.0, 0.0))
    step(bench, 2, 3)
    bench.send(name, stamped(joints(1) if name == "/joint_states" else imu(1), seconds))
    bench.until(lambda: node.counters.refused, "it is refused")
    assert min(rates(step(bench, *range(4, 60)))) > 0.0, "it drives on"
    assert node.counters.refused == {name: 1}
    assert bench.status("/drive/status", 50)["state"] == "moving"


def test_in_real_time_a_false_first_stamp_is_got_over(bench: Bench) -> None:
    node = bench.start(DriveNode, "sensors", "drive", lockstep=False)
    bench.connect(node, lockstep=False)
    bench.send("/imu/data", stamped(imu(1), HIGHEST_STAMP_S))
    bench.until(lambda: node.now, "it has acted on it")
    for period in range(100, 104):
        bench.send("/joint_states", joints(period))
        bench.send("/imu/data", imu(period))
    bench.answer("/drive_command", 103)
    send_event(bench, node, "/goal_pose", pose(2.0, 0.0))
    assert min(rates(step(bench, *range(104, 160)))) > 0.0


@pytest.mark.parametrize("lockstep", [True, False])
def test_a_goal_fails_with_the_reason_where_its_inputs_cannot_be_used(bench: Bench, lockstep: bool) -> None:
    """They go on without the names of the wheels; and it goes on with the next goal when they are back."""
    node = bench.start(DriveNode, "sensors", "drive", lockstep=lockstep)
    bench.connect(node, lockstep=lockstep)
    step(bench, 1)
    send_event(bench, node, "/goal_pose", pose(2.0, 0.0))
    assert min(rates(step(bench, *range(2, 51)))) > 0.0
    for period in range(51, 251):
        spoiled = joints(period)
        spoiled.name = [f"other_{name}" for name in spoiled.name]
        bench.send("/joint_states", spoiled)
        bench.send("/imu/data", imu(period))
        if period % 50 == 0:
            bench.send("/sun_direction", sun(period))
            bench.send("/hazcam/points", cloud(period))
        command = bench.answer("/drive_command", period)
    assert rates(command) == [0.0] * 6
    status = bench.status("/drive/status", 250)
    assert status["state"] == "failed" and "no usable /joint_states or /imu/data for 3" in status["reason"]
    assert "/joint_states.name" in status["reason"], "with what was refused"
    assert rates(step(bench, *range(251, 260))) == [0.0] * 6, "the old goal is not taken up again"
    send_event(bench, node, "/goal_pose", pose(2.0, 0.0))
    assert min(rates(step(bench, *range(260, 301)))) > 0.0
    assert bench.status("/drive/status", 300)["state"] == "moving"


@pytest.mark.parametrize("role", ["drive", "arm"])
def test_in_real_time_a_goal_fails_with_the_reason_where_its_inputs_stay_away(bench: Bench, role: str) -> None:
    """Nothing comes at all: the node says so all the same."""
    node = bench.start(ROLES[role][0], "sensors", role, lockstep=False)
    bench.connect(node, lockstep=False)
    for period in (1, 2):
        bench.send("/joint_states", joints(period))
        bench.until(lambda period=period: node.latest.stamp_of("/joint_states") == at(period), "joints are there")
        bench.send("/imu/data", imu(period))
        bench.until(lambda period=period: node.now == at(period), "it has acted")
    goal = pose(2.0, 0.0) if role == "drive" else joints(0)
    if role == "arm":
        goal.name, goal.position, goal.velocity, goal.effort = [], [], [], []
        goal.header.frame_id = "unfold"
    send_event(bench, node, "/goal_pose" if role == "drive" else "/arm/joint_goal", goal)

    def failed() -> bool:
        received = bench.received[f"/{role}/status"]
        values = {pair.key: pair.value for pair in received[-1].status[0].values} if received else {}
        return values.get("state") == "failed" and "no usable /joint_states or /imu/data for" in values["reason"]

    bench.until(failed, "the goal has failed with the reason")
