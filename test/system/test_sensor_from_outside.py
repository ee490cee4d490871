"""A sensor from a package that is not ours, on a machine that is not ours: registered by an entry point, its rows are
in the machine's runs in every layout, in their bags, and in all verdicts; nothing of this repository is edited.
"""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from outside import Stranger, known_by
from programs import LAYOUTS, PATIENT, PATIENT_BENCH
from verdicts import require_same

from domains import domain_to_keep
from sojourn_bags.comparison import compare
from sojourn_bags.contract_version import check_contract, table_of_bag
from sojourn_bags.judging import judge_bag
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario

SENSOR = '''
"""A laser ranger that looks down: distance to the ground, sensor_msgs/Range."""

from typing import Any, ClassVar

import numpy as np
from builtin_interfaces.msg import Time
from pydantic import Field
from sensor_msgs.msg import Range

from sojourn_contract.codecs.ros_library import serialised
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_machine.sensor_choice import SensorParams
from sojourn_physics.sensors.hazcam import cast_rays, relief_of
from sojourn_physics.sensors.noise import draw, initial_stream
from sojourn_sensors.motion import rotation_matrix
from sojourn_sensors.sensor import Sensor

DISTANCE = FieldRule("range", "m", low=0.0, high=100.0, tolerance=1e-6)
ROW = Topic("/ranger/range", "sensor_msgs/Range", "sensors", (), 5, 0.5, "distance to the ground", (DISTANCE,))


class RangerParams(SensorParams):
    kind: str = "laser_ranger"
    speaks_on: ClassVar[tuple[Any, ...]] = (ROW,)
    link: str = Field(description="link that carries it; it looks along -z")
    reach: float = Field(gt=0.0, le=100.0, description="longest distance [m]")
    noise: float = Field(ge=0.0, le=1.0, description="standard deviation [m]")

    def sensor(self, name, site):
        return Ranger(name, self, site)


class Ranger(Sensor[RangerParams, Any, float]):
    every = ROW.every

    def __init__(self, name, params, site):
        super().__init__(name, params, site)
        self._rotation, self._place = site.mounting(params.link)

    def initial_state(self, truth):
        return initial_stream(self.site.seed, self.name, 1)

    def step(self, state, truth, dt):
        state, noise = draw(state)
        to_map, ground = rotation_matrix(truth.odometry.orientation), self.site.ground
        origin = truth.odometry.position + to_map @ self._place
        down = (to_map @ self._rotation @ np.array([0.0, 0.0, -1.0])).reshape(1, 3)
        (found,) = cast_rays(relief_of(ground), origin, down, 0.5 * ground.resolution, self.params.reach)
        return state, min(max(found + self.params.noise * noise[0], 0.0), self.params.reach)

    def messages(self, stamp, reading):
        said = Range(field_of_view=0.01, max_range=self.params.reach, range=float(reading))
        said.header.frame_id = self.params.link
        said.header.stamp = Time(sec=stamp // 10**9, nanosec=stamp % 10**9)
        yield self.topic, serialised(said)
'''
SENSORS = """
extends: {skid}/sensors.yaml
ranger: {{kind: laser_ranger, link: camera_head_link, reach: 5.0, noise: 0.002}}
ranger_rear: {{kind: laser_ranger, link: avionics_link, reach: 5.0, noise: 0.0}}
"""
SCENARIO = """
description: Ranging while driving
seed: 5
machine: {machine}
body: moon
terrain: {{kind: flat, size_x: 10.0, size_y: 10.0, resolution: 0.1}}
soil: lunar_nominal
start: {{x: 0.0, y: 0.0, yaw: 0.0}}
battery_soc: 0.8
duration_limit_s: 60.0
steps:
  - drive_to: {{x: 0.2, y: 0.0}}
    timeout_s: 30.0
"""
FIRST, FURTHER = "/ranger/range", "/ranger/range/ranger_rear"


