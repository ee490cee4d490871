"""The file of a campaign: what is wrong with it is said in words before anything starts."""

from pathlib import Path

import pytest

from sojourn_config.command_errors import UsageError
from sojourn_config.errors import ConfigError
from sojourn_config.paths import available
from sojourn_studies.campaign import command
from sojourn_studies.campaign.campaign_file import read_campaign
from sojourn_studies.campaign.check import loaded, telling
from sojourn_studies.campaign.draws import draws

START = "description: x\nscenario: flat_drive\n"


def written(folder: Path, text: str) -> str:
    file = folder / "mine.yaml"
    file.write_text(text, encoding="utf-8")
    return str(file)


@pytest.mark.parametrize("name", available("campaigns"))
def test_our_own_campaigns_can_be_run(name: str) -> None:
    config, file = read_campaign(name)
    assert loaded(telling(draws(config))[:3], file)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (START + "runs: 3\nvaluse: {}\n", "unknown key.*did you mean values"),
        (START + "runs: 3\nvalues: {soil.n: {kind: unifrom, low: 0, high: 1}}\n", "did you mean uniform"),
        (
            START + "runs: 3\nvalues: {soil.n: {kind: uniform, low: 1.0, high: 0.5}}\n",
            "high = 0.5: allowed is above low, 1",
        ),
        (
            START + "runs: 3\nvalues: {soil.n: {kind: log_normal, median: 1.0, factor: 1.0e+200}}\n",
            "factor = 1e.200: allowed is a number",
        ),
        (START + "runs: 3\nvalues: {soil: {kind: choice, of: []}}\n", "of at least 1 values"),
        (START + "values: {soil.n: {kind: uniform, low: 0, high: 1}}\n", "a number of runs where nothing has a grid"),
        (START + "runs: 3\nset: {seed: 1}\nvalues: {seed: {kind: integers, low: 1, high: 2}}\n", "not among `values`"),
        (START + "runs: 3\nvalues: {'soil..n': {kind: uniform, low: 0, high: 1}}\n", "key of --set, with dots"),
        (START + "runs: 0\n", "runs = 0: allowed is a whole number at least 1"),
        ("description: x\nruns: 2\n", "a scenario, here or among `values`"),
        (START + "values: {a: {kind: list, of: [1]}, b: {kind: list, of: [1, 2]}}\n", "lists of the same length"),
        (START + "runs: 3\nsampling: sobl\n", "did you mean sobol"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        read_campaign(written(tmp_path, text))


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("soil.k_fi: {kind: uniform, low: 1.0, high: 2.0}", "unknown key.*did you mean k_phi"),
        (
            "battery_soc: {kind: uniform, low: 0.5, high: 1.5}",
            "battery_soc = 1.*allowed is a number at least 0, at most 1",
        ),
        ("machine: {kind: choice, of: [explorer, skidd]}", "did you mean skid"),
        ("scenario: {kind: list, of: [flat_drive, flat_driv]}", "did you mean flat_drive"),
        ("steps: {kind: list, of: [[]]}", "no steps: a run of a campaign ends with its steps"),
    ],
)
def test_values_that_no_run_can_have_are_refused_before_any(tmp_path: Path, table: str, words: str) -> None:
    start = "description: x\n" if table.startswith("scenario") else START
    file = written(tmp_path, f"{start}runs: 6\nvalues:\n  {table}\n")
    with pytest.raises(UsageError, match=words):
        command.main([file, "--out", str(tmp_path / "out")])
    assert not (tmp_path / "out").exists()


def test_what_does_not_go_together_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments in (
        [],
        ["soil_and_start", "--join", "tcp://x:1"],
        ["a", "--scheduler", "tcp://x:1", "--workers", "2"],
    ):
        with pytest.raises(SystemExit, match="2"):
            command.main(arguments)
        assert "campaign: " in capsys.readouterr().err
