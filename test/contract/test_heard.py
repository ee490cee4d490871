"""What a node acted on, told in a heartbeat and read again."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.heard import Acted, Hearing, Took, acted_in, late, took_in

PERIOD = 20_000_000
stamps = st.integers(min_value=0, max_value=10**12)
acts = st.lists(
    st.builds(
        lambda at, imu, cloud: Acted(at, {"/imu/data": imu, "/hazcam/points": cloud}),
        stamps,
        st.none() | stamps,
        st.none() | stamps,
    ),
    max_size=60,
)
goals = st.lists(st.builds(Took, st.sampled_from(("/goal_pose", "/cmd_vel")), stamps, stamps), max_size=10)


@given(acts, goals)
def test_what_is_told_is_what_was_heard(acted: list[Acted], took: list[Took]) -> None:
    hearing = Hearing(tuple(took), list(acted))
    values = hearing.tell()
    assert acted_in(values) == acted
    assert sorted(took_in(values), key=lambda goal: goal.topic) == sorted(took, key=lambda goal: goal.topic)
    assert hearing.tell() == {}, "each once"


def test_an_input_that_a_period_has_not_is_told_as_lost() -> None:
    """A node of others may act on less: its heartbeat ended it."""
    hearing = Hearing(acted=[Acted(20, {}), Acted(40, {"/imu/data": 40}), Acted(60, {"/odom": 50})])
    assert [each.inputs for each in acted_in(hearing.tell())] == [
        {"/imu/data": None, "/odom": None},
        {"/imu/data": 40, "/odom": None},
        {"/imu/data": None, "/odom": 50},
    ]


def test_a_second_of_real_time_is_a_line() -> None:
    hearing = Hearing()
    for period in range(1, 51):
        at = period * PERIOD
        hearing.acted.append(
            Acted(at, {"/imu/data": at, "/hazcam/points": None if period < 11 else at - at % 200_000_000})
        )
    values = hearing.tell()
    assert values["acted"] == "20000000*50" and values["heard /imu/data"] == "0*50"
    assert len(values["heard /hazcam/points"]) < 500


def test_of_a_goal_whose_stamp_says_it_nothing_is_told() -> None:
    """A scripted one takes effect at the first period that is not before its stamp."""
    sent = [("/goal_pose", 0), ("/goal_pose", 90), ("/goal_pose", 100), ("/cmd_vel", 110), ("/cmd_vel", 120)]
    assert late(sent, 100, 120) == tuple(Took("/goal_pose", stamp, 120) for stamp in (0, 90, 100))


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"took /goal_pose": "12"}, "status.values.took /goal_pose"),
        ({"took /goal_pose": "12:-3"}, "PERIOD:STAMP"),
        ({"acted": "1 2", "heard /imu/data": "0"}, "one for each of 2 periods"),
        ({"acted": "-"}, "whole numbers"),
        ({"acted": "1*x"}, "whole numbers"),
        ({"acted": "1*999999999"}, "at most 10000 numbers"),
        ({"acted": "one"}, "whole numbers"),
    ],
)
def test_other_texts_are_refused(values: dict[str, str], words: str) -> None:
    with pytest.raises(RefusedMessageError) as refusal:
        took_in(values)
        acted_in(values)
    assert words in str(refusal.value)
