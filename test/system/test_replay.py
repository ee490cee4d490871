"""scripts/replay as people use it: our nodes as processes, programs of others, and all that goes wrong."""

import json
import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from programs import PATIENT, PATIENT_BENCH, Program

from domains import domain_to_keep
from sojourn_bags.candidate import NodeCandidate
from sojourn_bags.comparison_result import Verdict
from sojourn_bags.comparison_words import comparison_lines
from sojourn_bags.errors import ReplayError
from sojourn_bags.reading import read_bag
from sojourn_bags.replay import replay
from sojourn_bags.replay_choices import ROLES_TO_REPLAY
from sojourn_bags.replay_harness import ReplaySettings
from sojourn_bags.replay_script import script_of
from sojourn_bags.run_configuration import run_configuration
from sojourn_bringup.process_table import process
from sojourn_stack.replay import app_of
from sojourn_stack.replay import replay as replay_app

BAG = Path(__file__).parents[1] / "replay" / "short_goals"
FLIGHT_DRIVE = Path(__file__).parent / "flight_drive.py"
Start = Callable[..., Program]

PERIOD_OF_DEATH = """
import os, signal
from sojourn_drive.node import DriveNode
from sojourn_contract import process

class Mortal(DriveNode):
    def on_period(self, stamp, inputs, goals):
        if stamp == 2_000_000_000:
            {last_deed}
        super().on_period(stamp, inputs, goals)

process.run(Mortal)
"""

CARELESS = """
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sojourn_contract import process
from sojourn_contract.types import message_class
from sojourn_drive.node import DriveNode

BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)

class Careless(DriveNode):
    def create_publisher(self, kind, name, profile, **named):
        if name == "odom":
            kind, profile = message_class("{type}"), {profile}
        return super().create_publisher(kind, name, profile, **named)

    def create_subscription(self, kind, name, take, profile, **named):
        if name == "imu/data":
            take, profile, named = print, {imu}, {{}}
        return super().create_subscription(kind, name, take, profile, **named)

process.run(Careless)
"""


def program_file(folder: Path, text: str) -> str:
    """A command that runs a program of one file in our environment."""
    file = folder / "candidate.py"
    file.write_text(text, encoding="utf-8")
    return f"{sys.executable} {file}"


