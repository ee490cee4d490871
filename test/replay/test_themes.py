"""Each theme bag is what it should be: its roles give the answers of the run again, and the contract is kept."""

import zlib

import numpy as np
import pytest
from theme_bags import app_and_bag, bag_of

from sojourn_bags.comparison_result import Verdict
from sojourn_bags.comparison_words import comparison_lines
from sojourn_bags.digest import digest
from sojourn_bags.judging import judge_bag
from sojourn_bags.thinning import roles_of
from sojourn_bringup.record_reference import DIGEST
from sojourn_bringup.references import REFERENCES, THEMES, ReferenceBag, references_folder
from sojourn_contract.tolerance import rule_of
from sojourn_stack.replay import replay

RENEW = "if this is meant, renew the bags: scripts/record_reference"
MOST_BYTES = 10_000_000
"""Of all theme bags, as git packs them: some 0.3 MB for each of 35 machines, tasks and faults. A third is what the
machine measures at 50 Hz, which no role can be replayed without."""
PLACE, JUMP = "/initialpose", "the change of pose"
"""An operator's word moves the estimate at once, which no velocity explains."""
SILENCED = "themes/restarts"
"""Its drive does not hear, or hears late, what moves it: its odometry stands still and leaps."""
GIVEN = {"/waypoints", "/arm/path", "/arm/joint_trajectory"}
"""What is commanded, by somebody outside: it is not computed."""
NAMES = [theme.name for theme in THEMES]
CASES = [(theme.name, role) for theme in THEMES for role in theme.roles]


@pytest.mark.parametrize(("name", "role"), CASES)
def test_an_app_gives_the_answers_of_the_run(name: str, role: str) -> None:
    with app_and_bag(name, role) as (bag, app):
        comparison = replay(bag, role, app).comparison
    told = "\n".join([*comparison_lines(comparison, "recorded", "replayed"), RENEW])
    assert comparison.verdict is not Verdict.DIFFERENT, told
    assert comparison.matched > 50


@pytest.mark.parametrize("theme", THEMES, ids=NAMES)
def test_a_bag_is_thinned_whole_and_clean(theme: ReferenceBag) -> None:
    bag = bag_of(theme.name)
    assert bag.whole and tuple(roles_of(bag)) == theme.roles
    assert not [name for name in bag.topics if name.startswith("/truth")]
    report, run = judge_bag(bag)
    told = [line for line in report.lines() if not (PLACE in bag and line.startswith("/odom at ") and JUMP in line)]
    told = [line for line in told if not (theme.name == SILENCED and line.startswith("/odom"))]
    assert not told and report.messages
    assert any("the others were not judged" in note for note in run.notes)
    assert (references_folder() / theme.name / DIGEST).read_text(encoding="utf-8") == digest(bag), RENEW


def test_all_are_small_and_each_has_its_scenario() -> None:
    folder = references_folder() / "themes"
    packed = [zlib.compress(file.read_bytes()) for file in folder.rglob("*") if file.is_file()]
    assert sum(map(len, packed)) < MOST_BYTES
    assert {f"themes/{file.stem}" for file in folder.glob("*.yaml")} == set(NAMES)


@pytest.mark.parametrize("name", [*NAMES, REFERENCES[0].name])
def test_every_number_that_is_computed_has_a_tolerance(name: str) -> None:
    """One that has none must be equal to the last bit, and another processor's may not be: the attitudes of a plan
    were.
    """
    bag, without = bag_of(name), set()
    for topic in bag.topics.keys() - GIVEN:
        for group in bag[topic].groups:
            for path, number in group.layout.numbers.items():
                if number.dtype.kind == "f" and rule_of(topic, path) is None:
                    values = group.layout.column(group.rows, path)
                    changes = (values != values[:1]) & np.isfinite(values) & np.isfinite(values[:1])
                    without |= {f"{topic}.{path}"} if changes.any() else set()
    assert not without
