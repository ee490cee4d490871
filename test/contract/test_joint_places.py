"""Where joints stand in somebody else's messages."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.joint_places import JointPlaces
from sojourn_contract.values import JointState

NAMES = ("wheel", "steer", "elbow", "wrist")


@given(order=st.permutations(NAMES), wanted=st.lists(st.sampled_from(NAMES)))
def test_every_joint_is_found_whatever_the_order_of_the_message(order: list[str], wanted: list[str]) -> None:
    places = JointPlaces("/joint_states", wanted).places(JointState(0, tuple(order)))
    assert [order[place] for place in places] == wanted


def test_a_message_with_other_names_is_looked_at_anew() -> None:
    joints = JointPlaces("/joint_states", ("elbow",))
    assert joints.places(JointState(0, NAMES)).tolist() == [2]
    assert joints.places(JointState(0, ("elbow", "wheel"))).tolist() == [0]


def test_a_missing_joint_is_refused_by_name_and_the_next_good_message_is_taken() -> None:
    joints = JointPlaces("/joint_states", ("elbow",))
    with pytest.raises(RefusedMessageError, match=r"/joint_states\.name = wheel, steer: allowed is elbow among them"):
        joints.places(JointState(0, ("wheel", "steer")))
    assert joints.places(JointState(0, NAMES)).tolist() == [2]
