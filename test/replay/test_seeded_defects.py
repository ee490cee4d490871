"""Defects put into our nodes one at a time: the comparison with the recorded answers or the judge of the contract
names the field, and of a node without a defect neither says anything.
"""

import re
from collections.abc import Iterator
from functools import partial
from typing import Any

import pytest
from defects import DEFECTS, SECOND, Defect

from sojourn_bags.candidate import NodeCandidate
from sojourn_bags.candidate_judging import CandidateJudge
from sojourn_bags.comparison import until
from sojourn_bags.comparison_result import Comparison
from sojourn_bags.errors import UnansweredError
from sojourn_bags.judging import machine_of
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.replay import replay
from sojourn_bags.replay_choices import ROLES_TO_REPLAY
from sojourn_bags.replay_harness import ReplaySettings
from sojourn_bags.replay_script import script_of
from sojourn_bags.run_configuration import RunConfiguration, run_configuration
from sojourn_bringup.process_table import process
from sojourn_bringup.references import default_reference
from sojourn_contract.conformance.findings import Report

INDEX = re.compile(r"\[[^\]]*\]")
PLANT_S = 7
"""Of the plant's run only so much: it takes longest, and by then the rover drives [s]."""


@pytest.fixture(scope="module")
def run() -> Iterator[tuple[Bag, RunConfiguration]]:
    bag = read_bag(default_reference())
    with run_configuration(bag) as configuration:
        yield bag, configuration


def defective(found: Defect | None, node_class: Any, **given: Any) -> Any:
    node = node_class(**given)
    if found is not None:
        found.put_in(node)
    return node


def tried(
    run: tuple[Bag, RunConfiguration], role: str, found: Defect | None, domain: int
) -> tuple[Comparison, Report, set[str], set[str]]:
    """Comparison and report, and what each of them names."""
    bag, configuration = run
    if role == "plant":
        bag = Bag(bag.path, False, until(bag.topics, PLANT_S * SECOND), bag.attachments, bag.records)
    judge = CandidateJudge(script_of(bag, role), machine_of(bag))
    candidate = NodeCandidate(partial(defective, found, process(role).load_class()))
    comparison = replay(bag, role, candidate, configuration, ReplaySettings(domain), judge).comparison
    report = judge.finish()
    differs = {INDEX.sub("", field.name) for field in comparison.fields if field.beyond}
    differs |= {f"{topic.topic} missing" for topic in comparison.topics if topic.missing}
    judged = {f"{group.topic}.{INDEX.sub('', group.first[0].finding.field)}" for group in report.groups}
    return comparison, report, differs, judged


@pytest.mark.parametrize("role", ROLES_TO_REPLAY)
def test_a_node_without_a_defect_is_clean(role: str, run: tuple[Bag, RunConfiguration], domain: int) -> None:
    comparison, report, differs, _ = tried(run, role, None, domain)
    assert comparison.matched and not differs
    assert sum(report.messages.values()) >= comparison.matched and not list(report.lines())


@pytest.mark.parametrize("found", [each for each in DEFECTS if ": " not in (each.replay or "")], ids=lambda d: d.name)
def test_a_defect_is_caught_and_its_field_named(found: Defect, run: tuple[Bag, RunConfiguration], domain: int) -> None:
    _, report, differs, judged = tried(run, found.role, found, domain)
    if found.replay is None:
        assert not differs
    else:
        assert found.replay in differs
    if found.judge is None:
        assert not judged, list(report.lines())
    else:
        assert found.judge in judged


@pytest.mark.parametrize("found", [each for each in DEFECTS if ": " in (each.replay or "")], ids=lambda d: d.name)
def test_an_endpoint_that_nobody_meets_is_named(found: Defect, run: tuple[Bag, RunConfiguration], domain: int) -> None:
    """Nothing comes of such a node, so there is nothing to compare or to judge but the endpoint."""
    with pytest.raises(UnansweredError, match=f"{found.role} cannot take part: {found.replay} = "):
        tried(run, found.role, found, domain)


def test_there_are_twenty_and_more_in_every_node() -> None:
    assert len(DEFECTS) >= 20
    assert {found.role for found in DEFECTS} == set(ROLES_TO_REPLAY)
