"""How much an open page slows a stack: who reads it, when it is open, and what is made of the paces."""

import argparse
import time
from pathlib import Path

import pytest

from domains import own_domain
from sojourn_console.gate import GuardedServer
from sojourn_studies import measure_console
from sojourn_studies.measure_console import ADDRESS, main, measure, paced, reader


def test_a_reader_is_shown_what_the_page_shows() -> None:
    server = GuardedServer("page", 8790)
    try:
        found = ADDRESS.search(f"console: {server.address}")
        assert found is not None
        with reader(found[1]) as read:
            end = time.monotonic() + 60.0
            before = 0
            for number in (1, 2):
                server.scene.add_label(f"/label{number}", "here")
                while read[0] <= before and time.monotonic() < end:
                    time.sleep(0.01)
                assert read[0] > before
                before = read[0]
    finally:
        server.stop()


def test_what_counts_is_the_mean_of_times_with_the_page_against_those_round_them(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paces = [(10.0, 9.9, 9.8), (9.8, 9.0, 9.2), (9.2, 9.4, 9.2)]
    monkeypatch.setattr(measure_console, "paced", lambda *_: iter(paces))
    assert measure(argparse.Namespace(), tmp_path)
    assert "slower by +1.1 % in the mean of 3, standard deviation 2.3 %" in capsys.readouterr().out
    monkeypatch.setattr(measure_console, "paced", lambda *_: iter([(10.0, 9.4, 10.0)]))
    assert main(["--times", "1"]) == 1, "a page that takes six per cent is too dear"


def test_the_page_is_opened_beside_one_run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(measure_console, "SETTLES_S", 0.5)
    monkeypatch.setattr(measure_console, "WINDOW_S", 2.0)
    with own_domain() as domain:
        given = argparse.Namespace(
            scenario="flat_drive", machine=None, set=[], realtime=False, processes=False, domain=domain, times=2
        )
        found = list(paced(given, tmp_path))
    assert len(found) == 2 and found[0][2] == found[1][0]
    assert all(pace > 0.0 for one in found for pace in one)
    assert [path.name for path in sorted(tmp_path.glob("page-*.log"))] == ["page-0.log", "page-1.log"]
