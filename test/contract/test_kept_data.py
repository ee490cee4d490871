"""A file that is there whole, or as it was before, or refused."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sojourn_contract.kept_data import KeptData, KeptDataError

VALUES = st.dictionaries(
    st.text(max_size=8),
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=9),
        lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=4), inner, max_size=3),
        max_leaves=9,
    ),
    max_size=5,
)
once = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@once
@given(st.integers(0, 2**62), VALUES, VALUES)
def test_what_was_kept_last_comes_back_to_the_last_bit(tmp_path: Path, stamp: int, first: dict, last: dict) -> None:  # type: ignore[type-arg]
    data = KeptData(tmp_path / "kept" / "drive.json")
    data.write(1, first)
    data.write(stamp, last)
    found = data.read()
    assert found is not None and (found.stamp, found.values) == (stamp, last)
    assert [path.name for path in data.path.parent.iterdir()] == ["drive.json"]


def test_where_nothing_was_kept_there_is_nothing(tmp_path: Path) -> None:
    assert KeptData(tmp_path / "drive.json").read() is None


@once
@given(st.data())
def test_a_file_that_was_cut_or_flipped_is_refused(tmp_path: Path, data: st.DataObject) -> None:
    kept = KeptData(tmp_path / "drive.json")
    kept.write(20_000_000, {"x": 1.25, "covariance": [[1.0, 0.0], [0.0, 2.0]]})
    whole = kept.path.read_bytes()
    place = data.draw(st.integers(0, len(whole) - 1))
    spoilt = whole[:place] if data.draw(st.booleans()) else whole[:place] + b"#" + whole[place + 1 :]
    kept.path.write_bytes(spoilt)
    try:
        found = kept.read()
    except KeptDataError as error:
        assert str(kept.path) in str(error)
    else:  # a stamp of other digits is a stamp
        assert found is not None and found.values == {"x": 1.25, "covariance": [[1.0, 0.0], [0.0, 2.0]]}


def test_a_write_that_fails_leaves_what_was_there(tmp_path: Path) -> None:
    kept = KeptData(tmp_path / "drive.json")
    kept.write(1, {"x": 1.0})
    with pytest.raises(TypeError):
        kept.write(2, {"x": object()})
    kept.path.with_suffix(".new").mkdir()
    with pytest.raises(OSError):
        kept.write(2, {"x": 2.0})
    found = kept.read()
    assert found is not None and found.values == {"x": 1.0}
