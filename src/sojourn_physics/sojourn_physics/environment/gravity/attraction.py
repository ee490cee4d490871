"""What draws a machine towards a body: kinds of it, found by their names.

A kind is one module: parameters derived from `AttractionParams` that make an `Attraction`, equations with their
source. It is registered by an entry point of the group `sojourn.attractions` under the name that a file of
`config/bodies` says as `kind`. Nothing else changes: field, plant and sheet of a place know only what is here.
"""

from typing import TYPE_CHECKING, Protocol

from pydantic import Field

from sojourn_machine.params import FloatArray, Params
from sojourn_machine.registry import Registry

if TYPE_CHECKING:
    from sojourn_physics.environment.body import BodyParams

ATTRACTIONS: "Registry[type[AttractionParams]]" = Registry("sojourn.attractions", "kind of attraction")
"""Parameter sets of the kinds of attraction, by their names."""


class Attraction(Protocol):
    """Newton's attraction by a body that stands still, in the body's frame."""

    def acceleration(self, position: FloatArray) -> FloatArray:
        """Shape (3,) [m/s^2] at a position from the body's centre of mass, (3,) [m]."""

    def potential(self, position: FloatArray) -> float:
        """Energy of a kilogram there, zero at infinity, negative everywhere [J/kg]; acceleration is its fall."""


class AttractionParams(Params):
    """One body's attraction. Each kind has a subclass with its parameters, whose default of `kind` is its name."""

    kind: str = Field(description="kind of attraction")

    def build(self, body: "BodyParams") -> Attraction:
        """The attraction of a body with these numbers.

        Raises:
            InvalidValueError: what the kind needs and the body's file does not say.
        """
        raise NotImplementedError
