"""The last words of a run: how it went, where it is, what tells more of it."""

import shlex
from collections.abc import Iterator

from sojourn_bringup.outcome import Outcome
from sojourn_bringup.plan import RunPlan


def last_words(plan: RunPlan, outcome: Outcome) -> Iterator[str]:
    """Lines for whoever has started a run, also of one that was interrupted."""
    for result in outcome.results:
        reason = f" ({result.reason})" if result.reason else ""
        yield f"{result.start_s:8.2f} s  {result.step}: {result.outcome}{reason}"
    if plan.bag().exists():
        yield f"verdict: {_verdict(plan, outcome)}"
        yield f"it is in {plan.run_dir}; its report: scripts/report {shlex.quote(str(plan.run_dir))} --html"
    else:
        yield f"it is in {plan.run_dir}, without a bag"
    yield f"{outcome.message} after {outcome.sim_time_s:.2f} s of simulation, {outcome.wall_time_s:.1f} s of wall time"


def _verdict(plan: RunPlan, outcome: Outcome) -> str:
    from sojourn_bags.errors import BagsError  # not above: what reads bags is not wanted before the end
    from sojourn_bags.summary import summarise
    from sojourn_bags.summary_reading import read_for_summary

    try:
        return str(summarise(read_for_summary(plan.bag()), wall_time_s=outcome.wall_time_s or None)["verdict"])
    except BagsError as error:
        return f"none: {error}"
