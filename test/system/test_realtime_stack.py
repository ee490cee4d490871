"""A stack that runs at the pace of the wall: goals from another terminal, nodes that die, a second start beside it."""

import contextlib
import itertools
import json
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import rclpy
from programs import LONGEST_S, PATIENT, SHORT_RUN, Program
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from verdicts import faults_of_nodes

from domains import domain_to_keep
from sojourn_bags.errors import BagsError
from sojourn_bags.reading import read_bag
from sojourn_config.paths import config_folder

PACE_S = 6.0
WINDOWS = 5
"""Looks at the pace, each of PACE_S; a machine that was busy may be behind in the first ones."""
ROCKING_S = 6.0
"""A machine whose drive dies stops and rocks on the soil, which the new drive cannot tell from speed at once."""
NOTICE_S = 10.0
"""Wall time within which a dead node must be noticed. A quiet machine takes a tenth of a second, a busy one longer."""


class Stack:
    """A running stack: its program, its domain and its folder."""

    def __init__(self, base: Path) -> None:
        self.domain = domain_to_keep()
        self.run_dir = base / "run"
        options = [
            *PATIENT,
            "--realtime",
            "--set",
            "steps=[]",
            "--domain",
            str(self.domain),
            "--run-dir",
            str(self.run_dir),
        ]
        self.program = Program("start", [str(SHORT_RUN), *options], base / "start.log")

    def wait_until_running(self, role: str = "plant", times: int = 1) -> None:
        def runs(text: str) -> bool:
            return sum(": running" in line for line in text.splitlines() if line.startswith(f"{role} ")) >= times

        self.program.wait_until(runs, f"{role} runs")


@pytest.fixture(scope="module")
def stack(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stack]:
    running = Stack(tmp_path_factory.mktemp("realtime"))
    try:
        running.wait_until_running()
        yield running
    finally:
        running.program.end()


def waited_s(process: int) -> float:
    """Time for which a process could have run and did not get a core, since it began [s] (proc(5), schedstat)."""
    return 1e-9 * int(Path(f"/proc/{process}/schedstat").read_text().split()[1])


def is_one(pace: float, unhindered: float) -> bool:
    """Whether simulation time went as fast as the wall clock, but for what others took of the machine."""
    return pace < 1.2 and unhindered > 0.8


