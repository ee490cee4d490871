"""What may be wrong with a sensor: tables under the `faults` of its own, each with a name, which every kind has.

A fault works on what the sensor would say (x), from `after` on, t seconds later:

    x' = scale x + bias + drift t + spike    a spike of +-`spike_size` with `spike_probability`, each number for itself

so a swapped sign is a scale of -1. What is no number (NaN, the infinity of a beam that does not come back) stays that.
`stuck` repeats the last reading of before; of a sensor that is `dead` nothing is
heard any more, and of one with `dropout` not all. One with a `frozen_stamp` goes on, but its clock does not: its
messages bear the stamp of the last one before, so that nobody who goes by stamps takes them for news. `dust` is for
kinds that have a lens.
"""

from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.params import Params

PerNumber = float | tuple[float, ...]
"""One for all numbers of a reading, or one for each."""
LARGEST = 1e9
"""Of them, up or down, so that no reading becomes too large to be told."""


class SensorFaultParams(Params):
    """One fault. Units are those of the reading."""

    after: float = Field(default=0.0, ge=0.0, le=1e9, description="simulation time from which on it is there [s]")
    of: str = Field(default="", description="quantity of the reading that is wrong; left out: a reading of one alone")
    scale: PerNumber = Field(default=1.0, description="factor; -1 for a swapped sign [-]")
    bias: PerNumber = Field(default=0.0, description="added to the reading")
    drift: PerNumber = Field(default=0.0, description="added to the reading for each second of the fault [1/s]")
    spike_probability: float = Field(default=0.0, ge=0.0, le=1.0, description="of a spike in a number of a reading [-]")
    spike_size: float = Field(default=0.0, ge=0.0, le=1e9, description="of a spike, up or down")
    dust: float = Field(default=0.0, ge=0.0, le=1.0, description="share of its view that dust on the lens hides [-]")
    stuck: bool = Field(default=False, description="whether it repeats its last reading [-]")
    dead: bool = Field(default=False, description="whether nothing is heard of it any more [-]")
    dropout: float = Field(default=0.0, ge=0.0, le=1.0, description="probability that a message is lost [-]")
    frozen_stamp: bool = Field(default=False, description="whether its values go on and its stamp stays [-]")

    @property
    def loses(self) -> float:
        """Probability that a message is not heard, or is none of its stamp."""
        return 1.0 if self.dead or self.frozen_stamp else self.dropout

    @property
    def is_numerical(self) -> bool:
        """Whether it changes numbers of a reading."""
        return self.dust > 0.0 or self._is_shifted

    @property
    def _is_shifted(self) -> bool:
        return self.spike_probability > 0.0 or (self.scale, self.bias, self.drift) != (1.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not (self.is_numerical or self.stuck or self.loses):
            keys = "scale, bias, drift, spike_probability, dust, stuck, dead, dropout, frozen_stamp"
            raise ValueError(f"nothing is wrong by it: allowed is at least one of {keys}")
        if (self.spike_probability > 0.0) != (self.spike_size > 0.0):
            raise ValueError("spikes: allowed are spike_probability and spike_size together")
        for key in ("scale", "bias", "drift"):
            value: PerNumber = getattr(self, key)
            if not all(abs(each) <= LARGEST for each in (value if isinstance(value, tuple) else (value,))):
                raise ValueError(f"{key} = {value}: allowed is {-LARGEST:g} to {LARGEST:g}")
        if self.dust > 0.0 and self._is_shifted:
            raise ValueError("dust: allowed is a fault of its own, without scale, bias, drift or spikes")
        if self.frozen_stamp and (self.dead or self.dropout):
            raise ValueError("frozen_stamp: allowed is a fault of its own beside dead and dropout")
        if self.of and not self.is_numerical:
            raise ValueError(f"of {self.of}: allowed with scale, bias, drift or spikes")
        return self
