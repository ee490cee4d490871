"""Two states of one structure, and where they differ; and what a run that begins with the one cannot come to."""

from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_machine.params import Params
from sojourn_stack.structure import difference, misfit


class Pair(NamedTuple):
    left: object
    right: object


class Held(Params):
    gain: float


plain = st.one_of(st.none(), st.integers(), st.floats(), st.text(max_size=3))
values = st.recursive(
    st.one_of(plain, st.lists(st.floats(), max_size=4).map(np.array), st.floats(0.0, 1.0).map(lambda x: Held(gain=x))),
    lambda inner: st.one_of(
        st.builds(Pair, inner, inner),
        st.tuples(inner, inner),
        st.lists(inner, max_size=3),
        st.dictionaries(st.text(max_size=2), inner, max_size=3),
    ),
    max_leaves=8,
)


@given(values)
def test_a_value_is_of_its_own_structure(value: object) -> None:
    assert difference(value, value, "drive") == misfit(value, value, "drive") == ""


@pytest.mark.parametrize(
    ("one", "other", "words"),
    [
        ({"a": 1.0}, {"a": 2.0}, ""),
        ({"a": 1.0}, {"b": 1.0}, "drive: ['a'] is in one of them alone"),
        ((1, 2), (1, 2, 3), "drive: [2] is in one of them alone"),
        (Pair(1, None), Pair(1, 2), "drive.right: a NoneType in the one, a int in the other"),
        (Pair(1, np.zeros(3)), Pair(1, np.ones(3)), ""),
        ([np.zeros(3)], [np.zeros(4)], "drive[0]: float64 (3,) in the one, float64 (4,) in the other"),
        (np.zeros(3), np.zeros(3, dtype=np.int64), "drive: float64 (3,) in the one, int64 (3,) in the other"),
    ],
)
def test_where_two_differ_is_said(one: object, other: object, words: str) -> None:
    assert difference(one, other, "drive") == words


@pytest.mark.parametrize(
    ("first", "later", "words"),
    [
        (Pair(1, None), Pair(2.5, np.zeros(3)), ""),
        (Pair(1, np.zeros(3)), Pair(True, None), ""),
        (Pair(1, 2), Pair(1, "x"), "drive.right: a str, and the run begins with a int"),
        (Pair(1, 2), Pair(1, np.zeros(3)), "drive.right: a ndarray, and the run begins with a int"),
        (Pair(1, ()), Pair(1, []), "drive.right: a list, and the run begins with a tuple"),
        (np.zeros(3), np.zeros(4), "drive: float64 (4,) and the run begins with float64 (3,)"),
        (np.zeros(3), np.zeros((3, 1)), "drive: float64 (3, 1) and the run begins with float64 (3,)"),
        (np.zeros(3), np.zeros(3, dtype=np.float32), "drive: float32 (3,) and the run begins with float64 (3,)"),
        ((Pair(1, np.zeros(3)),), (Pair(1, np.zeros(4)),), "drive[0].right: float64 (4,) and the run begins with "),
        ((np.zeros((3, 2)),), (np.zeros((5, 2)),), ""),
        ((np.zeros((3, 2)),), (np.zeros(3),), "drive[0]: float64 (3,) and the run begins with float64 (3, 2)"),
        ((), (1, 2), ""),
        ([np.zeros(3)], ["x"], ""),
        ({"a": np.zeros(3)}, {"a": "x"}, ""),
        (Pair(1, Held(gain=1.0)), Pair(1, Pair(1, 2)), ""),
    ],
)
def test_what_a_run_cannot_come_to_is_said(first: object, later: object, words: str) -> None:
    found = misfit(first, later, "drive")
    assert found.startswith(words) and bool(found) == bool(words)
