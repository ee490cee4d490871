"""The folder of a campaign: what is in its journal is done, whatever has become of the process."""

import json
from pathlib import Path

import pytest

from sojourn_config.command_errors import UsageError
from sojourn_studies.campaign.carried import packed
from sojourn_studies.campaign.folder import JOURNAL, open_folder
from sojourn_studies.campaign.row import LOST, MET
from sojourn_studies.campaign.task import Finished

IDENTITY = {"campaign": {"seed": 1, "set": {}}, "versions": {"code": "a"}}


def finished(number: int, result: str = MET, kept: bytes = b"") -> Finished:
    return Finished({"run": number, "result": result}, {"cpu_s": 1.0}, kept)


def test_a_line_that_was_cut_off_is_done_again(tmp_path: Path) -> None:
    with open_folder(tmp_path / "c", IDENTITY) as folder:
        for number in (0, 2, 1):
            folder.take(finished(number))
    journal = tmp_path / "c" / JOURNAL
    whole = journal.read_bytes()
    second = whole.index(b"\n", whole.index(b"\n") + 1) + 1
    for cut in range(second, len(whole)):
        journal.write_bytes(whole[:cut])
        with open_folder(tmp_path / "c", IDENTITY) as folder:
            assert folder.done() == {0, 2}
    with open_folder(tmp_path / "c", IDENTITY) as folder:
        folder.take(finished(1))
    assert [json.loads(line)["row"]["run"] for line in journal.read_text().splitlines()] == [0, 2, 1]


def test_a_run_whose_worker_was_lost_is_tried_again(tmp_path: Path) -> None:
    with open_folder(tmp_path, IDENTITY) as folder:
        folder.take(finished(0, LOST))
        assert folder.done() == set() and folder.rows[0]["result"] == LOST
    with open_folder(tmp_path, IDENTITY) as folder:
        folder.take(finished(0))
        assert folder.done() == {0} and folder.rows[0]["result"] == MET


def test_the_files_of_a_run_are_kept_whole(tmp_path: Path) -> None:
    run = tmp_path / "run"
    (run / "bag").mkdir(parents=True)
    (run / "bag" / "a.mcap").write_bytes(b"\0bag")
    with open_folder(tmp_path / "c", IDENTITY) as folder:
        (folder.place_of(7)).mkdir(parents=True)
        (folder.place_of(7) / "of an attempt before").touch()
        folder.take(finished(7, kept=packed(run)))
        assert [path.name for path in folder.place_of(7).rglob("*")] == ["bag", "a.mcap"]
        assert (folder.place_of(7) / "bag" / "a.mcap").read_bytes() == b"\0bag"
    assert packed(run) == packed(folder.place_of(7)), "nothing of owners and times is in it"


def test_the_folder_of_another_campaign_is_refused(tmp_path: Path) -> None:
    with open_folder(tmp_path, IDENTITY) as folder:
        folder.take(finished(0))
    other = {"campaign": {"seed": 2, "set": {}}, "versions": {"code": "a"}}
    with pytest.raises(UsageError, match="another campaign: campaign: seed differ"), open_folder(tmp_path, other):
        pass
    with open_folder(tmp_path, IDENTITY) as folder:
        assert folder.done() == {0}


def test_a_folder_with_other_things_in_it_is_refused(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").touch()
    with (
        pytest.raises(UsageError, match=r"holds thesis\.txt and is no folder of a campaign"),
        open_folder(tmp_path, IDENTITY),
    ):
        pass
    with pytest.raises(UsageError, match="cannot be written"), open_folder(tmp_path / "thesis.txt" / "c", IDENTITY):
        pass


def test_two_processes_do_not_work_on_one_campaign(tmp_path: Path) -> None:
    with (
        open_folder(tmp_path, IDENTITY),
        pytest.raises(UsageError, match="another process works on this campaign"),
        open_folder(tmp_path, IDENTITY),
    ):
        pass