@pytest.fixture(scope="module")
def run_here(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of this machine: the reference may be of another one, that rounds in another way."""
    folder = tmp_path_factory.mktemp("replayed")
    arguments = [str(BAG.parent / "short_goals.yaml"), *PATIENT, "--composed", "--domain", str(domain_to_keep())]
    arguments += ["--set", "steps=[{drive_to: {x: 0.1, y: 0.0}, timeout_s: 1.5}]", "--run-dir", str(folder / "run")]
    program = Program("start", arguments, folder / "log.txt")
    try:
        assert program.wait() == 1, "the goal cannot be reached in so short a time"
    finally:
        program.end()
    return folder / "run"


@pytest.mark.parametrize("role", ROLES_TO_REPLAY)
def test_our_nodes_reproduce_a_run_of_this_machine_exactly(role: str, run_here: Path, domain: int) -> None:
    bag = read_bag(run_here)
    with run_configuration(bag) as configuration:
        candidate = NodeCandidate(process(role).load_class())
        result = replay(bag, role, candidate, configuration, ReplaySettings(domain, "", 300.0, 600.0))
    assert result.comparison.verdict is Verdict.IDENTICAL, "\n".join(comparison_lines(result.comparison))
    assert result.comparison.matched == sum(len(messages) for messages in result.script.recorded.values())


def test_our_node_as_a_process_reproduces_it_too(run_here: Path, start: Start, domain: int, tmp_path: Path) -> None:
    file, both = tmp_path / "result.json", tmp_path / "both"
    options = (*PATIENT_BENCH, "--exact", "--json", file, "--bag", both, "--domain", domain)
    program = start("replay", run_here, "--node", "drive", *options)
    assert program.wait() == 0, program.text
    assert program.text.splitlines()[-1].startswith("identical: ")
    assert not program.leaves_processes()
    result = json.loads(file.read_text())
    assert (result["role"], result["verdict"]) == ("drive", "identical")
    bag = read_bag(both)
    assert bag["/replay/odom"].data == bag["/odom"].data == read_bag(run_here)["/odom"].data
    assert bag["/replay/odom"].log_times == bag["/odom"].log_times


def test_a_run_in_real_time_is_replayed_by_what_its_nodes_heard(start: Start, domain: int, tmp_path: Path) -> None:
    """Whatever the machine has lost or delayed: each node tells on what it acted."""
    scenario = BAG.parent / "themes" / "skid.yaml"
    options = ("--realtime", "--composed", "--domain", domain, "--run-dir", tmp_path / "run")
    run = start("start", scenario, *PATIENT, *options, "--set", "duration_limit_s=3.0")
    assert run.wait() == 1, "the steps take longer"
    bag = read_bag(tmp_path / "run")
    with run_configuration(bag) as configuration:
        for role, topic in (("drive", "/odom"), ("power", "/power/switches")):
            result = replay_app(bag, role, app_of(role, configuration))
            assert result.comparison.verdict is Verdict.IDENTICAL, "\n".join(comparison_lines(result.comparison))
            assert len(result.answers[topic]) > 10
    with pytest.raises(ReplayError, match="recorded in real time: it is replayed without middleware, --direct"):
        script_of(bag, "drive")


def test_a_program_that_drives_in_another_way_is_told_apart(start: Start, domain: int) -> None:
    command = f"{sys.executable} {FLIGHT_DRIVE}"
    program = start("replay", BAG, "--exec", command, "--role", "drive", "--domain", domain, *PATIENT_BENCH)
    assert program.wait() == 1, program.text
    assert "/drive_command.velocity" in program.text
    assert "first divergence upstream: " in program.text
    assert not program.leaves_processes()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("import time; time.sleep(1000)", "drive is not ready after 3 s of wall time: it does not publish /odom"),
        ("import sys; sys.exit('no wheels found')", "ended with status 1: no wheels found (it was not ready yet)"),
        (
            PERIOD_OF_DEATH.format(last_deed="os.kill(os.getpid(), signal.SIGKILL)"),
            "was killed by SIGKILL (it had not answered /odom stamped 2.00 s)",
        ),
        (
            CARELESS.format(type="nav_msgs/Odometry", profile="BEST_EFFORT", imu=10),
            "drive cannot take part: /odom: qos.reliability = a publisher that is best_effort (allowed: reliable): "
            "it never reaches the listeners of the contract",
        ),
        (
            CARELESS.format(type="nav_msgs/Path", profile=10, imu=10),
            "drive cannot take part: /odom: type = nav_msgs/Path (allowed: nav_msgs/Odometry): "
            "it never reaches the listeners of the contract",
        ),
        (
            CARELESS.format(type="nav_msgs/Odometry", profile=10, imu="LATCHED"),
            "drive cannot take part: /imu/data: qos.durability = a subscription that asks for transient_local "
            "(allowed: volatile): it never hears the publishers of the contract",
        ),
        (
            # it ignores SIGINT besides, and has a child
            "import subprocess\nsubprocess.Popen(['sleep', '1000'])\n"
            + PERIOD_OF_DEATH.format(
                last_deed="signal.signal(signal.SIGINT, signal.SIG_IGN)\n            while True: signal.pause()"
            ),
            "drive does not answer: /odom stamped 2.00 s is missing after 5 s of wall time",
        ),
    ],
    ids=["mute", "ends at once", "killed", "wrong QoS", "wrong type", "latched input", "hangs"],
)
def test_a_candidate_that_never_answers_or_dies(
    text: str, words: str, start: Start, domain: int, tmp_path: Path
) -> None:
    command = program_file(tmp_path, text)
    limits = list(PATIENT_BENCH)
    if words.startswith("drive is not ready"):
        limits[1] = "3"
    elif words.startswith("drive does not answer"):
        limits[3] = "5"
    program = start("replay", BAG, "--exec", command, "--role", "drive", "--domain", domain, *limits)
    assert program.wait() == 1, program.text
    assert words in program.text.splitlines()[-1]
    assert not program.leaves_processes()


def test_interrupted(start: Start, domain: int, tmp_path: Path) -> None:
    command = program_file(tmp_path, "import time; print('here', flush=True); time.sleep(1000)")
    log = tmp_path / "candidate.log"
    program = start("replay", BAG, "--exec", command, "--role", "drive", "--domain", domain, "--log", log)
    program.wait_until(lambda _: log.exists() and "here" in log.read_text(), "the candidate has started")
    program.send(signal.SIGTERM)
    assert program.wait() == 130
    assert not program.leaves_processes()


def test_a_bag_that_is_cut_off_is_replayed_as_far_as_it_goes(start: Start, domain: int, tmp_path: Path) -> None:
    (whole,) = (BAG / "bag").glob("*.mcap")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: int(0.6 * os.path.getsize(whole))])
    program = start("replay", cut, "--node", "power", "--domain", domain, *PATIENT_BENCH)
    assert program.wait() == 1, program.text
    first, verdict, last = program.text.splitlines()
    assert "which is cut off: as far as it goes" in first
    assert verdict.startswith(("identical: ", "within tolerance: "))  # the bag may be of another machine
    assert last == f"{cut} is cut off, so this holds as far as it goes (scripts/recover mends it)"
