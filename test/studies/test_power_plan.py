"""scripts/power_plan as a user types it."""

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from sojourn_config.command_errors import UsageError
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_studies import power_plan
from sojourn_studies.power_days import LONGEST_STEP, steps_of_a_day

STORM = "sun.optical_depth=10.8"


def days(capsys: pytest.CaptureFixture[str], *arguments: str) -> Any:
    assert power_plan.main([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_a_clean_sol_of_a_mars_exploration_rover(capsys: pytest.CaptureFixture[str]) -> None:
    """About 900 Wh with clean cells (Crisp et al. 2003, J. Geophys. Res. 108(E12):8061)."""
    found = days(capsys, "mars_sol", "--step", "120")
    (sol,) = found["days"]
    assert sol["offered"] == pytest.approx(900.0, rel=0.05)
    assert sol["hours"] == pytest.approx(24.66, abs=0.05)
    assert sol["given"] <= sol["offered"] + 1e-9 and 0.5 < sol["least"] < sol["most"] <= 1.0
    assert found["first_limit"] is None and found["empty_h"] is None and found["mode_at_end"] == "NOMINAL"
    assert abs(found["energy_not_explained"]) < 1e-9


@pytest.mark.long
def test_sols_that_follow_each_other_are_alike(capsys: pytest.CaptureFixture[str]) -> None:
    """The night takes what the day gives, and the machine wakes each morning."""
    sols = days(capsys, "mars_sol", "--step", "300", "--days", "4")["days"]
    assert len(sols) == 4
    assert all({"NOMINAL", "SLEEP"} <= set(sol["modes"]) and "SURVIVAL" not in sol["modes"] for sol in sols)
    assert abs(sols[-1]["least"] - sols[2]["least"]) < 0.03


def test_a_storm_is_slept_through_for_a_sol(capsys: pytest.CaptureFixture[str]) -> None:
    """Of the depth that ended Opportunity. By the charge alone it would go on until nothing is left for the heaters."""
    found = days(capsys, "mars_sol", "--step", "120", "--set", STORM)
    assert found["mode_at_end"] == "SLEEP" and found["charge_at_end"] > 0.1 and found["empty_h"] is None
    assert found["days"][0]["offered"] < 90.0 and "asleep it will come to" in found["first_limit"]["what"]
    blind = "power_manager.sleep.reserve=null"
    careless = days(capsys, "mars_sol", "--step", "120", "--set", STORM, "--set", blind)
    assert careless["empty_h"] is not None and careless["empty_h"] < 12.0


NIGHT = ("lunar_night", "--days", "0.65", "--step", "300")
UNHEATED = ("--set", "thermal.radioisotope_heaters=[]")


def test_a_lunar_night_is_outlived_by_radioisotope_heat(capsys: pytest.CaptureFixture[str]) -> None:
    """Fifteen Earth days: with twenty heaters of 1 W no store leaves its limits, and the machine wakes by itself."""
    found = days(capsys, *NIGHT)
    assert found["first_limit"] is None and found["empty_h"] is None and found["beyond_limits"] == {}
    assert found["mode_at_end"] == "NOMINAL" and found["days"][0]["least"] > 0.2
    assert found["coldest_k"]["battery"] > 260.0 and found["coldest_k"]["radiator"] < 150.0
    assert abs(found["energy_not_explained"]) < 1e-9


@pytest.mark.long
def test_without_it_the_night_is_the_end(capsys: pytest.CaptureFixture[str]) -> None:
    """The battery has the heater burn for a day and is empty and cold after it: Lunokhod carried polonium for this."""
    found = days(capsys, *NIGHT, *UNHEATED)
    assert 12.0 < found["empty_h"] < 72.0 and found["coldest_k"]["battery"] < 120.0
    assert "too cold" in found["beyond_limits"]["battery"]["what"]
    assert found["first_limit"]["h"] <= found["beyond_limits"]["battery"]["h"]


@pytest.mark.parametrize("step", ["300", "3600"])
def test_long_steps_come_to_what_those_of_a_minute_do(step: str, capsys: pytest.CaptureFixture[str]) -> None:
    """In 300 s the battery took charge beyond its limit and the loads 2003 Wh for 1305; in 3600 s it had 64 C."""
    (exact,), found = days(capsys, "isotope_sol", "--step", "60")["days"], days(capsys, "isotope_sol", "--step", step)
    (sol,) = found["days"]
    for name in ("offered", "given", "used", "least", "most"):
        assert sol[name] == pytest.approx(exact[name], rel=0.01)
    assert sol["hours"] == pytest.approx(24.66, abs=0.01)  # 25 steps of 3600 s were called a sol
    assert found["first_limit"] is None and found["beyond_limits"] == {}


def test_a_day_of_whole_steps_is_a_day() -> None:
    scenario = load_scenario("isotope_sol")
    for step in (1.0, 59.0, 60.0, 61.0, 300.0, 3600.0):
        asked, parts = steps_of_a_day(scenario, step)
        length = scenario.body.solar_day / asked
        assert length <= step * (1.0 + 1e-6) and length / parts <= LONGEST_STEP * (1.0 + 1e-6)


def test_a_row_of_a_long_step_has_the_means_of_its_minutes(tmp_path: Path) -> None:
    tables = {}
    for step in ("60", "600"):
        path = tmp_path / f"{step}.csv"
        assert power_plan.main(["flat_drive", "--days", "0.005", "--step", step, "--csv", str(path)]) == 0
        with path.open(encoding="utf-8") as file:
            tables[step] = list(csv.DictReader(file))
    minutes, rows = tables["60"], tables["600"]
    assert len(rows) == 21
    first = [float(row["load_computer_w"]) for row in minutes[:10]]
    assert float(rows[0]["load_computer_w"]) == pytest.approx(sum(first) / 10.0, rel=1e-6)
    assert float(rows[0]["charge_battery"]) == pytest.approx(float(minutes[9]["charge_battery"]), abs=1e-4)
    assert float(rows[0]["hours"]) == pytest.approx(float(minutes[9]["hours"]), rel=1e-3)


def test_it_prints_writes_and_draws(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture, table = tmp_path / "days.png", tmp_path / "days.csv"
    given = ["flat_drive", "--days", "0.02", "--step", "600", "--plot", str(picture), "--csv", str(table)]
    assert power_plan.main(given) == 0
    said = capsys.readouterr().out
    assert "explorer on moon" in said and "First limit: LOW" in said and "All stores are empty after" in said
    assert picture.stat().st_size > 20_000
    with table.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 85 and rows[0]["mode"] == "NOMINAL" and float(rows[-1]["charge_battery"]) <= 0.0
    assert float(rows[0]["load_computer_w"]) == 30.0 and float(rows[0]["offered_w"]) == 0.0


SHORT = ("flat_drive", "--days", "0.0005")
NOTHING = "No source gives anything in all this time"


@pytest.mark.parametrize(
    ("source", "name"),
    [
        ("fc: {extends: ballard_mark_v, hydrogen: 0}", "fc"),
        ("krusty: {extends: krusty, running: false}", "krusty"),
        ("array: {extends: mer_array, normal: [0.0, 0.0, -1.0]}", "array"),
        (
            "array: {extends: mer_array, normal: [0.0, 0.0, -1.0]}, fc: {extends: ballard_mark_v, oxygen: 0}",
            "array, fc",
        ),
    ],
)
def test_the_sun_is_not_blamed_for_what_gives_nothing_in_its_light(
    source: str, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """An empty tank, a reactor that stands, an array that faces the ground."""
    assert power_plan.main([*SHORT, "--set", f"sources={{{source}}}"]) == 0
    said = capsys.readouterr().out
    assert f"{NOTHING} ({name})." in said and "the Sun does not shine" not in said


def test_where_all_sources_wait_for_light_it_is_the_sun_that_does_not_shine(
    capsys: pytest.CaptureFixture[str],
) -> None:
    night = ("--set", "sources={array: {extends: mer_array}}", "--set", "sun.elevation_deg=-10.0")
    assert power_plan.main([*SHORT, *night]) == 0
    assert f"{NOTHING} (array): the Sun does not shine on the machine." in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["mars_sol", "--days", "0"], "--days 0"),
        (["mars_sol", "--step", "0.1"], "--step 0.1"),
        (["flat_drive", "--days", "100"], "fewer --days"),
        (["flat_drive", "--days", "0.01", "--step", "600", "--csv", "/no/such/folder/x.csv"], "--csv"),
        (["flat_drive", "--days", "0.01", "--step", "600", "--plot", "/no/such/folder/x.png"], "--plot"),
    ],
)
def test_bad_options_are_refused_in_one_sentence(arguments: list[str], word: str) -> None:
    with pytest.raises(UsageError, match=word):
        power_plan.main(arguments)


def test_a_scenario_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ConfigError, match="did you mean drive"):
        power_plan.main(["flat_drive", "--set", "activities=[{load: drives, power_w: 1.0, start_h: 0.0, hours: 1.0}]"])
