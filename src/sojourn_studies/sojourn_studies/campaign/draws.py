"""What each run of a campaign is: a function of the campaign's file and of the number of the run, and of nothing else.

Shares of the unit cube come from one of three designs:

- random: of each key its own stream of random numbers, so that a further key changes nothing of the others
  (numpy's SeedSequence, after O'Neill 2015);
- Latin hypercube: of each key every one of n equal shares is met once (McKay, Beckman and Conover 1979, Technometrics
  21, 239), so that the design depends on the number of runs;
- Sobol's sequence, scrambled (Owen 1998, J. Complexity 14, 466): even in many dimensions at once; further runs go on
  with it.
"""

import json
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from sojourn_studies.campaign.campaign_file import SCENARIO, SEED, CampaignConfig
from sojourn_studies.campaign.distributions import IntegersParams

FloatArray = NDArray[np.float64]
SEEDS = IntegersParams(kind="integers", low=0, high=2**31 - 1)
"""Of runs where the campaign says nothing of them."""
INNERMOST = 2.0**-40
"""Least distance of a share from 0 and 1, where quantiles are infinite [1]."""
_SAMPLED = "which runs are kept"


@dataclass(frozen=True)
class Draw:
    """One run.

    Args:
        number: of the run, from 0. scenario: name or file. values: of what varies, by key.
        overrides: KEY=VALUE texts. sampled: whether its bag is kept however it ends.
    """

    number: int
    scenario: str
    values: Mapping[str, Any]
    overrides: tuple[str, ...]
    sampled: bool = field(default=False)


def draws(config: CampaignConfig) -> list[Draw]:
    """All runs, in the order of their numbers."""
    drawn = config.of_way("drawn")
    if SEED not in config.set and SEED not in config.values:
        drawn[SEED] = SEEDS
    keys = sorted(drawn)
    cube = shares(config.sampling, config.seed, config.count, keys)
    kept = _random(config.seed, config.count, [_SAMPLED])[:, 0] < config.keep.sample
    found = []
    for number in range(config.count):
        values = {key: drawn[key].quantile(float(cube[number, column])) for column, key in enumerate(keys)}
        values |= placed(config, number)
        values = {key: values[key] for key in (*config.values, SEED) if key in values}  # in the order of the file
        scenario = str(values.get(SCENARIO, config.scenario))
        set_here = {**config.set, **{key: value for key, value in values.items() if key != SCENARIO}}
        found.append(Draw(number, scenario, values, override_texts(set_here), bool(kept[number])))
    return found


def placed(config: CampaignConfig, number: int) -> dict[str, Any]:
    """Values of grids and lists: the last grid moves on with every run; after the last place the first comes again."""
    values: dict[str, Any] = {}
    rest = number
    for key, one in reversed(config.of_way("grid").items()):
        rest, place = divmod(rest, len(one.values))
        values[key] = one.values[place]
    for key, one in config.of_way("list").items():
        values[key] = one.values[rest % len(one.values)]
    return values


def shares(sampling: str, seed: int, count: int, keys: Sequence[str]) -> FloatArray:
    """Shares of the unit interval, one row a run and one column a key, shape (count, keys) [1]."""
    if not keys:
        return np.empty((count, 0))
    generator = np.random.default_rng(np.random.SeedSequence([seed]))
    if sampling == "latin_hypercube":
        cube = qmc.LatinHypercube(len(keys), rng=generator).random(count)
    elif sampling == "sobol":
        with warnings.catch_warnings():  # it is balanced for powers of two: said in the manual
            warnings.simplefilter("ignore", UserWarning)
            cube = qmc.Sobol(len(keys), scramble=True, rng=generator).random(count)
    else:
        cube = _random(seed, count, keys)
    return np.clip(cube, INNERMOST, 1.0 - INNERMOST)


def override_texts(values: Mapping[str, Any]) -> tuple[str, ...]:
    """As texts of --set; what JSON writes, YAML reads."""
    return tuple(f"{key}={json.dumps(value, ensure_ascii=False)}" for key, value in values.items())


def _random(seed: int, count: int, keys: Sequence[str]) -> FloatArray:
    columns = [np.random.default_rng(np.random.SeedSequence([seed, crc32(key.encode())])).random(count) for key in keys]
    return np.stack(columns, axis=1)
