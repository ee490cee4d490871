"""The policy of access: each role its rows of the contract, and nothing else."""

import subprocess
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
import rclpy
from rclpy.context import Context

from sojourn_bringup import secure, start
from sojourn_bringup.access import SUPERVISOR, access_policy, enclave_of
from sojourn_bringup.monitor import Monitor
from sojourn_bringup.plan import RunPlan
from sojourn_bringup.process_table import process
from sojourn_bringup.supervisor import time_of
from sojourn_config.command_errors import UsageError
from sojourn_config.ros_environment import what_the_network_opens
from sojourn_config.scenario import load_scenario
from sojourn_contract.closed_node import ClosedNode
from sojourn_contract.run_table import table_of
from sojourn_contract.topics import ROLES, STANDARD

Allowed = dict[str, dict[str, set[str]]]


def allowed(policy: str) -> Allowed:
    """Topics by enclave and by what may be done with them."""
    found: Allowed = {}
    for enclave in ElementTree.fromstring(policy).iter("enclave"):
        for topics in enclave.iter("topics"):
            ((what, word),) = topics.attrib.items()
            assert word == "ALLOW"
            found.setdefault(enclave.attrib["path"], {})[what] = {str(one.text) for one in topics}
    return found


def test_what_is_said_can_be_heard_by_those_who_act_on_it_and_by_nobody_else() -> None:
    table = table_of(load_scenario("lunar_sample"))
    found = allowed(access_policy(table, ROLES))
    assert set(found) == {enclave_of(role) for role in (*ROLES, SUPERVISOR)}
    for row in table:
        speakers = {role for role in ROLES if row.name in found[enclave_of(role)]["publish"]}
        hearers = {role for role in ROLES if row.name in found[enclave_of(role)].get("subscribe", set())}
        assert speakers == (set(ROLES) if row.publisher == "all" else {row.publisher} & set(ROLES)), row.name
        assert hearers == set(row.subscribers) & set(ROLES) | ({"recorder"} if row.logged else set()), row.name
    assert found[enclave_of(SUPERVISOR)]["publish"] == {"/parameter_events"}


def test_nobody_but_the_drive_commands_the_wheels_and_nobody_that_flies_hears_the_truth() -> None:
    found = allowed(access_policy(STANDARD, ROLES))
    assert [name for name, can in found.items() if "/drive_command" in can["publish"]] == [enclave_of("drive")]
    for role in ("drive", "arm", "power"):
        heard = found[enclave_of(role)]["subscribe"]
        assert heard and not any(name.startswith("/truth") for name in heard)


def test_roles_that_take_no_part_have_no_keys_and_bundles_go_between_companions() -> None:
    present = ("plant", "sensors", "drive", "recorder")
    found = allowed(access_policy(STANDARD, present, "/one", companions=("plant", "sensors", "drive")))
    assert enclave_of("arm") not in found
    assert "/one/_period/plant" in found[enclave_of("drive")]["subscribe"]
    assert "/one/_period/drive" in found[enclave_of("drive")]["publish"]
    assert all("/one/_period/repeats" in found[enclave_of("drive")][way] for way in ("publish", "subscribe"))
    assert not any(name.startswith("/one/_period") for name in found[enclave_of("recorder")]["subscribe"])
    assert all(name.startswith("/one/") for name in found[enclave_of("plant")]["subscribe"])


@pytest.mark.skipif(secure.has_sros2(), reason="SROS 2 is here, so --secure is not refused")
def test_where_there_is_no_sros_it_is_said_before_anything_starts(tmp_path: object) -> None:
    with pytest.raises(UsageError, match="--secure needs SROS 2"):
        start.main(["flat_drive", "--secure", "--run-dir", f"{tmp_path}/run"])


@pytest.mark.parametrize("option", [("--composed",), ("--direct",), ("--only", "plant"), ("--console",)])
def test_what_it_does_not_go_with(option: tuple[str, ...]) -> None:
    with pytest.raises(UsageError, match="--secure does not go with"):
        start.main(["flat_drive", "--secure", *option])


def test_the_network_is_told_by_its_ports() -> None:
    """DDSI-RTPS 2.3, 9.6.1.1: domain 1 begins at 7650."""
    assert "UDP ports 7650 to 7899" in what_the_network_opens(1)


@pytest.mark.parametrize("inherited", [None, "7"])
def test_keys_are_for_the_domain_of_the_run(
    inherited: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They were for that of the shell, or 0: sros2 takes the domain from the environment."""
    if inherited is None:
        monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    else:
        monkeypatch.setenv("ROS_DOMAIN_ID", inherited)
    seen = list[Mapping[str, str]]()

    def run(command: list[str], env: Mapping[str, str], **_given: Any) -> subprocess.CompletedProcess[str]:
        seen.append(env)
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(subprocess, "run", run)
    secure.make_keystore(RunPlan("flat_drive", tmp_path, ROLES, ROLES, domain=42, secure=True), STANDARD)
    assert [env["ROS_DOMAIN_ID"] for env in seen] == ["42"] and "PATH" in seen[0]


@pytest.fixture
def context(domain: int) -> Iterator[Context]:
    made = Context()
    rclpy.init(args=[], context=made, domain_id=domain)
    yield made
    rclpy.try_shutdown(context=made)


def opened(node: Any) -> dict[str, set[str]]:
    """Names of what a node has open, as its domain sees it."""
    name, namespace = node.get_name(), node.get_namespace()
    found = {
        "publish": node.get_publisher_names_and_types_by_node(name, namespace),
        "subscribe": node.get_subscriber_names_and_types_by_node(name, namespace),
        "reply": node.get_service_names_and_types_by_node(name, namespace),
        "request": node.get_client_names_and_types_by_node(name, namespace),
    }
    return {what: {topic for topic, _ in entries} for what, entries in found.items()}


def assert_may(node: Any, permitted: Mapping[str, set[str]]) -> None:
    """Everything that a node has open is allowed; and it has something open."""
    found = opened(node)
    assert {what: names - permitted.get(what, set()) for what, names in found.items()} == {key: set() for key in found}
    assert found["publish"]


@pytest.mark.parametrize("realtime", [False, True])
@pytest.mark.parametrize("role", ROLES)
def test_a_node_opens_nothing_that_its_role_may_not(
    role: str, realtime: bool, context: Context, tmp_path: Path
) -> None:
    """One that did could not start: what DDS security denies, the ROS library raises."""
    plan = RunPlan("lunar_sample", tmp_path, ROLES, ROLES, realtime=realtime, namespace="/one")
    table = table_of(load_scenario(plan.scenario))
    given = {**plan.parameters(role), "companions": list(plan.companions) or [""]}
    node = process(role).load_class()(context=context, namespace=plan.namespace, overrides=given)
    try:
        policy = access_policy(table, plan.participants, plan.namespace, plan.companions)
        assert_may(node, allowed(policy)[enclave_of(role)])
    finally:
        node.destroy_node()


def test_the_supervisor_opens_nothing_that_it_may_not(tmp_path: Path) -> None:
    plan = RunPlan("lunar_sample", tmp_path, ROLES, ROLES, namespace="/one")
    with Monitor(plan.namespace, {}, time_of(plan)) as monitor:
        assert_may(monitor._node, allowed(access_policy(STANDARD, ROLES, plan.namespace))[enclave_of(SUPERVISOR)])


def test_a_closed_node_opens_nothing_by_itself(context: Context) -> None:
    node = ClosedNode("closed", context=context)
    assert_may(node, {"publish": {"/parameter_events"}})
    node.destroy_node()