def test_simulation_time_keeps_the_pace_of_the_wall(stack: Stack, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FASTRTPS_DEFAULT_PROFILES_FILE", str(config_folder() / "nodes" / "fastdds.xml"))
    context = rclpy.Context()
    context.init(args=[], domain_id=stack.domain)
    node = rclpy.create_node("listener", context=context, enable_rosout=False)
    ticks: list[tuple[float, float]] = []

    def note(message: Clock) -> None:
        ticks.append((time.monotonic(), message.clock.sec + 1e-9 * message.clock.nanosec))

    node.create_subscription(Clock, "clock", note, qos_profile_sensor_data)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    plant = stack.program.process_of("plant")
    paces: list[tuple[float, float]] = []
    """As it was, and as it would have been had the plant not had to wait for a core."""
    try:
        end = time.monotonic() + LONGEST_S
        while len(paces) < WINDOWS and not (paces and is_one(*paces[-1])):
            ticks.clear()
            starved = waited_s(plant)
            while not ticks or ticks[-1][0] - ticks[0][0] < PACE_S:
                assert time.monotonic() < end, "no clock"
                executor.spin_once(timeout_sec=0.1)
            (wall_begin, sim_begin), (wall_end, sim_end) = ticks[0], ticks[-1]
            wall, simulated = wall_end - wall_begin, sim_end - sim_begin
            paces.append((simulated / wall, (simulated + waited_s(plant) - starved) / wall))
    finally:
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()
    assert is_one(*paces[-1]), paces


def test_the_stack_is_judged_while_it_runs(stack: Stack, start: Callable[..., Program], tmp_path: Path) -> None:
    """On a busy machine a node may be late; but nothing else may be wrong."""
    file = tmp_path / "verdict.json"
    check = start("contract_tool", "check", "--live", "--domain", stack.domain, "--seconds", 4, "--json", file)
    status = check.wait()
    verdict = json.loads(file.read_text(encoding="utf-8"))
    assert status == (1 if verdict["violations"] else 0), check.text
    assert not verdict["lockstep"] and set(verdict["participants"]) >= {"plant", "sensors", "drive", "arm", "power"}
    assert not faults_of_nodes(verdict), check.text
    assert verdict["topics"]["/odom"]["messages"] > 50


def test_a_node_that_does_not_run_is_answered_with_those_that_do(stack: Stack, start: Callable[..., Program]) -> None:
    check = start("contract_tool", "check", "--live", "--domain", stack.domain, "--node", "pilot")
    assert check.wait() == 2
    assert "no node 'pilot' takes part, allowed is one of plant, sensors, drive, arm" in check.text


def test_a_goal_is_followed_to_its_end(stack: Stack, start: Callable[..., Program]) -> None:
    goal = start("goal_client", "drive", "0.12", "0.0", "--frame", "base_link", "--domain", stack.domain)
    assert goal.wait() == 0, goal.text
    assert "m to go" in goal.text
    assert goal.text.splitlines()[-1].startswith("reached")


def test_a_goal_too_far_off_is_refused_with_the_reason(stack: Stack, start: Callable[..., Program]) -> None:
    goal = start("goal_client", "drive", "900", "0", "--domain", stack.domain)
    assert goal.wait() == 1
    assert "refused" in goal.text and "allowed are 200.0 m" in goal.text


def test_a_load_is_switched_or_the_reason_is_told(stack: Stack, start: Callable[..., Program]) -> None:
    for switch in ("off", "on"):
        done = start("goal_client", "power", "actuator_heater", switch, "--domain", stack.domain)
        assert done.wait() == 0 and done.text.splitlines()[-1] == "done", done.text
    refused = start("goal_client", "power", "computer", "off", "--domain", stack.domain)
    assert refused.wait() == 1 and "refused: switch of essential load computer" in refused.text


def test_a_dry_run_says_what_it_would_take_and_nothing_moves(stack: Stack, start: Callable[..., Program]) -> None:
    allowed = start(
        "goal_client", "route", "2", "0", "3", "1", "--frame", "base_link", "--dry-run", "--domain", stack.domain
    )
    assert allowed.wait() == 0, allowed.text
    lines = allowed.text.splitlines()
    assert lines[0] == "allowed" and [line.partition(":")[0] for line in lines[1:5]] == [
        "path", "time", "energy", "charge at the end",
    ], allowed.text  # fmt: skip
    refused = start("goal_client", "drive", "900", "0", "--dry-run", "--domain", stack.domain)
    assert refused.wait() == 1 and "allowed are 200.0 m" in refused.text, refused.text


def test_stop_stops(stack: Stack, start: Callable[..., Program]) -> None:
    goal = start("goal_client", "drive", "3", "0", "--frame", "base_link", "--domain", stack.domain)
    goal.wait_until(lambda text: "m to go" in text, "the rover drives")
    stop = start("goal_client", "stop", "--domain", stack.domain)
    assert stop.wait() == 0, stop.text
    assert goal.wait() == 1
    assert goal.text.splitlines()[-1].startswith("stopped")


def test_while_a_stranger_tells_another_time_no_goal_is_sent_and_nobody_is_misled(
    stack: Stack, start: Callable[..., Program], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nodes go by the stamps of what they hear, the client by the clock alone."""
    monkeypatch.setenv("FASTRTPS_DEFAULT_PROFILES_FILE", str(config_folder() / "nodes" / "fastdds.xml"))
    context = rclpy.Context()
    context.init(args=[], domain_id=stack.domain)
    node = rclpy.create_node("stranger", context=context, enable_rosout=False)
    clock, done = node.create_publisher(Clock, "clock", 1), threading.Event()

    def speak() -> None:
        for count in itertools.count():
            if done.wait(0.01):
                return
            false = Clock()
            false.clock.sec = (1000, 0)[count // 100 % 2]  # ahead for a second, then back at the start
            clock.publish(false)

    speaker = threading.Thread(target=speak)
    speaker.start()
    try:
        goal = start("goal_client", "drive", "0.1", "0.0", "--frame", "base_link", "--domain", stack.domain)
        assert goal.wait() == 1 and "2 nodes publish /clock" in goal.text, goal.text
        stop = start("goal_client", "stop", "--domain", stack.domain)
        assert stop.wait() == 0, stop.text
    finally:
        done.set()
        speaker.join()
        node.destroy_node()
        context.try_shutdown()
    goal = start("goal_client", "drive", "0.1", "0.0", "--frame", "base_link", "--domain", stack.domain)
    assert goal.wait() == 0, goal.text


def test_a_second_start_is_refused_and_the_first_goes_on(
    stack: Stack, start: Callable[..., Program], tmp_path: Path
) -> None:
    second = start("start", SHORT_RUN, "--domain", stack.domain, "--run-dir", tmp_path / "second")
    assert second.wait() == 1
    (line,) = second.text.splitlines()
    assert f"domain {stack.domain} is in use" in line and str(stack.program.process.pid) in line
    assert not (tmp_path / "second").exists()
    assert stack.program.process.poll() is None


def test_a_killed_node_is_noticed_and_started_again(stack: Stack, start: Callable[..., Program]) -> None:
    killed = stack.program.process_of("drive")
    noticed: list[float] = []

    def watch() -> None:
        stack.program.wait_until(lambda text: f"drive (process {killed}) was killed by SIGKILL" in text, "noticed")
        noticed.append(time.monotonic())

    watcher = threading.Thread(target=watch)
    watcher.start()
    os.kill(killed, signal.SIGKILL)
    at = time.monotonic()
    watcher.join()
    assert noticed and noticed[0] - at < NOTICE_S
    stack.wait_until_running("drive", times=2)
    time.sleep(ROCKING_S)
    goal = start("goal_client", "drive", "0.06", "0.0", "--frame", "base_link", "--domain", stack.domain)
    assert goal.wait() == 0, goal.text


def standby_of(stack: Stack) -> int:
    """Process of the recorder that waits, not of one that did and records now; 0 where there is none."""
    records = stack.program.process_of("recorder")
    for line in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):
            words = line.read_bytes().split(b"\0")
            is_other = int(line.parent.name) != records
            if (
                is_other
                and b"sojourn_bags.standby" in words
                and any(str(stack.run_dir).encode() in word for word in words)
            ):
                return int(line.parent.name)
    return 0


def test_a_killed_recorder_leaves_a_bag_that_opens_and_its_successor_was_there(stack: Stack) -> None:
    """Twice: after the first death another one waits."""

    def holds_some(bag: Path) -> bool:
        with contextlib.suppress(BagsError):
            return len(read_bag(bag)["/truth/odom"]) > 10
        return False

    bags = [stack.run_dir / name for name in ("bag", "bag_2", "bag_3")]
    for bag in bags[:2]:
        stack.program.wait_until(lambda _: standby_of(stack) > 0, "a recorder waits")
        stack.program.wait_until(lambda _, bag=bag: holds_some(bag), "there is something to lose")
        waits, killed = standby_of(stack), stack.program.process_of("recorder")
        os.kill(killed, signal.SIGKILL)
        words = f"recorder (process {killed}) was killed by SIGKILL: started again as process {waits}"
        stack.program.wait_until(lambda text, words=words: words in text, "it takes over")
        assert not read_bag(bag).whole
    stack.program.wait_until(lambda _: holds_some(bags[2]), "the last one has its own bag")
    stack.program.end()
    assert not standby_of(stack)
    assert read_bag(bags[2]).whole
