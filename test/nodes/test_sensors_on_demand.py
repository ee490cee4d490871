"""Sensors that measure only while somebody outside of the run listens."""

from collections.abc import Collection
from typing import Any

import numpy as np
import pytest
from node_bench import Bench, at, battery, joints, loads, odometry

from ros_messages import ros_message
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.app import Period
from sojourn_contract.ground import ground_cloud
from sojourn_contract.run_table import table_of
from sojourn_contract.values import JointState, Odometry
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_sensors.app import SensorsApp, SensorsState
from sojourn_sensors.kinds.camera import CameraPair
from sojourn_sensors.node import SensorsNode

LENS = "sensors.navcam.lens={columns: 48, rows: 32, horizontal_view_deg: 45.4}"
BLIND = "drive.visual_odometry=null"
OTHERS = ("sensors.front=null", "sensors.rear=null", "sensors.belly=null", "sensors.powered_by={hazcam: cameras}")
ALONE = ("machine=explorer_cameras", LENS, BLIND, *OTHERS)
ASKED = "sensors.navcam.on_demand=true"
TILT = "kind: inclinometer, link: base_link, range_deg: 30.0, resolution_deg: 0.001, noise_deg: 0.1, bias_deg: 0.2"
LEVEL = f"sensors.level={{{TILT}, on_demand: true}}"
IMAGES = ("/navcam/left/image", "/navcam/right/image", "/navcam/depth")
SEEN = {*IMAGES, "/navcam/left/camera_info", "/navcam/right/camera_info"}


def app_of(*overrides: str) -> SensorsApp:
    return SensorsApp(load_scenario("flat_drive", [*ALONE, *overrides]))


def said_in(
    app: SensorsApp, state: SensorsState, number: int, wanted: Collection[str] = ()
) -> tuple[SensorsState, dict[str, Any]]:
    """State after a control period of a machine that stands, and what was said in it."""
    rest, stamp, still = app._at_rest(), at(number), np.zeros(3)
    pose = Odometry(stamp, "map", "base_link", np.array([0.0, 0.0, 0.45]), np.array([0.0, 0.0, 0.0, 1.0]), still, still)
    zeros = rest.joints.position
    moved = JointState(stamp, rest.joints.names, zeros, zeros, zeros)
    truth = {**rest.inputs, "/truth/odom": pose, "/truth/joint_states": moved, "/truth/motor_states": moved}
    state, answer = app.step(state, Period(stamp, truth, wanted=frozenset(wanted)))
    assert not answer.refusals
    return state, dict(answer.messages)


def with_mast(message: Any) -> Any:
    """Joint states of the explorer with a mast beside."""
    message.name = [*message.name, "mast_pan_joint", "mast_tilt_joint"]
    for numbers in (message.position, message.velocity, message.effort):
        numbers.extend([0.0, 0.0])
    return message


def run(app: SensorsApp, numbers: Collection[int], wanted: Collection[int] = (), topics: Collection[str] = SEEN) -> Any:
    """What is said in each of some control periods, while somebody listens to topics in those that are wanted."""
    state, found = app.initial_state(), {}
    for number in range(1, max(numbers) + 1):
        state, said = said_in(app, state, number, topics if number in wanted else ())
        if number in numbers:
            found[number] = said
    return found


def test_nothing_is_rendered_that_nobody_wants(monkeypatch: pytest.MonkeyPatch) -> None:
    def read(*_: Any) -> Any:
        raise AssertionError("nobody listens")

    monkeypatch.setattr(CameraPair, "read", read)
    said = run(app_of(ASKED), range(1, 101))
    assert all(SEEN.isdisjoint(one) for one in said.values())
    assert "/imu/data" in said[100] and "/hazcam/points" in said[100]


def test_who_listens_is_told_what_everybody_would_be_told() -> None:
    """From the next image on, by any of its topics; and others hear what they would without."""
    always, asked = run(app_of(), (50, 100, 150)), run(app_of(ASKED), (50, 100, 150), range(60, 101), [IMAGES[2]])
    for name in IMAGES:
        assert asked[100][name].data == always[100][name].data and len(asked[100][name].data) > 1000
    assert asked[100].keys() >= SEEN and SEEN.isdisjoint(asked[50]) and SEEN.isdisjoint(asked[150])
    for number in (50, 100, 150):
        others = asked[number].keys() - SEEN
        assert others == always[number].keys() - SEEN
        assert np.array_equal(
            asked[number]["/imu/data"].linear_acceleration, always[number]["/imu/data"].linear_acceleration
        )


def test_what_remembers_its_noise_begins_anew_with_each_listener() -> None:
    topic = "/inclination/level"
    found = run(app_of(LEVEL), range(1, 60), (*range(5, 11), *range(30, 36)), [topic])
    heard = [number for number, said in found.items() if topic in said]
    assert len(heard) > 2 and set(heard) <= {*range(5, 11), *range(30, 36)}
    first = [number for number in heard if number < 20], [number for number in heard if number > 20]
    assert len(first[0]) == len(first[1])
    for one, other in zip(*first, strict=True):
        assert np.array_equal(found[one][topic].vector, found[other][topic].vector)


def test_its_topics_are_neither_recorded_nor_counted() -> None:
    rows = table_of(load_scenario("flat_drive", [*ALONE, ASKED]))
    assert all(row.on_demand and not row.logged for row in rows if row.name in SEEN)
    assert not any(row.on_demand for row in rows if row.name not in SEEN)
    assert all(row.logged for row in table_of(load_scenario("flat_drive", ALONE)) if row.name in SEEN)


@pytest.mark.parametrize(
    ("override", "role"),
    [
        ("sensors.imu.on_demand=true", "the role drive acts on what imu says"),
    ],
)
def test_what_a_role_acts_on_is_not_on_demand(override: str, role: str) -> None:
    with pytest.raises(ConfigError, match=role):
        load_scenario("flat_drive", [*ALONE, override])


def test_a_pair_by_which_the_drive_finds_its_way_is_not_on_demand() -> None:
    seeing = [one for one in ALONE if one != BLIND]
    with pytest.raises(ConfigError, match="the role drive acts on what navcam says"):
        load_scenario("flat_drive", [*seeing, ASKED])


def test_a_node_renders_for_whoever_listens_and_counts_as_before(bench: Bench) -> None:
    overrides = [*ALONE, ASKED, "sensors.powered_by={}"]
    node = bench.start(SensorsNode, "plant", "sensors", overrides=overrides)
    untouched = GroundMemory(0.02, 0.0, 0.0)
    quiet = [name for name in node.endpoints.outputs if name not in SEEN]
    bench.listen(*quiet)
    bench.speak(*node.endpoints.readers)
    bench.met()
    for number in range(1, 151):
        if number == 60:
            bench.listen("/navcam/depth")
            bench.until(lambda: node.endpoints.senders["/navcam/depth"].get_subscription_count() == 1, "it is heard")
            node.poll()
        if number % 5 == 0:
            bench.send("/truth/electrical", battery(number))
            bench.send("/truth/loads", loads(number))
        if number % 50 == 0:
            bench.send("/truth/ground", ros_message(ground_cloud(at(number), untouched, untouched)))
        bench.send("/truth/odom", odometry(number))
        bench.send("/truth/joint_states", with_mast(joints(number)))
        bench.send("/truth/motor_states", with_mast(joints(number)))
        bench.answer("/imu/data", number)
    bench.until(lambda: len(bench.received["/navcam/depth"]) == 2, "both are there")
    assert not any(name in SEEN for name in node.counters.published)
