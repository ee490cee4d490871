"""Supervises a run of stand-in nodes: python fake_run.py RUN_DIR DOMAIN lockstep|realtime ROLE=MANNER ...

A MANNER is one of fake_role.py, or `!` and a whole command.
"""

import json
import sys
from dataclasses import asdict
from pathlib import Path

from rich.console import Console

from sojourn_bringup.plan import RunPlan
from sojourn_bringup.screen import PlainScreen
from sojourn_bringup.supervisor import Supervisor

FAKE = Path(__file__).parent / "fake_role.py"


def main() -> int:
    """Run it; the outcome is the last line on the standard output, as JSON."""
    run_dir, domain, kind = Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
    manners = dict(text.split("=", 1) for text in sys.argv[4:])
    plan = RunPlan(
        scenario="flat_drive",
        run_dir=run_dir,
        participants=tuple(manners),
        started=tuple(manners),
        replacements={
            role: manner[1:] if manner.startswith("!") else f"{sys.executable} {FAKE} {role} {manner}"
            for role, manner in manners.items()
        },
        realtime=kind == "realtime",
        domain=domain,
        start_timeout_s=600.0,
        lockstep_timeout_s=300.0,
    )
    outcome = Supervisor(plan, PlainScreen(Console(highlight=False, soft_wrap=True, width=1000))).run()
    print(json.dumps(asdict(outcome)), flush=True)
    return outcome.status


if __name__ == "__main__":
    sys.exit(main())
