"""What a source of energy is to its network: the most power, and the most current, that it can give for a period.

A kind of source is one module: parameters derived from `SourceParams`, a state, equations with their source. It is
registered by an entry point of the group `sojourn.power_sources` under the name that a file says as `kind`.
A source gives min(power, current V) at a bus voltage V, and less where its bus can take no more.
"""

from math import inf, isfinite
from typing import Any, ClassVar, NamedTuple

from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import Params
from sojourn_machine.power.stores import MAIN
from sojourn_machine.power.surroundings import DARK, PowerSurroundings
from sojourn_machine.registry import Registry

SOURCES: "Registry[type[SourceParams]]" = Registry("sojourn.power_sources", "kind of source")
"""Parameter sets of the kinds of sources, by their names."""


class SourcePoint(NamedTuple):
    """A source as its bus sees it for a control period; a row of the kernel's table."""

    power: float
    """The most that it can give, not negative, finite [W]."""
    current: float = inf
    """Likewise, above 0 [A]."""


def require_step(power: float, dt: float) -> None:
    """Refuse a power given [W] or a step [s] that no source can have. Raises InvalidValueError."""
    if not isfinite(power):
        raise InvalidValueError("power of the source [W]", power, "a finite number")
    if not (isfinite(dt) and dt > 0.0):
        raise InvalidValueError("dt [s]", dt, "a finite number above 0")


class SourceParams(Params):
    """One source. Each kind has a subclass with its parameters, whose default of `kind` is its name."""

    kind: str = Field(description="kind of source")
    bus: str = Field(default=MAIN, min_length=1, description="name of the bus that it is on")

    def initial_state(self) -> Any:
        """At the start of a run."""
        raise NotImplementedError

    takes_light: ClassVar[bool] = False
    """Whether it goes by the light of the surroundings, which is not made for a network that needs none."""

    def point(self, state: Any, surroundings: PowerSurroundings = DARK) -> SourcePoint:
        """The source as its bus sees it for the next control period."""
        raise NotImplementedError

    runs_out: ClassVar[bool] = False
    """Whether what it works on may come to its end within a period (`lasting`)."""

    def lasting(self, state: Any, dt: float) -> float:
        """The most power that what is left lasts for, given over `dt` [s] [W]."""
        return inf

    def holds(self, state: Any) -> bool:
        """Whether its point is still that of the period before, where its surroundings are the same."""
        return False

    def step(self, state: Any, power: float, dt: float, surroundings: PowerSurroundings = DARK) -> Any:
        """The state after it has given `power` [W] for `dt` [s].

        Raises:
            InvalidValueError: a number that is not finite, dt not positive.
        """
        raise NotImplementedError

    def heat_given(self, before: Any, after: Any) -> float:
        """Heat that went into its surroundings between two of its states, 0 where the kind keeps no account [J]."""
        return 0.0

    @property
    def most_power(self) -> float:
        """That it can ever give [W]; checks before a run go by it."""
        return self.point(self.initial_state()).power
