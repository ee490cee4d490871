"""scripts/campaign: many runs of the whole graph, their values drawn from distributions; a table and a page of them."""

from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line


def parser() -> command_line.Parser:
    """Options of scripts/campaign."""
    result = command_line.Parser(
        prog="campaign",
        description="Do the runs of a campaign: scenario, seeds and any values drawn from distributions. Stopped or "
        "killed, the same command goes on with what is left.",
        epilog="Exit status: 0 every run has its row, whatever became of it; 1 some were lost with their workers, or "
        "because these had no room or memory, and the same command tries them once more; 2 the campaign cannot be; 130 "
        "interrupted.",
    )
    result.add_argument("campaign", nargs="?", metavar="FILE", help="name in config/campaigns, or a YAML file")
    result.add_argument("--out", type=Path, metavar="DIR", help="folder of the campaign (default: runs/campaign_NAME)")
    result.add_argument(
        "--workers", type=command_line.count, metavar="N", help="processes here (default: one for each processor)"
    )
    result.add_argument(
        "--scheduler", metavar="ADDRESS", help="do the runs on the workers of this Dask scheduler: tcp://host:8786"
    )
    result.add_argument(
        "--join", metavar="ADDRESS", help="in place of a campaign: be workers of this Dask scheduler, until Ctrl-C"
    )
    result.add_argument("--dry-run", action="store_true", help="check the campaign and print its runs; start nothing")
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Do a campaign, or be workers of one."""
    options = parser()
    given = options.parse_args(arguments)
    if (given.campaign is None) == (given.join is None):
        options.error("allowed is the file of a campaign, or --join ADDRESS")
    if given.scheduler is not None and given.workers is not None:
        options.error("--workers are processes here: it does not go with --scheduler, which has its own")
    from sojourn_studies.campaign.conduct import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
