"""Runs one candidate beside the node of a running stack and tells how the two compare. scripts/start.py starts it.

It writes what it finds into a file, again and again while the run goes on: see `ShadowReport`.
"""

import argparse
import json
import os
from collections.abc import Sequence
from pathlib import Path

from sojourn_bags.comparison_bag import write_both
from sojourn_bags.comparison_result import Comparison, at
from sojourn_bags.comparison_words import comparison_lines
from sojourn_bags.errors import BagsError, UnansweredError
from sojourn_bags.reading import Bag
from sojourn_bags.replay_harness import ReplaySettings
from sojourn_bags.shadow import NAMESPACE, Shadow, ShadowState
from sojourn_bringup.candidate_process import ProcessCandidate
from sojourn_bringup.shadow_report import DIFFERS, DONE, FAILED, READY, RUNNING, ShadowReport
from sojourn_config import command_line
from sojourn_config.ros_environment import ros_variables
from sojourn_config.scenario import load_scenario
from sojourn_contract.run_table import table_of
from sojourn_contract.stop_flag import StopFlag

FAR_BEHIND = 5
"""Periods that a candidate may be behind without a word."""


def words_of(look: ShadowState) -> str:
    """The state of things in a line."""
    if look.divergence is not None:
        first = look.divergence
        return f"{DIFFERS} since {at(first.stamp)}: {first.topic} {first.what}"
    behind = f", {look.behind} periods behind" if look.behind > FAR_BEHIND else ""
    return f"no difference beyond tolerance up to {at(look.stamp)}{behind}"


def follow(given: argparse.Namespace, stop: StopFlag) -> Comparison:
    """Run the candidate beside the stack until a signal comes, and write a bag with both.

    Raises:
        UnansweredError: the candidate was never ready, ended, or does not answer. BagsError: the bag cannot be written.
    """
    parameters = json.loads(given.parameters)
    report = ShadowReport()
    ros = ros_variables(given.domain, given.network)

    def look(now: ShadowState) -> None:
        report.state, report.detail = RUNNING, words_of(now)
        report.write(given.result)

    settings = ReplaySettings(given.domain, given.namespace, parameters["lockstep_timeout_s"])
    table = table_of(load_scenario(parameters["scenario"], [text for text in parameters.get("overrides", ()) if text]))
    with Shadow(given.role, parameters["participants"], table, parameters["lockstep"], settings) as shadow:
        place = given.namespace + NAMESPACE
        candidate = ProcessCandidate(given.role, given.command, ros, place, given.log, shadow.renamed_inputs())
        shadow.begin(candidate, parameters)
        ShadowReport(READY, "waits for the run").write(given.result)
        comparison = shadow.follow(lambda: stop.is_set, look)
        write_both(given.bag, *shadow.sides(), NAMESPACE, Bag(given.bag), comparison.as_data())
        return comparison


def parser() -> argparse.ArgumentParser:
    """Options of this program; scripts/start.py fills them."""
    result = command_line.Parser(prog="shadow", description=__doc__)
    result.add_argument("--role", required=True)
    result.add_argument("--command", required=True)
    result.add_argument("--parameters", required=True, help="ROS parameters of the role's node, JSON")
    result.add_argument("--result", required=True, type=Path)
    result.add_argument("--bag", required=True, type=Path)
    result.add_argument("--log", required=True, type=Path)
    result.add_argument("--network", action="store_true")
    command_line.add_place(result)
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Shadow one node. Returns 0 once the comparison is written, 1 where the candidate failed."""
    given = parser().parse_args(arguments)
    stop = StopFlag().install()
    os.environ.update(ros_variables(given.domain, given.network))
    ShadowReport().write(given.result)
    try:
        comparison = follow(given, stop)
    except (UnansweredError, BagsError) as error:
        ShadowReport(FAILED, str(error)).write(given.result)
        return 1
    if not comparison.matched:
        ShadowReport(FAILED, "there was nothing to compare: no period of the run has been answered").write(given.result)
        return 1
    lines = comparison_lines(comparison, "ours", "theirs")
    data = {"role": given.role, "command": given.command, **comparison.as_data()}
    ShadowReport(DONE, comparison.verdict.value, lines, data).write(given.result)
    return 0


if __name__ == "__main__":
    command_line.run_script(main)
