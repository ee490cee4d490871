"""The file of a campaign: what varies and how, how many runs, what is kept of them."""

from pathlib import Path
from typing import Any, Literal

from pydantic import Field, model_validator

from sojourn_config.errors import MISSING, ConfigError, Problem
from sojourn_config.load import validate
from sojourn_config.overrides import split_override
from sojourn_config.paths import resolve
from sojourn_config.yaml_file import read_yaml
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params
from sojourn_studies.campaign.distributions import AnyDistribution, Distribution

SCENARIO, SEED = "scenario", "seed"
"""Keys of `values` that a run has in any case: what is run, and the seed of everything random in it."""
MOST_RUNS = 1_000_000


class KeepConfig(Params):
    """Of which runs the bag and the report stay; of all of them the row of the table does."""

    failures: bool = Field(default=True, description="of runs that did not meet their goals")
    sample: float = Field(default=0.0, ge=0.0, le=1.0, description="share of all runs of which they stay, too [1]")


class CampaignConfig(Params):
    """A campaign."""

    description: str = Field(min_length=1, description="what is asked, in one sentence")
    scenario: str | None = Field(
        default=None, min_length=1, description="name in config/scenarios or a file, unless `values` has it"
    )
    seed: int = Field(default=1, ge=0, lt=2**63, description="of the draws [-]")
    runs: int | None = Field(
        default=None, ge=1, le=MOST_RUNS, description="how many; none: every place of grids and lists once"
    )
    sampling: Literal["random", "latin_hypercube", "sobol"] = Field(
        default="random", description="how the shares of all drawn values are spread over the runs"
    )
    set: dict[str, Any] = Field(default_factory=dict, description="values of every run, by the keys of --set")
    values: dict[str, AnyDistribution] = Field(
        default_factory=dict, description="what varies: a distribution by the key of --set, or by `scenario`"
    )
    keep: KeepConfig = Field(default_factory=KeepConfig, description="of which runs bag and report stay")

    @model_validator(mode="after")
    def _fits(self) -> "CampaignConfig":
        twice = sorted(set(self.set) & set(self.values))
        if twice:
            raise InvalidValueError("set", twice[0], "a key that is not among `values` as well")
        if (self.scenario is None) == (SCENARIO not in self.values):
            raise InvalidValueError(SCENARIO, self.scenario, "a scenario, here or among `values`, and not in both")
        if SCENARIO in self.set:
            raise InvalidValueError("set", SCENARIO, "a key of --set; the scenario stands beside `set`")
        lengths = {name: len(one.values) for name, one in self.of_way("list").items()}
        if len(set(lengths.values())) > 1:
            raise InvalidValueError("values", lengths, "lists of the same length, as they run side by side")
        if self.runs is None and not self.of_way("list") and not self.of_way("grid"):
            raise InvalidValueError("runs", None, "a number of runs where nothing has a grid or a list")
        if self.places > MOST_RUNS:
            raise InvalidValueError("values", f"{self.places} places of grids", f"at most {MOST_RUNS} of them")
        return self

    def of_way(self, way: str) -> dict[str, Distribution]:
        """Distributions of one way, by key."""
        return {key: one for key, one in self.values.items() if one.way == way}

    @property
    def places(self) -> int:
        """Of all grids and lists together."""
        count = 1
        for one in self.of_way("grid").values():
            count *= len(one.values)
        for one in list(self.of_way("list").values())[:1]:
            count *= len(one.values)
        return count

    @property
    def count(self) -> int:
        """How many runs."""
        return self.places if self.runs is None else self.runs


def read_campaign(name: str) -> tuple[CampaignConfig, Path]:
    """A campaign and its file: a name in config/campaigns, or a path.

    Raises:
        ConfigError: with every problem of the file.
    """
    path = resolve("campaigns", name, ("command line", "campaign"))
    document = read_yaml(path)
    config = validate(document, CampaignConfig)
    problems: list[Problem] = []
    for table in ("set", "values"):
        for key in getattr(config, table):
            try:
                split_override(f"{key}=0")
            except ConfigError:
                allowed = "allowed is a key of --set, with dots: soil.k_phi"
                problems.append(document.problem((table, key), MISSING, allowed))
    if problems:
        raise ConfigError(problems)
    return config, path
