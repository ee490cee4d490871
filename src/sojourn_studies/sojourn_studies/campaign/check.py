"""A campaign checked before anything starts: its runs with the extreme values of each key are loaded as they will be.

Of a key with numbers these are the runs that have its least and its greatest value, of any other one run for each
value. What is wrong with them is told at once, as for a single run; a combination that only another run has is told in
its row.
"""

from collections.abc import Iterable, Sequence
from pathlib import Path

from sojourn_config.command_errors import UsageError
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import LoadedScenario
from sojourn_operator.scenario_steps import prepare_scenario
from sojourn_studies.campaign.draws import Draw
from sojourn_studies.campaign.row import plain

MOST_TOLD = 8


def telling(runs: Sequence[Draw]) -> list[Draw]:
    """Runs to load before the campaign starts."""
    chosen = {runs[0].number}
    for key in runs[0].values:
        values = [one.values[key] for one in runs]
        if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
            for pick in (min, max):
                chosen.add(pick(runs, key=lambda one: one.values[key]).number)
        else:
            chosen.update(
                {plain(value): one.number for value, one in zip(values[::-1], runs[::-1], strict=True)}.values()
            )
    return [runs[number] for number in sorted(chosen)]


def loaded(runs: Iterable[Draw], file: Path) -> dict[int, LoadedScenario]:
    """What the runs load, by their numbers.

    Raises:
        UsageError: some of them cannot be run; with what is wrong in each.
    """
    found: dict[int, LoadedScenario] = {}
    wrong: dict[str, int] = {}
    for one in runs:
        try:
            scenario = prepare_scenario(one.scenario, one.overrides).loaded
        except ConfigError as error:
            wrong.setdefault(str(error), one.number)
            continue
        if scenario.config.steps:
            found[one.number] = scenario
        else:
            wrong.setdefault(f"{one.scenario} has no steps: a run of a campaign ends with its steps", one.number)
    if wrong:
        told = [f"{file}, run {number}: {words}" for words, number in wrong.items()]
        more = [f"and {len(told) - MOST_TOLD} more"] if len(told) > MOST_TOLD else []
        raise UsageError("\n".join([*told[:MOST_TOLD], *more]))
    return found
