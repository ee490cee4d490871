"""How far a campaign is, in words."""

import io

from rich.console import Console

from sojourn_studies.campaign.progress import CampaignProgress
from sojourn_studies.campaign.row import LOST, MET, RAISED


def test_lost_runs_are_told_and_not_judged() -> None:
    progress = CampaignProgress(10, 2, Console(file=io.StringIO()))
    for result in (MET, LOST, RAISED):
        progress.count(result)
    assert progress.words(6.0) == "5 of 10 runs, 50 % of the new met, 1 lost, 2.0 s a run, 10 s to go"
