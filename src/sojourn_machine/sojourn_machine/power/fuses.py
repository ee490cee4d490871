"""Fuses of loads: a current above the rating opens them after a while; breakers close once their load is off.

    x' = I^2 - I_r^2, x >= 0;    open from x >= (I^2 t) on

A current far above the rating I_r melts a fuse when the integral of its square reaches the fuse's I^2 t; just above it
the heat that goes off at the rating is taken off (the adiabatic law of fuses with a loss: Wright and Newbery 2004,
"Electric Fuses", 3rd ed., ch. 2). An electronic breaker is told by the same two numbers.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from pydantic import Field

from sojourn_machine.params import FloatArray, Params

if TYPE_CHECKING:
    from sojourn_machine.power.loads import BoolArray, LoadParams


class FuseParams(Params):
    """Between a load and its bus."""

    rating_a: float = Field(gt=0.0, le=1e4, description="current that it carries for ever [A]")
    melting_i2t: float = Field(gt=0.0, le=1e8, description="I^2 t at which it opens [A2 s]")
    resets: bool = Field(default=False, description="a breaker, which closes when its load has been switched off")


@dataclass(frozen=True, eq=False, slots=True)
class FuseState:
    """What the fuses of a network remember, load by load."""

    heat: FloatArray
    """x, (loads,) [A2 s]."""
    blown: "BoolArray"
    """(loads,)"""


class Fuses:
    """Of all loads; one without a fuse carries everything."""

    def __init__(self, loads: Sequence["LoadParams"]) -> None:
        fuses = [load.fuse for load in loads]
        self._rating_squared = np.array([np.inf if fuse is None else fuse.rating_a**2 for fuse in fuses])
        self._melting = np.array([np.inf if fuse is None else fuse.melting_i2t for fuse in fuses])
        self._resets = np.array([fuse is not None and fuse.resets for fuse in fuses])

    def first(self) -> FuseState:
        """Cold and whole."""
        return FuseState(np.zeros(len(self._melting)), np.zeros(len(self._melting), dtype=np.bool_))

    def after(self, state: FuseState, switches: FloatArray, currents: FloatArray, dt: float) -> FuseState:
        """After `dt` [s] with the loads switched as commanded (loads,) and currents through them (loads,) [A]."""
        heat = np.maximum(state.heat + (currents**2 - self._rating_squared) * dt, 0.0)
        closed = self._resets & (switches <= 0.0)
        heat[closed] = 0.0
        return FuseState(heat, (state.blown & ~closed) | (heat >= self._melting))
