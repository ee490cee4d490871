"""The contract shown, and messages judged by it: the work of scripts/contract."""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sojourn_bags.candidate_judging import judge_candidate
from sojourn_bags.compare_runs import read_runs
from sojourn_bags.contract_version import table_of_bag
from sojourn_bags.cut_off import unless_cut_off
from sojourn_bags.errors import BagsError
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag
from sojourn_bringup.bench_options import candidate_of
from sojourn_bringup.candidate_bench import bench, replay_settings
from sojourn_bringup.contract_live import LiveSource
from sojourn_bringup.contract_screen import show_contract, show_report
from sojourn_bringup.contract_tool import SCENARIO
from sojourn_bringup.process_table import check_roles
from sojourn_bringup.screen import wide_console
from sojourn_config.command_errors import UsageError
from sojourn_config.scenario import load_scenario
from sojourn_contract.conformance.findings import Report
from sojourn_contract.conformance.judge import Judge
from sojourn_contract.conformance.machine import JudgedMachine
from sojourn_contract.description import contract_data
from sojourn_contract.page import contract_page
from sojourn_contract.topic_table import TopicTable
from sojourn_operator.scenario_steps import named_scenario

Checked = tuple[Report, dict[str, Any], list[Bag]]
"""Verdict, where it is from, and the bags that were read."""


def _check_options(given: argparse.Namespace) -> None:
    """Raise UsageError for options that do not belong together."""
    if given.exec is None and given.role is not None:
        raise UsageError("contract: --role is for --exec; to judge one role of a bag or a stack give --node")
    if given.exec is not None and given.node is not None:
        raise UsageError("contract: --node is for --bag and --live; with --exec give --role")
    if given.exec is not None and given.role is None:
        raise UsageError("contract: --exec needs --role: whom it stands in for")


def show_as(form: str, machine: JudgedMachine) -> None:
    """Print the contract as a table, as JSON or as a page."""
    if form == "html":
        print(contract_page(machine), end="")
    elif form == "json":
        print(json.dumps(contract_data(machine.table) | {"machine": machine.as_data()}, indent=2, ensure_ascii=False))
    else:
        show_contract(wide_console(), machine)


def _check_bag(given: argparse.Namespace) -> Checked:
    roles = None if given.node is None else check_roles((given.node,), "--node")
    machine = _machine(given)
    try:
        bag = read_bag(given.bag)
        report, run = judge_bag(bag, roles, machine)
    except BagsError as error:
        raise UsageError(str(error)) from error
    return report, _facts(str(bag.path), table_of_bag(bag), run.lockstep, run.participants, run.notes), [bag]


def _check_live(given: argparse.Namespace) -> Checked:
    machine = _machine(given) or _machine_of(SCENARIO)
    with LiveSource(given.domain, given.namespace, machine.table) as source:
        stack = source.find()
        roles = tuple(stack.nodes) if given.node is None else (stack.role_of(given.node),)
        judge = Judge(machine, lockstep=stack.lockstep, participants=tuple(stack.nodes), roles=roles, from_start=False)
        stack.judge_endpoints(judge, roles)
        listened = source.listen(stack, judge, given.seconds)
    report = judge.finish()
    mode = "lock-step" if stack.lockstep else "real time"
    notes = [f"{mode}, listened for {listened:.1f} s of wall time, {judge.simulated_s:.2f} s of simulation"]
    what = f"the stack on domain {given.domain}{given.namespace}"
    return report, _facts(what, machine.table, stack.lockstep, tuple(stack.nodes), notes), []


def _check_program(given: argparse.Namespace) -> Checked:
    role, command = candidate_of(given.exec, given.role)
    machine = _machine(given)
    (bag,) = read_runs([given.reference])
    with bench(given, role, command, bag) as (candidate, configuration):
        report = judge_candidate(bag, role, candidate, configuration, replay_settings(given), machine)
    notes = [f"alone as {role}, with what {role} heard in {bag.path}"]
    return report, _facts(command, table_of_bag(bag), True, (role,), notes), [bag]


def _machine(given: argparse.Namespace) -> JudgedMachine | None:
    """The machine that --scenario or --machine names; None where neither is given."""
    if given.scenario is None and given.machine is None:
        return None
    return JudgedMachine.of_scenario(named_scenario(given.scenario, given.machine, SCENARIO))


def _machine_of(scenario: str) -> JudgedMachine:
    return JudgedMachine.of_scenario(load_scenario(scenario))


def _facts(
    source: str, table: TopicTable, lockstep: bool, participants: Sequence[str], notes: Sequence[str]
) -> dict[str, Any]:
    contract = contract_data(table)
    return {
        "source": source,
        "contract": {"version": contract["version"], "digest": contract["digest"]},
        "lockstep": lockstep,
        "participants": list(participants),
        "notes": list(notes),
    }


def _write_json(file: Path, data: dict[str, Any]) -> None:
    try:
        file.write_text(json.dumps(data, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    except OSError as error:
        raise UsageError(f"--json: {file} cannot be written: {error}") from error


def run(given: argparse.Namespace) -> int:
    """Show or check. 0 without a violation, 1 with any, 2 if there was nothing to judge."""
    if given.command == "show":
        show_as(given.format, _machine(given) or _machine_of(SCENARIO))
        return 0
    _check_options(given)
    judge = _check_live if given.live else _check_program if given.exec is not None else _check_bag
    report, facts, bags = judge(given)
    if not report.messages:
        raise UsageError(f"{facts['source']}: there was no message to judge")
    show_report(wide_console(), report, facts["notes"], facts["source"])
    if given.json is not None:
        _write_json(given.json, facts | report.as_data())
    return unless_cut_off(1 if report.violations else 0, bags)
