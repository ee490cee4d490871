"""How far a goal is, in words: also by a status of somebody else's drive or arm."""

import pytest

from sojourn_operator.goal_progress import to_go


@pytest.mark.parametrize(
    ("who", "values", "words"),
    [
        ("drive", {"distance_to_go": "1.5", "lateral_error_m": "-0.0001", "lateral_rms_m": "0.02", "phase": "drive"},
         "1.5 m to go, +0.000 m beside the path (0.020 m RMS) (drive)"),
        ("drive", {"lateral_error_m": "n/a", "energy_forecast_wh": "?", "energy_used_wh": "?", "reason": "waits"},
         "? m to go, +nan m beside the path (nan m RMS), 0.00 Wh used, 0.00 to go (waits)"),
        ("arm", {"task": "dig"}, "dig has not begun"),
        ("arm", {"progress": "none"}, "0 % done, ? s to go"),
    ],
)  # fmt: skip
def test_whatever_a_status_says_words_are_made_of_it(who: str, values: dict[str, str], words: str) -> None:
    assert to_go(who, values) == words
