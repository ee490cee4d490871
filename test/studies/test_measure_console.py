"""How much an open page slows a stack: who reads it, and what is made of the paces."""

import argparse
import time
from pathlib import Path

import pytest

from sojourn_console.gate import GuardedServer
from sojourn_studies import measure_console
from sojourn_studies.measure_console import ADDRESS, main, measure, reader


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


def test_what_counts_is_the_median_of_pairs_in_turns(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    runs: list[bool] = []

    def paced(given: argparse.Namespace, with_page: bool, run_dir: Path) -> tuple[float, int]:
        runs.append(with_page)
        return (10.0, 0) if not with_page else (9.8, 2_000_000) if len(runs) < 5 else (5.0, 0)

    monkeypatch.setattr(measure_console, "paced", paced)
    assert measure(argparse.Namespace(pairs=3), tmp_path)
    assert runs == [False, True, True, False, False, True]
    assert "slower by +2.0 % in the median of 3 pairs" in capsys.readouterr().out
    assert main(["--pairs", "1"]) == 1, "a page that halves the pace is too dear"
