"""Values with which no role starts: each is refused, in the words that an operator is to read."""

import pytest

from sojourn_bringup.wrong_values import WrongValues, not_refused, refusal, wrong_values
from sojourn_stack.exercise import FLIGHT_ROLES


@pytest.mark.parametrize("wrong", list(wrong_values()), ids=lambda wrong: wrong.name)
def test_wrong_values_are_refused_in_words(wrong: WrongValues) -> None:
    answer = refusal(wrong, FLIGHT_ROLES)
    assert not [part for part in wrong.says if part not in answer], answer
    assert wrong.says


def test_what_is_taken_or_refused_otherwise_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    good = WrongValues("flat_drive", ("battery_soc=0.5",), ("at most",))
    other = WrongValues("flat_drive", ("battery_soc=1.5",), ("a word that nobody says",))
    monkeypatch.setattr("sojourn_bringup.wrong_values.wrong_values", lambda: iter((good, other)))
    taken, otherwise = not_refused(FLIGHT_ROLES)
    assert taken == "flat_drive with battery_soc=0.5: not refused"
    assert otherwise.startswith("flat_drive with battery_soc=1.5: refused with ") and "battery_soc" in otherwise
