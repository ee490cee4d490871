"""What a node's process gets from us, and what a program that is not ours must not get."""

import os
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from sojourn_bringup.child import last_words
from sojourn_config.ros_environment import foreign_environment, is_ours, own_environment, ros_variables
from sojourn_config.shared_memory import remove_tracing_files

PREFIX = "/somewhere/.venv"
ROS = {"ROS_DOMAIN_ID": "7"}


def test_a_foreign_program_gets_the_outer_values_back() -> None:
    base = {
        "SOJOURN_OUTER": "LD_LIBRARY_PATH PYTHONPATH RMW_IMPLEMENTATION",
        "SOJOURN_OUTER_LD_LIBRARY_PATH": "/opt/ros/jazzy/lib",
        "SOJOURN_OUTER_PYTHONPATH": "",
        "LD_LIBRARY_PATH": f"{PREFIX}/lib/ros_rcl.libs",
        "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
        "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1",
        "HOME": "/elsewhere/me",
    }
    environment = foreign_environment(base, ROS, PREFIX)
    assert environment["LD_LIBRARY_PATH"] == "/opt/ros/jazzy/lib"
    assert "RMW_IMPLEMENTATION" not in environment and "_ROS_WHEELS_BOOTSTRAP_COMPLETE" not in environment
    assert not [name for name in environment if name.startswith("SOJOURN_OUTER")]
    assert environment["HOME"] == "/elsewhere/me" and environment["ROS_DOMAIN_ID"] == "7"


def test_without_outer_values_what_points_into_our_environment_goes() -> None:
    base = {
        "LD_LIBRARY_PATH": f"{PREFIX}/lib:/usr/local/lib",
        "PATH": f"{PREFIX}/bin:/usr/bin",
        "PYTHONPATH": f"{PREFIX}/lib/python3.11/site-packages",
        "VIRTUAL_ENV": PREFIX,
    }
    environment = foreign_environment(base, ROS, PREFIX)
    assert environment == {"LD_LIBRARY_PATH": "/usr/local/lib", "PATH": "/usr/bin", **ROS}


def test_a_folder_that_only_begins_like_ours_is_kept() -> None:
    environment = foreign_environment({"PATH": f"{PREFIX}-other/bin"}, {}, PREFIX)
    assert environment["PATH"] == f"{PREFIX}-other/bin"


def test_our_nodes_get_all_and_one_thread_whatever_is_said_outside() -> None:
    environment = own_environment({"HOME": "/elsewhere/me", "OMP_NUM_THREADS": "3"}, ROS)
    assert environment["HOME"] == "/elsewhere/me" and environment["ROS_DOMAIN_ID"] == "7"
    assert environment["OMP_NUM_THREADS"] == "1" and environment["OPENBLAS_NUM_THREADS"] == "1"


def test_a_foreign_program_computes_as_it_likes() -> None:
    outside = {"OMP_NUM_THREADS": "3", "OPENBLAS_CORETYPE": "Zen", "HOME": "/elsewhere/me"}
    assert foreign_environment(own_environment(outside, {}), ROS, PREFIX) == {**outside, "PYTHONUNBUFFERED": "1", **ROS}


def test_our_own_interpreter_is_ours_and_a_shell_is_not() -> None:
    assert is_ours(sys.executable)
    assert not is_ours("/bin/sh") and not is_ours("/nowhere/at/all")


@pytest.mark.parametrize("on_network", [False, True])
def test_no_profile_uses_shared_memory_and_the_usual_one_stays_on_this_machine(on_network: bool) -> None:
    variables = ros_variables(7, on_network)
    tree = ElementTree.parse(variables["FASTRTPS_DEFAULT_PROFILES_FILE"])
    text = {element.tag.rpartition("}")[2]: (element.text or "").strip() for element in tree.iter()}
    assert text["type"] == "UDPv4" and text["useBuiltinTransports"] == "false"
    addresses = [(e.text or "").strip() for e in tree.iter() if e.tag.rpartition("}")[2] == "address"]
    assert set(addresses) == (set() if on_network else {"127.0.0.1"})
    # the other values make the middleware add transports of its own
    assert variables["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "SYSTEM_DEFAULT"


def test_a_node_listens_on_the_loopback_interface_only_and_makes_no_file(domain: int) -> None:
    """As Linux tells it: every UDP socket of a process with a ROS node, and the shared memory that it maps."""
    code = """
import os, re, rclpy
from pathlib import Path
rclpy.init(args=[])
node = rclpy.create_node("lonely")
node.create_publisher(__import__("std_msgs.msg").msg.Header, "x", 10)
sockets = [os.readlink(link) for link in Path("/proc/self/fd").iterdir() if link.is_symlink()]
inodes = {text[8:-1] for text in sockets if text.startswith("socket:[")}
for line in Path("/proc/net/udp").read_text().splitlines()[1:]:
    fields = line.split()
    if fields[9] in inodes:
        print("udp", fields[1].split(":")[0])
for name in re.findall(r"/dev/shm/(\\S+)", Path("/proc/self/maps").read_text()):
    print("shm", name)
"""
    environment = own_environment(os.environ, ros_variables(domain))
    result = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=600, check=True
    )
    found = [line.split() for line in result.stdout.splitlines()]
    assert {address for kind, address in found if kind == "udp"} == {"0100007F"}  # 127.0.0.1, as the kernel writes it
    assert not [name for kind, name in found if kind == "shm" and "lttng-ust-wait" not in name]


@pytest.mark.parametrize(
    ("log", "words"),
    [
        ("", ""),
        ("one\n\n", "one"),
        (
            "[ERROR] [17.5] [plant]: node 'drive' did not answer\n[INFO] [18.0] [plant]: bye\n",
            "node 'drive' did not answer",
        ),
        ("[INFO] [18.0] [plant]: bye\n", "bye"),
        ("Traceback (most recent call last):\n  File\nsojourn.errors.PlantError: no ground\n", "no ground"),
        ("KeyError: 'x'\n", "'x'"),
    ],
)
def test_the_last_words_of_a_node(tmp_path: Path, log: str, words: str) -> None:
    path = tmp_path / "drive.log"
    path.write_text(log)
    assert last_words(path) == words


def test_a_node_without_a_log_has_no_last_words(tmp_path: Path) -> None:
    assert last_words(tmp_path / "drive.log") == ""


def test_tracing_files_go_unless_another_process_uses_them(tmp_path: Path) -> None:
    mine, used, other = (tmp_path / name for name in ("lttng-ust-wait-1", "lttng-ust-wait-2", "database"))
    for path in (mine, used, other):
        path.write_bytes(bytes(4096))
    code = """
import mmap, sys
with open(sys.argv[1], "r+b") as file:
    mapped = mmap.mmap(file.fileno(), 0)
    print("mapped", flush=True)
    sys.stdin.read()
"""
    user = subprocess.Popen([sys.executable, "-c", code, used], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    try:
        assert user.stdout is not None and user.stdout.readline()
        assert remove_tracing_files(tmp_path) == [mine]
    finally:
        user.communicate()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["database", "lttng-ust-wait-2"]
