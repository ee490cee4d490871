"""scripts/contract: what it shows, and the one sentence for what it cannot judge."""

import json
import re
import subprocess
import sys
import time
from html.parser import HTMLParser
from pathlib import Path

import pytest
from clean_run import PERIOD, CleanRun, explorer
from recorded_run import write

from sojourn_bags.provenance import contract_attachment
from sojourn_bringup import contract_tool
from sojourn_bringup.contract_live import FOUND_S, LiveStack
from sojourn_config.command_errors import UsageError
from sojourn_config.scenario import load_scenario
from sojourn_contract.conformance.endpoints import Endpoint
from sojourn_contract.conformance.judge import Judge
from sojourn_contract.description import contract_data, contract_differences
from sojourn_contract.run_table import table_of
from sojourn_contract.topics import ROLES, TOPICS, inputs_of, outputs_of

WORDS = (
    "Lock-step", "Heartbeats", "published /topic", "ready", "running", "0.02 s", "best effort, keep last 1",
    "reliable, keep last 10", "wheel_rear_left_joint", "arm_turret_joint", "survival_heater", "unfold",
)  # fmt: skip
VOID = {"meta", "br"}


class Page(HTMLParser):
    """Checks that elements are closed in their order, and keeps links, anchors and text."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.links: set[str] = set()
        self.anchors: set[str] = set()
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("href", "src"):
                self.links.add(value or "")
            if name == "id":
                self.anchors.add(value or "")
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data + " "


def page(capsys: pytest.CaptureFixture[str]) -> Page:
    assert contract_tool.main(["show", "--format", "html"]) == 0
    parsed = Page()
    parsed.feed(capsys.readouterr().out)
    return parsed


def test_the_page_opens_offline_and_its_links_lead_somewhere(capsys: pytest.CaptureFixture[str]) -> None:
    found = page(capsys)
    assert not found.open
    assert found.links and all(link.startswith("#") for link in found.links), "nothing is loaded from elsewhere"
    assert {link[1:] for link in found.links} <= found.anchors


def test_page_and_table_hold_what_a_flight_team_needs(capsys: pytest.CaptureFixture[str]) -> None:
    texts = [page(capsys).text]
    assert contract_tool.main(["show"]) == 0
    texts.append(capsys.readouterr().out)
    for text in texts:
        plain = " ".join(text.split())
        for row in TOPICS:
            assert row.name in plain and row.type in plain, row.name
            for rule in row.fields:
                assert rule.path in plain, (row.name, rule.path)
        for word in WORDS:
            assert word in plain, word


def test_json_is_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert contract_tool.main(["show", "--format", "json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    table = table_of(load_scenario("flat_drive"))
    assert list(shown["topics"]) == [row.name for row in table]
    assert shown["digest"] == contract_data(table)["digest"]
    assert shown["machine"]["joints"]["steer_front_left_joint"] == {
        "group": "steer",
        "held_by": "position",
        "kind": "revolute",
        "lower": -1.6,
        "upper": 1.6,
        "velocity": 0.35,
    }


def test_the_digest_changes_with_the_interface_and_not_with_a_tolerance() -> None:
    from dataclasses import replace

    def digest(row: int, **change: object) -> str:
        rows = list(TOPICS)
        rows[row] = replace(rows[row], **change)
        return contract_data(rows)["digest"]

    place = [row.name for row in TOPICS].index("/odom")
    ours = contract_data()["digest"]
    assert digest(place) == ours
    tuned = tuple(replace(rule, tolerance=1.0, low=-1.0, rate_tolerance=9.0) for rule in TOPICS[place].fields)
    assert digest(place, fields=tuned, max_age_s=7.0, meaning="") == ours
    for change in ({"every": 5}, {"type": "std_msgs/Header"}, {"frames": ("map",)}, {"publisher": "arm"}, {"lag": 5}):
        assert digest(place, **change) != ours, change
    degrees = (replace(TOPICS[place].fields[0], unit="km"), *TOPICS[place].fields[1:])
    changed = contract_data([replace(row, fields=degrees) if row.name == "/odom" else row for row in TOPICS])
    (line,) = contract_differences(changed, contract_data())
    assert line.startswith("/odom: units is") and "km" in line


def test_a_good_bag_and_a_bad_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good = write(tmp_path / "good", CleanRun(), contract=contract_attachment())
    assert contract_tool.main(["check", "--bag", str(good)]) == 0
    assert "keeps the contract: no violation in 1460 messages" in capsys.readouterr().out
    run = CleanRun()
    run.one("/odom").header.frame_id = "map"
    bad, file = write(tmp_path / "bad", run, contract=contract_attachment()), tmp_path / "verdict.json"
    assert contract_tool.main(["check", "--bag", str(bad), "--json", str(file)]) == 1
    told = capsys.readouterr().out
    assert "/odom at 0.82 s: header.frame_id = 'map' (allowed: 'odom')" in told
    assert re.search(r"/odom\s+110\s+1\s+header.frame_id", told)
    verdict = json.loads(file.read_text(encoding="utf-8"))
    assert verdict["violations"] == 1 and verdict["contract"]["digest"] == contract_data()["digest"]
    (group,) = verdict["groups"]
    assert group["first"][0] == {
        "rule": "frame",
        "topic": "/odom",
        "stamp_ns": 41 * PERIOD,
        "field": "header.frame_id",
        "value": "'map'",
        "allowed": "'odom'",
    }
    assert contract_tool.main(["check", "--bag", str(bad), "--node", "arm"]) == 0


def test_what_is_no_bag(tmp_path: Path) -> None:
    text = tmp_path / "text.mcap"
    text.write_text("no bag", encoding="utf-8")
    for path, words in ((text, "is no MCAP file"), (tmp_path / "nothing", "no such file or folder")):
        with pytest.raises(UsageError, match=words) as error:
            contract_tool.main(["check", "--bag", str(path)])
        assert error.value.exit_status == 2 and "\n" not in str(error.value)


def test_a_role_that_does_not_exist(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"role 'pilot' is unknown, allowed is one of plant"):
        contract_tool.main(["check", "--bag", str(tmp_path), "--node", "pilot"])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--exec", "true"], "--exec needs --role"),
        (["--exec", "true", "--role", "pilot"], "--role: role 'pilot' is unknown, allowed is one of plant"),
        (["--exec", "a 'b", "--role", "drive"], "the command cannot be read"),
        (["--exec", "true", "--role", "drive", "--node", "drive"], "with --exec give --role"),
        (["--exec", "true", "--role", "drive", "--reference", "/nowhere"], "/nowhere cannot be read as a bag"),
        (["--exec", "true", "--role", "drive", "--reference", __file__], "it is no MCAP file"),
        (["--bag", "x", "--role", "drive"], "--role is for --exec"),
    ],
)
def test_a_program_that_cannot_be_judged(arguments: list[str], words: str) -> None:
    with pytest.raises(UsageError, match=words) as error:
        contract_tool.main(["check", *arguments])
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("arguments", [["check"], ["check", "--live", "--bag", "x"], ["show", "--format", "pdf"], []])
def test_bad_options(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        contract_tool.main(arguments)
    assert ended.value.code == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1


def test_nothing_runs() -> None:
    begin = time.monotonic()
    command = [sys.executable, "-m", "sojourn_bringup.contract_tool", "check", "--live", "--domain", "228"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600.0, check=False)
    assert done.returncode == 2 and time.monotonic() - begin > FOUND_S
    assert done.stderr.splitlines() == [
        "no stack runs on domain 228: nobody publishes /clock (start one with scripts/start.py)"
    ]


def stack(lockstep: bool = True) -> LiveStack:
    """A stack in which each role has the endpoints that it should."""
    endpoints: dict[str, list[tuple[str, Endpoint]]] = {row.name: [] for row in TOPICS}
    for role in ROLES:
        for row in outputs_of(role):
            endpoints[row.name].append((role, Endpoint(row.type)))
        for row in inputs_of(role):
            endpoints[row.name].append((role, Endpoint(row.type, publishes=False)))
    return LiveStack(lockstep, {role: role for role in ROLES}, endpoints)


def endpoint_kinds(live: LiveStack, *roles: str) -> set[tuple[str, str, str]]:
    judge = Judge(explorer(), lockstep=live.lockstep, participants=ROLES, roles=roles)
    live.judge_endpoints(judge, roles)
    return {(group.rule, group.topic, group.first[0].finding.field) for group in judge.report.groups}


def test_endpoints_of_a_running_stack() -> None:
    assert not endpoint_kinds(stack(), *ROLES)
    live = stack()
    live.endpoints["/odom"] = [entry for entry in live.endpoints["/odom"] if entry[0] != "drive"]
    live.endpoints["/waypoints"] = [entry for entry in live.endpoints["/waypoints"] if entry[0] != "drive"]
    live.endpoints["/drive_command"].append(("another", Endpoint("sensor_msgs/JointState")))
    asks_for_more = Endpoint("sensor_msgs/Imu", durability="transient_local", publishes=False)
    live.endpoints["/imu/data"].append(("viewer", asks_for_more))
    assert endpoint_kinds(live, "drive") == {
        ("endpoint", "/odom", "publisher of drive"),
        ("endpoint", "/waypoints", "subscription of drive"),
        ("endpoint", "/drive_command", "publishers"),
    }
    assert not endpoint_kinds(live, "arm"), "the affair of others"


def test_a_node_is_found_by_its_own_name_too() -> None:
    live = stack()
    live.nodes["drive"] = "my_drive"
    assert live.role_of("my_drive") == live.role_of("drive") == "drive"
    with pytest.raises(UsageError, match="allowed is one of plant"):
        live.role_of("his_drive")
