"""What an operator reads of a dry run."""

import pytest

from sojourn_operator.foresight_words import foresight_lines


@pytest.mark.parametrize(
    ("limit", "said"), [("0.0", "it would stand"), ("0.4", "40% of it now: it goes slower"), ("1.0", "")]
)
def test_a_dry_run_says_that_the_drive_has_no_power(limit: str, said: str) -> None:
    """With its load switched off a route was "allowed", and nothing moved when it was sent."""
    lines = foresight_lines({"asked_state": "allowed", "asked_length_m": "3.0", "power_limit": limit})
    assert [said in line for line in lines if line.startswith("power:")] == ([True] if said else [])
    assert not any(
        line.startswith("power:") for line in foresight_lines({"asked_state": "refused", "power_limit": limit})
    )