@pytest.fixture(scope="module")
def stranger(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stranger]:
    """With a run in each layout, and one of the same machine without his sensors."""
    base = tmp_path_factory.mktemp("stranger")
    config = Path(__file__).resolve().parents[2] / "config" / "machines" / "skid"
    package, machine = base / "lasers", base / "lasered"
    package.mkdir()
    (package / "__init__.py").write_text("", encoding="utf-8")
    (package / "ranger.py").write_text(SENSOR, encoding="utf-8")
    known_by(base, "lasers", "[sojourn.sensors]\nlaser_ranger = lasers.ranger:RangerParams\n")
    shutil.copytree(config, machine)
    (machine / "sensors.yaml").write_text(SENSORS.format(skid=config), encoding="utf-8")
    one = Stranger(base, base / "ranging.yaml")
    one.scenario.write_text(SCENARIO.format(machine=machine), encoding="utf-8")
    try:
        for name, options in LAYOUTS.items():
            given = (*PATIENT, "--domain", domain_to_keep(), *options, "--run-dir", base / name)
            one.call("start", one.scenario, *given)
        bare = ("--set", "sensors.ranger=null", "--set", "sensors.ranger_rear=null", "--direct")
        one.call("start", one.scenario, *PATIENT, *bare, "--run-dir", base / "bare")
        for program in one.programs:
            assert program.wait() == 0, program.text
        yield one
    finally:
        one.end()


@pytest.mark.parametrize("layout", LAYOUTS)
def test_each_layout_has_its_measurements_and_no_gap(stranger: Stranger, layout: str) -> None:
    bag = stranger.bag(layout)
    (account,) = (json.loads(record["topics"]) for name, record in bag.records.items() if "topics" in record)
    for name in (FIRST, FURTHER):
        counts = account[name]
        assert counts["recorded"] == counts["published"] == len(bag[name]) == len(bag["/clock"]) // 5
        assert counts["due"] == counts["recorded"]
    seen = bag[FIRST].column("range")
    truth = bag["/truth/odom"].column("pose.pose.position.z").mean()
    without_noise = bag[FURTHER].column("range")
    assert 0.0005 < np.std(seen) < 0.02 and 0.5 < seen.mean() - truth < 1.5
    assert np.ptp(np.diff(without_noise)) < 0.02 and without_noise.min() > 0.1


def test_every_field_is_the_same_in_every_layout(stranger: Stranger) -> None:
    require_same(stranger.bag("direct"), stranger.bag("processes"))


def test_his_sensors_change_no_number_of_ours(stranger: Stranger) -> None:
    his, bare = stranger.bag("direct").topics, stranger.bag("bare").topics
    assert set(his) - set(bare) == {FIRST, FURTHER}
    ours = set(bare) - {"/diagnostics"}  # which counts what is said
    result = compare({name: his[name] for name in ours}, {name: bare[name] for name in ours})
    # places in the file differ, where his messages stand between ours
    assert not [topic.topic for topic in result.topics if topic.missing or topic.extra or topic.fields]


@pytest.mark.parametrize("layout", LAYOUTS)
def test_the_contract_is_kept_by_what_the_bag_says_of_it(stranger: Stranger, layout: str) -> None:
    """Here his package is not installed: his topics are judged by the contract that the bag carries."""
    bag = stranger.bag(layout)
    check_contract(bag)
    assert table_of_bag(bag).topic(FIRST).fields[0].unit == "m"
    report, _ = judge_bag(bag)
    assert not list(report.lines()) and {FIRST, FURTHER} <= set(report.messages)
    del bag.topics[FURTHER]
    report, _ = judge_bag(bag)
    assert {group.topic for group in report.groups if group.rule == "answer"} == {FURTHER}


def test_our_tools_know_his_topics_in_his_shell(stranger: Stranger) -> None:
    bag, domain = stranger.base / "processes", domain_to_keep()
    replay = stranger.call("replay", bag, "--node", "sensors", "--exact", *PATIENT_BENCH, "--domain", domain)
    check = stranger.call("contract_tool", "check", "--bag", bag)
    same = stranger.call("compare", "--exact", bag, stranger.base / "direct")
    show = stranger.call("contract_tool", "show", "--format", "json", "--scenario", stranger.scenario)
    for program in (replay, check, same, show):
        assert program.wait() == 0, program.text
    assert "identical" in replay.text
    topics = json.loads(show.text)["topics"]
    assert topics[FIRST]["type"] == topics[FURTHER]["type"] == "sensor_msgs/Range"


def test_without_his_package_his_machine_is_refused(stranger: Stranger) -> None:
    with pytest.raises(ConfigError, match="kind of sensor 'laser_ranger' is unknown"):
        load_scenario(str(stranger.scenario))
