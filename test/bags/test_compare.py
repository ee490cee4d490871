"""scripts/compare: its verdict as exit status, its files, and what cannot be compared."""

import json
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "bags"))

from synthetic import PERIOD, SyntheticRun

from sojourn_bags.compare_command import main
from sojourn_bags.reading import read_bag
from sojourn_bags.writer import Attachment
from sojourn_config.command_errors import UsageError

PERIODS = 30


def record(folder: Path, shift: float = 0.0, version: str = "", periods: int = PERIODS) -> Path:
    """Record a short run; from period 20 on it stands `shift` [m] away."""
    run = SyntheticRun(folder, "flat_drive")
    for period in range(1, periods + 1):
        x = 0.1 * period + (shift if period >= 20 else 0.0)
        run.truth(period * PERIOD, (x, 0.0, 0.0, 0.0), {"wheel_front_left_joint": 1.0}, 2.0)
        if period % 10 == 0:
            run.writer.flush()
    if version:
        writer = run.writer._writer
        told = Attachment("versions.json", "application/json", json.dumps({"sojourn_contract": version}).encode())
        writer.add_attachment(0, 0, told.name, told.media_type, told.data)
    run.close(periods * PERIOD)
    return folder


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record(tmp_path_factory.mktemp("compare") / "bag")


def test_a_copy_is_identical(bag: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    copy = shutil.copytree(bag, tmp_path / "copy")
    assert main([str(bag), str(copy), "--exact"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "identical: 90 pairs of messages on 3 topics, every field equal"


def test_a_small_shift_is_tolerated_unless_exact(bag: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    near = record(tmp_path / "near", shift=1e-11)
    assert main([str(bag), str(near)]) == 0
    assert "within tolerance" in capsys.readouterr().out
    assert main([str(bag), str(near), "--exact"]) == 1


def test_a_shift_is_told_with_field_count_size_and_stamp(
    bag: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    far, both, file = record(tmp_path / "far", shift=0.5), tmp_path / "both", tmp_path / "result.json"
    assert main([str(bag), str(far), "--json", str(file), "--bag", str(both)]) == 1
    lines = capsys.readouterr().out.splitlines()
    row = next(line.split() for line in lines if line.startswith("/truth/odom"))
    assert row[:9] == ["/truth/odom.pose.pose.position.x", "11", "of", "30", "11", "0.5", "1e-09", "0.40", "s"]
    assert lines[-1] == "first divergence upstream: /truth/odom at 0.40 s: pose.pose.position.x"
    result = json.loads(file.read_text())
    assert result["verdict"] == "different" and result["a"].startswith(str(bag))
    assert result["first_divergence"] == {
        "topic": "/truth/odom", "what": "pose.pose.position.x", "stamp_ns": 20 * PERIOD,
    }  # fmt: skip
    written = read_bag(both)
    assert written["/truth/odom"].data == read_bag(bag)["/truth/odom"].data
    assert written["/b/truth/odom"].data == read_bag(far)["/truth/odom"].data
    assert written.whole and "sojourn_comparison" in written.records


def test_a_bag_that_is_cut_off_is_compared_as_far_as_it_goes(
    bag: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (file,) = bag.glob("*.mcap")
    whole = file.read_bytes()
    cut = tmp_path / "cut.mcap"
    place, periods = len(whole), PERIODS
    while periods == PERIODS:  # until the last chunk of three is hit
        place -= 100
        cut.write_bytes(whole[:place])
        periods = len(read_bag(cut)["/clock"])
    assert periods == 20
    assert main([str(bag), str(cut)]) == 1, "what is not there cannot be the same"
    text, told = capsys.readouterr()
    assert told == f"{cut} is cut off, so this holds as far as it goes (scripts/recover mends it)\n"
    assert f"{cut}: cut off, so both are compared as far as it is complete" in text
    assert f"identical: {3 * (periods - 1)} pairs" in text


def without(tmp_path: Path, bag: Path) -> tuple[Path, str]:
    return tmp_path / "nothing", "there is no such file or folder"


def no_bag(tmp_path: Path, bag: Path) -> tuple[Path, str]:
    file = tmp_path / "notes.mcap"
    file.write_text("no bag at all, but long enough to be read")
    return file, "it is no MCAP file"


def cut_at_the_start(tmp_path: Path, bag: Path) -> tuple[Path, str]:
    (file,) = bag.glob("*.mcap")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(file.read_bytes()[:60])
    return cut, "holds no message"


def other_version(tmp_path: Path, bag: Path) -> tuple[Path, str]:
    return record(tmp_path / "old", version="0.0.3"), "it was recorded with version 0.0.3 of the contract"


@pytest.mark.parametrize("make", [without, no_bag, cut_at_the_start, other_version])
def test_what_cannot_be_compared_is_said_in_a_sentence(
    make: Callable[[Path, Path], tuple[Path, str]], bag: Path, tmp_path: Path
) -> None:
    wrong, words = make(tmp_path, bag)
    for arguments in ([str(bag), str(wrong)], [str(wrong), str(bag)]):
        with pytest.raises(UsageError, match=words) as caught:
            main(arguments)
        assert "\n" not in str(caught.value) and str(wrong) in str(caught.value)


def test_a_folder_that_holds_a_bag_is_not_written_over(bag: Path) -> None:
    with pytest.raises(UsageError, match="there is a bag in"):
        main([str(bag), str(bag), "--bag", str(bag)])
    with pytest.raises(UsageError, match="cannot be written"):
        main([str(bag), str(bag), "--json", str(bag)])
