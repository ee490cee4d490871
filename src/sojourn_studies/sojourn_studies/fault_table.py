"""The table of faults against detection: the work of scripts/fault_campaign."""

import argparse
import csv
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

from sojourn_bags.detection import DETECTED, MISSED
from sojourn_studies.fault_runs import NO_FAULT, FaultRun, fault_runs, judged_faults

WIDTH = 120
"""Of the table, whatever the terminal: its names are not cut [characters]."""
COLUMNS = ("scenario", "seed", "fault", "kind", "came_at_s", "outcome", "after_s", "expected")


def run(given: argparse.Namespace) -> int:
    """Run and print; see `fault_campaign`."""
    console = Console(highlight=False, soft_wrap=True, width=WIDTH)
    only = [name.strip() for name in given.only.split(",") if name.strip()]
    seeds = range(given.first_seed, given.first_seed + given.seeds)
    found: list[FaultRun] = []
    for scenario in given.scenarios:
        faults = judged_faults(given.faults or scenario, () if given.faults else given.set, only)
        for one in fault_runs(scenario, faults, seeds, given.set):
            found.append(one)
            console.print(_line(one), markup=False)
            if given.csv is not None:
                write_csv(given.csv, found)
    console.print(table(found))
    return 0 if all(is_good(one) for one in found) else 1


def is_good(one: FaultRun) -> bool:
    """Whether a run went as it should."""
    return one.result is None if one.fault == NO_FAULT else one.result is not None and one.result.outcome == DETECTED


def table(runs: Sequence[FaultRun]) -> Table:
    """A row a scenario and fault: how often it was detected, in which times, how often missed or neither (it did not
    come, or the record does not tell), and how often it was called falsely.
    """
    times_of = ("least [s]", "mean [s]", "most [s]")
    drawn = Table("scenario", "fault", "detected", *times_of, "missed", "not judged", "false alarms")
    for scenario in dict.fromkeys(one.scenario for one in runs):
        of_it = [one for one in runs if one.scenario == scenario]
        false = [one.result.fault for one in of_it if one.fault == NO_FAULT and one.result is not None]
        for name in dict.fromkeys(one.fault for one in of_it if one.fault != NO_FAULT):
            results = [one.result for one in of_it if one.fault == name and one.result is not None]
            times = [one.after_s for one in results if one.outcome == DETECTED and one.after_s is not None]
            told = [f"{number:.1f}" for number in (min(times), sum(times) / len(times), max(times))] if times else []
            ended = [one.outcome for one in results]
            neither = len(ended) - ended.count(DETECTED) - ended.count(MISSED)
            counts = (str(number) for number in (ended.count(MISSED), neither, false.count(name)))
            drawn.add_row(scenario, name, f"{len(times)} of {len(results)}", *(told or ["", "", ""]), *counts)
    return drawn


def write_csv(file: Path, runs: Sequence[FaultRun]) -> None:
    """Every run in a line."""
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(COLUMNS)
        for one in runs:
            result = one.result
            said = ("", "", "", "", "") if result is None else (
                result.kind, result.begin_s, result.outcome, result.after_s, result.expected
            )  # fmt: skip
            writer.writerow((one.scenario, one.seed, one.fault, *said))


def _line(one: FaultRun) -> str:
    words = "no false alarm" if one.result is None else one.result.words
    alarm = f"{one.result.fault}: " if one.fault == NO_FAULT and one.result is not None else ""
    return f"{one.scenario}, seed {one.seed}, {one.fault}: {alarm}{words}"
