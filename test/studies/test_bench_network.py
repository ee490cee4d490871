"""What a rich power network costs a period: the machine that is measured, and how turns are told."""

import math
from pathlib import Path

import pytest

from sojourn_config.scenario import load_scenario
from sojourn_studies import bench_network
from sojourn_studies.bench_network import COST, TimedTurn


def test_the_rich_machine_has_what_the_plain_one_lacks(tmp_path: Path) -> None:
    rich = load_scenario("mars_sol", [f"machine={bench_network.write_rich_machine(tmp_path)}"])
    plain = load_scenario("mars_sol", ["machine=explorer"])
    assert list(rich.power.all_stores) == ["battery", "capacitors"] and len(plain.power.all_stores) == 1
    assert [source.kind for source in rich.power.sources.values()] == ["photovoltaic_array", "radioisotope_generator"]
    assert rich.thermal is not None and len(rich.thermal.nodes) == 10 and plain.thermal is None
    assert rich.power.loads == plain.power.loads


def test_both_loops_run_side_by_side() -> None:
    found = bench_network.bench_network(2)
    plain, rich = (found[f"{name} network, a period [us]"] for name in ("plain", "rich"))
    assert plain > 0.0 and rich > 0.0 and math.isfinite(found[COST])


def test_a_look_ahead_is_spread_over_its_minute_and_a_disturbed_turn_does_not_count() -> None:
    """By hand: 4 % turn by turn; a look of 0.7 s beside one of 0.1 s, over sixty turns of 0.1 s: 10 %."""
    plain = [TimedTurn(0.1, False)] * 9 + [TimedTurn(0.2, True)]
    rich = [TimedTurn(0.104, False)] * 6 + [TimedTurn(3.0, False)] + [TimedTurn(0.104, False)] * 2
    rich.append(TimedTurn(0.804, True))
    assert bench_network.figures(plain, rich)[COST] == pytest.approx(14.0)
    assert bench_network.figures(plain[:5], rich[:5])[COST] == pytest.approx(4.0)


def test_a_look_in_a_slow_moment_counts_as_one_in_a_quick_one() -> None:
    """By hand: 4 %, and three looks of 10 % each, of which one falls where all takes three times as long."""
    minute = [(0.1, 0.104, False)] * 4 + [(0.2, 0.804, True)] + [(0.1, 0.104, False)] * 4
    turns = minute + [(3.0 * one, 3.0 * other, looked) for one, other, looked in minute] + minute
    plain = [TimedTurn(one, looked) for one, _, looked in turns]
    rich = [TimedTurn(other, looked) for _, other, looked in turns]
    assert bench_network.figures(plain, rich)[COST] == pytest.approx(14.0)
    assert bench_network.figures(plain[9:18], rich[9:18])[COST] == pytest.approx(14.0)
