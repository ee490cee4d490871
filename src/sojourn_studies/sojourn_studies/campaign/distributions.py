"""What the values of a campaign are drawn from. Each is asked for its quantile, so that every way of sampling serves
all.

A share u of the unit interval goes in, the value that the share u of all draws stays below comes out (inverse transform
sampling: Devroye, "Non-Uniform Random Variate Generation", 1986, II.2). Numbers are rounded to nine digits: the last
bit of a special function must not decide what a run is.

A package adds a kind of its own by an entry point of the group `sojourn.distributions`.
"""

import math
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import Field, SerializeAsAny, model_validator
from scipy.special import ndtr, ndtri

from sojourn_config.yaml_file import Data
from sojourn_machine.choice import kinds_of
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params
from sojourn_machine.registry import Registry

DISTRIBUTIONS: "Registry[type[Distribution]]" = Registry("sojourn.distributions", "distribution")
LEAST_SHARE = 1e-6
"""Of a normal distribution that its limits may leave: below it next to nothing would be drawn from [1]."""


class Distribution(Params):
    """One kind. `way`: whether its value is drawn, or goes by the number of the run: one of a grid, or of lists that
    run side by side.
    """

    way: ClassVar[Literal["drawn", "grid", "list"]] = "drawn"

    kind: str = Field(description="name of the kind of distribution")

    @property
    def values(self) -> tuple[Any, ...]:
        """All values, of one that has but a few; else none."""
        return ()

    def quantile(self, share: float) -> Data:
        """The value below which `share` of all draws are, above 0 and below 1."""
        raise NotImplementedError


class UniformParams(Distribution):
    """Every number between two is as likely as any other."""

    low: float = Field(description="least value")
    high: float = Field(description="greatest value")

    @model_validator(mode="after")
    def _has_values(self) -> "UniformParams":
        _check_above("high", self.high, self.low)
        return self

    def quantile(self, share: float) -> float:
        """As the base."""
        return rounded(self.low + share * (self.high - self.low))


class LogUniformParams(Distribution):
    """Every ratio is as likely as any other: for what is known but to an order of magnitude."""

    low: float = Field(gt=0.0, description="least value")
    high: float = Field(gt=0.0, description="greatest value")

    @model_validator(mode="after")
    def _has_values(self) -> "LogUniformParams":
        _check_above("high", self.high, self.low)
        return self

    def quantile(self, share: float) -> float:
        """As the base."""
        return rounded(self.low * (self.high / self.low) ** share)


class NormalParams(Distribution):
    """Normal, between limits where there are any: what is beyond them is not drawn."""

    mean: float = Field(description="mean of the whole distribution")
    deviation: float = Field(gt=0.0, description="standard deviation of the whole distribution")
    low: float | None = Field(default=None, description="least value; none: no limit")
    high: float | None = Field(default=None, description="greatest value; none: no limit")

    @model_validator(mode="after")
    def _has_values(self) -> "NormalParams":
        if self.low is not None and self.high is not None:
            _check_above("high", self.high, self.low)
        below, above = self._limits
        if above - below < LEAST_SHARE:
            between = f"limits that leave more than {LEAST_SHARE:g} of the distribution"
            raise InvalidValueError("low" if self.low is not None else "high", self.low or self.high, between)
        return self

    @property
    def _limits(self) -> tuple[float, float]:
        below = 0.0 if self.low is None else float(ndtr((self.low - self.mean) / self.deviation))
        above = 1.0 if self.high is None else float(ndtr((self.high - self.mean) / self.deviation))
        return below, above

    def quantile(self, share: float) -> float:
        """As the base."""
        below, above = self._limits
        value = self.mean + self.deviation * float(ndtri(below + share * (above - below)))
        low = -math.inf if self.low is None else self.low
        high = math.inf if self.high is None else self.high
        return rounded(min(max(value, low), high))


class LogNormalParams(Distribution):
    """Its logarithm is normal: for what is positive and varies by a factor."""

    median: float = Field(gt=0.0, description="half of all values are below it")
    factor: float = Field(gt=1.0, le=1e30, description="by which one standard deviation multiplies or divides [1]")

    def quantile(self, share: float) -> float:
        """As the base."""
        return rounded(self.median * self.factor ** float(ndtri(share)))


class IntegersParams(Distribution):
    """Every whole number between two is as likely as any other, both of them too."""

    low: int = Field(description="least value")
    high: int = Field(description="greatest value")

    @model_validator(mode="after")
    def _has_values(self) -> "IntegersParams":
        if self.high < self.low:
            raise InvalidValueError("high", self.high, f"at least low, {self.low}")
        return self

    def quantile(self, share: float) -> int:
        """As the base."""
        return min(self.low + math.floor(share * (self.high - self.low + 1)), self.high)


class ChoiceParams(Distribution):
    """One of several values of any sort, by their weights."""

    of: tuple[Any, ...] = Field(min_length=1, description="values to choose from")
    weights: tuple[Annotated[float, Field(ge=0.0)], ...] | None = Field(
        default=None, description="how often each is drawn, in any unit; none: all alike"
    )

    @model_validator(mode="after")
    def _has_values(self) -> "ChoiceParams":
        if self.weights is not None and (len(self.weights) != len(self.of) or sum(self.weights) <= 0.0):
            raise InvalidValueError("weights", list(self.weights), f"{len(self.of)} numbers, one of them above 0")
        return self

    @property
    def values(self) -> tuple[Any, ...]:
        """As the base."""
        return self.of

    def quantile(self, share: float) -> Data:
        """As the base."""
        weights = self.weights or (1.0,) * len(self.of)
        left = share * sum(weights)
        for value, weight in zip(self.of, weights, strict=True):
            left -= weight
            if left < 0.0 and weight > 0.0:
                return value
        return [value for value, weight in zip(self.of, weights, strict=True) if weight > 0.0][-1]


class ListParams(Distribution):
    """One value after the other; several lists run side by side."""

    way: ClassVar[Literal["drawn", "grid", "list"]] = "list"

    of: tuple[Any, ...] = Field(min_length=1, description="values in their order")

    @property
    def values(self) -> tuple[Any, ...]:
        """As the base."""
        return self.of


class GridParams(ListParams):
    """Each value with each of every other grid, and with each place of the lists."""

    way: ClassVar[Literal["drawn", "grid", "list"]] = "grid"


AnyDistribution: TypeAlias = Annotated[SerializeAsAny[Distribution], *kinds_of(DISTRIBUTIONS, "kind")]


def rounded(value: float) -> float:
    """To nine digits."""
    return float(f"{value:.9g}")


def _check_above(name: str, value: float, low: float) -> None:
    if value <= low:
        raise InvalidValueError(name, value, f"above low, {low:g}")
