"""Checkpoints of nodes, in one process or many, are those of a run without middleware, and go on as those."""

import zipfile
from pathlib import Path

import pytest
from programs import HERE, PATIENT
from test_same_everywhere import records
from verdicts import require_same

from sojourn_bags.reading import Bag, read_bag
from sojourn_bringup.checkpoints import last_before
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_stack.checkpoint import read

FAULTS = (
    "faults=[{kind: motor_dead, joint: wheel_front_left_joint, at: 1.5, until: 3.0},"
    "{kind: sensor, sensor: imu, of: angular_velocity, bias: 0.05, at: 2.0, lasts: 1.5}]"
)
WAYS = ("composed", "direct", "processes")
RUN = (str(HERE / "short_run.yaml"), *PATIENT, "--set", "seed=11", "--set", FAULTS)


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Bag]]:
    """Folder and bags of the same run in each layout."""
    folder, every = tmp_path_factory.mktemp("kept"), ("--checkpoint-every", "0.7")
    options = {way: ((*RUN, f"--{way}", *every), dict[str, str]()) for way in WAYS}
    return folder, records(folder, options, 0)


def parts(file: Path) -> dict[str, bytes]:
    """All that a checkpoint holds."""
    with zipfile.ZipFile(file) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_the_files_are_the_same_to_the_last_bit(runs: tuple[Path, dict[str, Bag]]) -> None:
    folder, bags = runs
    direct = sorted((folder / "direct" / "checkpoints").iterdir())
    assert len(direct) > 8
    for way in ("composed", "processes"):
        require_same(bags[way], bags["direct"])
        files = sorted((folder / way / "checkpoints").iterdir())
        assert [file.name for file in files] == [file.name for file in direct], way
        for one, other in zip(files, direct, strict=True):
            assert parts(one) == parts(other), (way, one.name)


def test_what_goes_on_from_one_is_the_run(runs: tuple[Path, dict[str, Bag]], tmp_path: Path) -> None:
    folder, _ = runs
    state, _ = read(last_before(folder / "composed", 3.0))
    assert state.roles["operator"].goals.arrivals == 0 < state.roles["drive"].goals.arrivals
    assert state.now == 140 * CONTROL_PERIOD_NS
    options = ("--from", str(folder / "composed"), "--at", "3.0", "--checkpoint-every", "0.7", *PATIENT)
    rest = records(tmp_path, {way: ((*options, f"--{way}"), {}) for way in WAYS[:2]}, 0)
    unbroken = read_bag(folder / "direct")
    for messages in unbroken.topics.values():
        messages.take_out({n for n, at in enumerate(messages.log_times) if at <= state.now})
    later = {name: messages.data for name, messages in unbroken.topics.items() if len(messages)}
    assert sum(len(data) for data in later.values()) > 3000
    for way, bag in rest.items():
        assert {name: messages.data for name, messages in bag.topics.items()} == later, way
        assert bag.records["sojourn_completeness"]["gaps"] == ""
        kept = sorted((tmp_path / way / "checkpoints").iterdir())
        assert len(kept) > 5
        assert all(parts(file) == parts(folder / "direct" / "checkpoints" / file.name) for file in kept), way
    require_same(rest["composed"], rest["direct"])
