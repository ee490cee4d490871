"""A bag with the topics of some roles alone."""

from pathlib import Path

import pytest

from sojourn_bags.errors import BagExistsError
from sojourn_bags.metadata_file import METADATA_FILE
from sojourn_bags.reading import read_bag
from sojourn_bags.thinning import roles_of, thinned

REFERENCE = Path(__file__).parents[1] / "replay" / "short_goals"


def test_what_a_role_hears_and_says_stays_as_it_was(tmp_path: Path) -> None:
    whole = read_bag(REFERENCE)
    thin = read_bag(thinned(whole, tmp_path / "bag", ("power",)))
    assert thin.whole and roles_of(thin) == ["power"] and "power" in roles_of(whole) and "plant" in roles_of(whole)
    assert {"/bus/state", "/power/switches", "/diagnostics"} <= thin.topics.keys() < whole.topics.keys()
    assert not thin.topics.keys() & {"/truth/odom", "/tf", "/odom", "/joint_states"}
    for name, messages in thin.topics.items():
        assert (messages.data, messages.log_times) == (whole[name].data, whole[name].log_times)
        assert messages.offered_qos == whole[name].offered_qos
    assert thin.attachments == whole.attachments
    assert thin.path.stat().st_size < 0.3 * whole.path.stat().st_size
    assert (tmp_path / "bag" / METADATA_FILE).exists()
    with pytest.raises(BagExistsError):
        thinned(whole, tmp_path / "bag", ("power",))
