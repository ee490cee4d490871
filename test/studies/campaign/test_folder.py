"""The folder of a campaign: what is in its journal is done, whatever has become of the process."""

import errno
import json
import os
from pathlib import Path

import pytest

from sojourn_config.command_errors import UsageError
from sojourn_studies.campaign.carried import packed
from sojourn_studies.campaign.errors import CampaignError
from sojourn_studies.campaign.folder import open_folder
from sojourn_studies.campaign.identity import FILES, JOURNAL, READ
from sojourn_studies.campaign.identity import IDENTITY as IDENTITY_FILE
from sojourn_studies.campaign.row import LOST, MET
from sojourn_studies.campaign.task import Finished

IDENTITY = {"campaign": {"seed": 1, "set": {}}, "versions": {"code": "a"}}


def finished(number: int, result: str = MET, kept: bytes = b"") -> Finished:
    return Finished({"run": number, "result": result}, {"cpu_s": 1.0}, kept)


def full(_: int) -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


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


def test_more_runs_and_fewer_read_other_files(tmp_path: Path) -> None:
    few = IDENTITY | {FILES: {"explorer": "a"}, READ: {"by run 0": "x"}}
    many = IDENTITY | {FILES: {"explorer": "a", "skid": "b"}, READ: {"by run 0": "x", "by run 7": "y"}}
    with open_folder(tmp_path, few) as folder:
        folder.take(finished(0))
    for identity in (many, few, many):
        with open_folder(tmp_path, identity) as folder:
            assert folder.done() == {0}
    changed = many | {FILES: {"explorer": "a", "skid": "c"}}
    with pytest.raises(UsageError, match="another campaign: files: skid differ"), open_folder(tmp_path, changed):
        pass
    further = few | {FILES: {"explorer": "a", "measured": "d"}, READ: {"by run 0": "z"}}
    with pytest.raises(UsageError, match="files read: by run 0 differ"), open_folder(tmp_path, further):
        pass


@pytest.mark.parametrize("bad", [b"\0" * 40, b'{"row": {"run": 1}}', b"[1, 2]", b'"row"', b"", b"\xff\xfe"])
def test_a_line_that_is_no_row_is_passed_over(tmp_path: Path, bad: bytes) -> None:
    with open_folder(tmp_path, IDENTITY) as folder:
        for number in range(3):
            folder.take(finished(number))
    journal = tmp_path / JOURNAL
    lines = journal.read_bytes().splitlines()
    journal.write_bytes(b"\n".join([*lines[:2], bad]) + b"\n")
    with open_folder(tmp_path, IDENTITY) as folder:
        assert folder.done() == {0, 1} and folder.unreadable == [], "at the end it is as one that was cut off"
    assert journal.read_bytes().splitlines() == lines[:2]
    journal.write_bytes(b"\n".join([lines[0], bad, lines[2]]) + b"\n")
    with open_folder(tmp_path, IDENTITY) as folder:
        assert folder.done() == {0, 2} and folder.unreadable == [2]
        folder.take(finished(1))
    with open_folder(tmp_path, IDENTITY) as folder:
        assert folder.done() == {0, 1, 2}


@pytest.mark.parametrize("again", [False, True])
def test_a_folder_that_is_gone_is_named(tmp_path: Path, again: bool) -> None:
    path = tmp_path / "c"
    with open_folder(path, IDENTITY) as folder:
        folder.take(finished(0))
        path.rename(tmp_path / "moved")
        if again:  # as a worker does that needs its place below it
            (path / "work").mkdir(parents=True)
        with pytest.raises(CampaignError, match=r"c: the folder of the campaign was moved or removed while"):
            folder.take(finished(1))
    with open_folder(tmp_path / "moved", IDENTITY) as folder:
        assert folder.done() == {0}


def test_a_folder_that_takes_nothing_more_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with open_folder(tmp_path, IDENTITY) as folder:
        folder.take(finished(0))
        with monkeypatch.context() as patch:
            patch.setattr(os, "fsync", full)
            with pytest.raises(CampaignError, match="cannot be written: No space left on device"):
                folder.take(finished(1))
        assert folder.done() == {0}


def test_a_folder_that_was_full_at_its_first_write_can_be_opened_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was begun there was taken for somebody else's."""
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(UsageError, match="No space left on device"), open_folder(tmp_path, IDENTITY):
            pass
    assert not (tmp_path / IDENTITY_FILE).exists()
    with open_folder(tmp_path, IDENTITY) as folder:
        folder.take(finished(0))
    with open_folder(tmp_path, IDENTITY) as folder:
        assert folder.done() == {0}


def test_what_cannot_be_read_of_a_folder_is_named(tmp_path: Path) -> None:
    with open_folder(tmp_path, IDENTITY) as folder:
        folder.take(finished(0))
    (tmp_path / JOURNAL).unlink()
    (tmp_path / JOURNAL).mkdir()
    with pytest.raises(UsageError, match="cannot be read or written"), open_folder(tmp_path, IDENTITY):
        pass
    (tmp_path / IDENTITY_FILE).write_text("[]", encoding="utf-8")
    with pytest.raises(UsageError, match="does not say of which campaign"), open_folder(tmp_path, IDENTITY):
        pass
