"""The policy of access: each role its rows of the contract, and nothing else."""

from xml.etree import ElementTree

import pytest

from sojourn_bringup import secure, start
from sojourn_bringup.access import SUPERVISOR, access_policy, enclave_of
from sojourn_config.command_errors import UsageError
from sojourn_config.ros_environment import what_the_network_opens
from sojourn_config.scenario import load_scenario
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
