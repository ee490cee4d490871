"""The process table against the contract, and what a run refuses before anything starts."""

import importlib.util
import itertools
import json
from dataclasses import replace

import pytest
import yaml

from sojourn_bringup.plan import RunPlan, check_lockstep, replacement_of
from sojourn_bringup.process_table import PROCESSES, ROLE_NAMES, check_roles, process
from sojourn_config.command_errors import UsageError
from sojourn_contract.barrier import Barrier, awaited_inputs
from sojourn_contract.node import ContractNode
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import ROLES, outputs_of


def test_the_table_has_the_roles_of_the_contract_once_each() -> None:
    assert sorted(ROLE_NAMES) == sorted(ROLES)
    assert len(set(ROLE_NAMES)) == len(ROLE_NAMES)


def test_a_run_is_stopped_from_the_plant_to_the_recorder() -> None:
    assert ROLE_NAMES[0] == "plant" and ROLE_NAMES[-1] == "recorder"


@pytest.mark.parametrize("row", PROCESSES, ids=ROLE_NAMES)
def test_every_row_names_a_node_that_is_there(row) -> None:
    assert issubclass(row.load_class(), ContractNode)
    module = importlib.util.find_spec(row.module)
    assert module is not None
    if module.submodule_search_locations:  # a package runs by its __main__
        assert importlib.util.find_spec(f"{row.module}.__main__") is not None


def test_an_unknown_role_is_answered_with_the_valid_names() -> None:
    with pytest.raises(UsageError, match=r"'wheels'.*allowed is one of plant, operator, sensors"):
        process("wheels")
    with pytest.raises(UsageError, match="--without"):
        check_roles(["drive", "dirve"], "--without")


@pytest.mark.parametrize("left_out", [(), ("arm",), ("power",), ("operator",), ("recorder",), ("drive", "operator")])
def test_lockstep_runs_without_roles_that_nobody_needs(left_out) -> None:
    check_lockstep([role for role in ROLES if role not in left_out])


def test_lockstep_refuses_a_run_that_would_stand_still() -> None:
    with pytest.raises(UsageError, match="without sensors"):
        check_lockstep([role for role in ROLES if role != "sensors"])


def test_every_set_of_roles_that_is_allowed_could_go_on() -> None:
    """By playing it: each role acts when the inputs that it awaits have been sent, and sends what it owes then."""
    for count in range(len(ROLES)):
        for others in itertools.combinations(ROLES[1:], count):
            present = ("plant", *others)
            try:
                check_lockstep(present)
            except UsageError:
                assert not _goes_on(present), present
            else:
                assert _goes_on(present), present


def _goes_on(present: tuple[str, ...], periods: int = 160) -> bool:
    """Whether the plant reaches the last period."""
    barriers = {
        role: Barrier(awaited_inputs(role, present), role == "plant")
        for role in present
        if awaited_inputs(role, present)
    }
    owed = {role: [row for row in outputs_of(role) if row.publisher == role and row.every] for role in present}

    def send(role: str, period: int) -> None:
        for row in owed[role]:
            if period % row.every:
                continue
            for barrier in barriers.values():
                if any(awaited.name == row.name for awaited in barrier.awaited):
                    barrier.offer(row, period * CONTROL_PERIOD_NS, object())

    if "plant" not in barriers:
        return True
    send("plant", 1)
    progress = True
    while progress and barriers["plant"].period < periods:
        progress = False
        for role, barrier in barriers.items():
            if not barrier.missing():
                period = barrier.period
                barrier.take()
                send(role, period + 1 if role == "plant" else period)
                progress = True
    return barriers["plant"].period >= periods


def test_nodes_hear_each_other_in_bundles_where_they_are_ours_start_here_and_go_in_lockstep(tmp_path) -> None:
    started = tuple(role for role in ROLES if role != "power")
    plan = RunPlan("flat_drive", tmp_path, ROLES, started, replacements={"drive": "their drive"})
    assert plan.companions == ("plant", "sensors", "arm", "operator", "recorder")
    assert any(text.startswith("companions:=") for text in plan.ros_arguments("arm"))
    assert not any(text.startswith("companions:=") for text in plan.ros_arguments("drive"))
    assert not replace(plan, realtime=True).companions


def test_parameters_survive_the_command_line(tmp_path) -> None:
    """What ROS reads from the arguments as YAML is what a composed node gets."""
    plan = RunPlan("2024", tmp_path, ROLES, ROLES, overrides=("seed=3",), lockstep_timeout_s=10, namespace="/mars")
    arguments = plan.ros_arguments("recorder")
    given = dict(text.split(":=", 1) for text in arguments if ":=" in text)
    assert given.pop("__ns") == "/mars"
    read = {name: yaml.safe_load(text) for name, text in given.items()}
    assert read.pop("companions") == list(ROLES)
    assert read == plan.parameters("recorder")
    assert isinstance(read["lockstep_timeout_s"], float) and isinstance(read["scenario"], str)
    assert json.loads(given["participants"]) == list(ROLES)


def test_a_recorder_started_again_writes_another_bag(tmp_path) -> None:
    plan = RunPlan("flat_drive", tmp_path, ROLES, ROLES)
    assert plan.parameters("recorder", 0)["bag"] != plan.parameters("recorder", 1)["bag"]


@pytest.mark.parametrize("text", ["drive", "drive=", "drive='", "=", "drive=  "])
def test_a_replacement_without_a_command_is_refused(text: str) -> None:
    with pytest.raises(UsageError, match="--replace"):
        replacement_of(text)


def test_a_replacement_is_a_role_and_its_command() -> None:
    assert replacement_of("drive=env A=B python3 x.py --y") == ("drive", "env A=B python3 x.py --y")
