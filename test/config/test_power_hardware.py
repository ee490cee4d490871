"""Power hardware that does not fit together is refused before a run, and a dark site is known for one."""

from pathlib import Path

import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.expected_light import lies_in_the_dark
from sojourn_config.paths import config_folder
from sojourn_config.scenario import LoadedScenario, load_scenario


def solar(tmp_path: Path, power: str, flight: str = "") -> LoadedScenario:
    """A Martian sol of the solar explorer with other power hardware."""
    machine, known = tmp_path / "changed", config_folder() / "machines"
    machine.mkdir()
    for name in ("machine", "sensors"):
        (machine / f"{name}.yaml").write_text(f"extends: {known}/explorer_solar/{name}.yaml\n", "utf-8")
    (machine / "flight.yaml").write_text(f"extends: {known}/explorer_solar/flight.yaml\n{flight}", "utf-8")
    (machine / "power.yaml").write_text(f"extends: {known}/explorer_solar/power.yaml\n{power}", "utf-8")
    return load_scenario("mars_sol", [f"machine={machine}"])


def test_the_machine_as_it_is_fits(tmp_path: Path) -> None:
    assert set(solar(tmp_path, "").power.sources) == {"array"}


@pytest.mark.parametrize("kind", ["nickel_battery", "primary_battery", "supercapacitor", "lead_acid"])
def test_the_battery_of_another_chemistry_is_not_read_as_lithium(kind: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=rf"power.yaml:2.*battery.kind = '{kind}'.*allowed is battery; a store of"):
        solar(tmp_path, f"battery: {{kind: {kind}}}\n")


@pytest.mark.parametrize(
    ("flight", "words"),
    [
        ("power_manager: {sleep: {loads: [receivr]}}\n", r"sleep.loads.*receivr.*did you mean receiver"),
        ("power_manager: {sleep: {loads: [cameras]}}\n", r"sleep.loads.*cameras.*is no essential load of the bus"),
    ],
)
def test_what_sleep_switches_off_is_an_essential_load(flight: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=words):
        solar(tmp_path, "", flight)


def test_no_load_is_called_as_the_sleep_of_the_machine(tmp_path: Path) -> None:
    load = "{name: sleep, kind: constant_power, power_w: 1.0, essential: false, priority: 5}"
    bus = f"voltage: 5.0, lockout_voltage: 3.0, lockout_reset_voltage: 4.0, lockout_reset_time: 1.0, loads: [{load}]"
    converter = "{input: main, output: payload, efficiency: 0.9, rating_w: 10.0}"
    with pytest.raises(ConfigError, match=r"'sleep'.*another name of a load"):
        solar(tmp_path, f"buses: {{payload: {{{bus}}}}}\nconverters: {{down: {converter}}}\n")


@pytest.mark.parametrize(
    ("overrides", "dark"),
    [
        ([], False),
        (["site.latitude_deg=85.0"], True),  # northern winter
        (["site.latitude_deg=-85.0"], False),
        (["site.latitude_deg=85.0", "machine=explorer"], False),  # has no source that would miss it
        (["site.latitude_deg=85.0", "machine=explorer_isotope"], False),
    ],
)
def test_a_site_without_sun_is_known(overrides: list[str], dark: bool) -> None:
    assert lies_in_the_dark(load_scenario("mars_sol", overrides)) is dark


def test_a_whole_table_of_the_machine_can_be_set() -> None:
    """An array is taken off, and the machine's own computer knows of it only where it is told."""
    bare = load_scenario("mars_sol", ["sources={}"])
    assert not bare.power.sources and set(bare.as_believed().power.sources) == {"array"}
    assert not load_scenario("mars_sol", ["sources={}", "belief.sources={}"]).as_believed().power.sources
    assert set(load_scenario("mars_sol", ["sources.array.clean=0.7"]).power.sources) == {"array"}


@pytest.mark.parametrize("text", ["thermal={}", "sensors=null"])
def test_a_whole_file_of_the_machine_is_refused_in_words(text: str) -> None:
    name = text.partition("=")[0]
    with pytest.raises(ConfigError, match=rf"stands for a file of the machine: allowed is {name}.KEY=VALUE"):
        load_scenario("mars_sol", [text])
