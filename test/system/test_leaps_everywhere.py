"""A run whose clock leaps is the same without middleware and in many processes."""

from itertools import pairwise
from pathlib import Path

from programs import HERE, LAYOUTS, PATIENT
from test_same_everywhere import records
from verdicts import require_same

LEAPING = (str(HERE.parent / "stack" / "leaping.yaml"), *PATIENT, "--set", "steps=[{wait_s: 130.0}]")


def test_leaps_are_the_same_in_all_layouts(tmp_path: Path) -> None:
    bags = records(tmp_path, {name: ((*LEAPING, *options), {}) for name, options in LAYOUTS.items()}, 0)
    require_same(bags["direct"], bags["processes"])
    clock = bags["direct"].topics["/clock"].log_times
    assert max(after - before for before, after in pairwise(clock)) >= 50_000_000_000
