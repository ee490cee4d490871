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


def test_what_is_no_number_is_said_as_it_came() -> None:
    """A drive of somebody else answers in words of its own: the program that asked ended."""
    answer = {"asked_state": "allowed", "asked_length_m": "about 3", "asked_time_s": "30", "asked_energy_wh": "nan"}
    lines = foresight_lines({**answer, "asked_charge_at_end": "?", "asked_seen": "n/a", "power_limit": "half"})
    said = [line.partition(":")[2].strip() for line in lines[1:]]
    assert said == ["about 3", "30 s", "nan", "?", "n/a of the path", "the drive is given half of it now"]
