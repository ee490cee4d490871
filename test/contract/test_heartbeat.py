"""The heartbeat: what goes in comes out, and other people's diagnostics are left alone."""

from hypothesis import given, settings
from hypothesis import strategies as st

from ros_messages import ros_message, value_of
from sojourn_contract.heartbeat import (
    READY,
    RUNNING,
    STALLED,
    WAITING_FOR,
    Counters,
    heartbeat_message,
    read_heartbeats,
    status_message,
    status_values,
)
from sojourn_contract.topics import ROLES, TOPICS
from sojourn_contract.values import DiagnosticArray, DiagnosticStatus

NAMES = st.sampled_from([row.name for row in TOPICS])
COUNTS = st.dictionaries(NAMES, st.integers(min_value=0, max_value=10**12), max_size=5)


@settings(max_examples=40, deadline=None)
@given(st.sampled_from(ROLES), COUNTS, COUNTS, st.integers(min_value=0, max_value=10**15))
def test_round_trip(role: str, published: dict[str, int], refused: dict[str, int], stamp: int) -> None:
    counters = Counters(published, refused, "the reason" if refused else "")
    message = heartbeat_message(role, STALLED, stamp, counters, "a detail", {WAITING_FOR: "sensors"})
    (beat,) = read_heartbeats(value_of(ros_message(message)))
    assert (beat.role, beat.state, beat.detail, beat.stamp) == (role, STALLED, "a detail", stamp)
    assert (beat.published, beat.refused) == (published, refused)
    assert beat.values[WAITING_FOR] == "sensors"
    assert beat.values.get("last refusal", "") == counters.last_refusal


def test_level_says_how_bad_it_is() -> None:
    counters = Counters()
    assert heartbeat_message("drive", READY, 0, counters).status[0].level == 0
    assert heartbeat_message("drive", STALLED, 1, counters).status[0].level == 2
    counters.count_refused("/joint_states", "NaN")
    counters.count_refused("/joint_states", "again")
    message = heartbeat_message("drive", RUNNING, 1, counters)
    assert message.status[0].level == 1
    assert status_values(message)["refused /joint_states"] == "2"
    assert status_values(message)["last refusal"] == "again"


def test_foreign_diagnostics_are_passed_over() -> None:
    foreign = DiagnosticStatus("cpu", (("load", "0.5"),))
    odd = DiagnosticStatus("odd", (("state", "?"), ("refused /x", "²")))
    beats = read_heartbeats(DiagnosticArray(0, (foreign, odd)))
    assert [beat.role for beat in beats] == ["odd"] and beats[0].refused == {}
    assert read_heartbeats(DiagnosticArray(0, ())) == []
    assert status_values(DiagnosticArray(0, ())) == {}


def test_status_values_round_trip() -> None:
    values = {"state": "idle", "reason": "", "x": "1.5"}
    assert status_values(status_message(20_000_000, "drive", values)) == values
