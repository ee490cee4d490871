"""What the measurement of kills makes of what it has seen."""

import argparse
from types import SimpleNamespace
from typing import Any

import pytest

from sojourn_bringup.process_table import ROLE_NAMES
from sojourn_studies import measure_kills
from sojourn_studies.measure_kills import Kill, lacking_s, runs, told


def test_in_real_time_only_the_plant_ends_a_run() -> None:
    given = argparse.Namespace(role=None, kills=2, realtime=True)
    together, *others = runs(given)
    assert together == [role for role in ROLE_NAMES if role != "plant"] * 2, "each in turn"
    assert others == [["plant"], ["plant"]]
    given.realtime = False
    assert list(runs(given)) == [[role] for role in ROLE_NAMES for _ in range(2)]


def test_a_kill_that_is_noticed_late_is_a_failure_and_so_is_much_that_the_bags_lack(
    capsys: pytest.CaptureFixture[str],
) -> None:
    kills = [Kill("drive", 0.25, 1.0, ""), Kill("drive", 0.75, 2.0, ""), Kill("plant", 0.5, None, "")]
    assert told(kills, 0.9)
    assert capsys.readouterr().out.splitlines() == [
        "drive: 2 kills, noticed after 0.50 s, 0.75 s at most, again after 1.50 s, 2.00 s at most",
        "plant: 1 kills, noticed after 0.50 s, 0.50 s at most",
    ]
    assert not told([*kills, Kill("arm", 1.1, 2.0, "")], 0.9)
    assert not told(kills, 1.01)


@pytest.mark.parametrize(
    ("bags", "lacking"),
    [
        ({"bag": (0.02, 20.0)}, 0.0),
        ({"bag": (0.02, 19.0)}, 0.5),
        ({"bag": (0.02, 10.0), "bag_2": (12.0, 20.0)}, 1.0),
        ({"bag": (0.02, 10.0), "bag_2": (10.02, 12.0), "bag_10": (12.02, 20.0)}, 0.01),
    ],
)
def test_what_bags_lack_is_told_in_wall_time(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any, bags: dict[str, tuple[float, float]], lacking: float
) -> None:
    def bag_of(_run: str, folder: Any) -> Any:
        times = SimpleNamespace(log_times=[round(at * 1e9) for at in bags[folder.name]])
        return SimpleNamespace(topics={"/odom": times, "/tf": SimpleNamespace(log_times=[])})

    for name in bags:
        (tmp_path / name).mkdir()
    monkeypatch.setattr(measure_kills, "bag_of", bag_of)
    words = "drive was killed after 19 s of simulation\nit ended after 20.00 s of simulation, 10.0 s of wall time\n"
    stack: Any = SimpleNamespace(run_dir=tmp_path, words=words)
    assert lacking_s(stack) == pytest.approx(lacking, abs=0.0101)
