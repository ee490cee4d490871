"""Dust that falls on a solar array all at once, as a gust or a wheel throws it: a share of the light is lost.

It goes into the light that the cells make power of, and not into that which warms the plane (`photovoltaic_array`).
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar

from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.fault_choice import FaultableMachine, FaultProblem, unknown
from sojourn_machine.power.photovoltaic_array import PhotovoltaicArrayParams
from sojourn_physics.faults.plant_fault import PlantFault
from sojourn_physics.faults.supply import with_source

if TYPE_CHECKING:
    from sojourn_physics.plant.model import PlantGiven


class ArrayFault(PlantFault):
    """A fault of a solar array."""

    target: ClassVar[str] = "source"
    source: str = Field(min_length=1, description="name of the array")

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        sources = machine.power.sources.items()
        arrays = [name for name, source in sources if isinstance(source, PhotovoltaicArrayParams)]
        return unknown("source", self.source, arrays, "is no solar array")


class ArrayDust(ArrayFault):
    """See the module."""

    kind: str = "array_dust"
    share: float = Field(gt=0.0, lt=1.0, description="of the light that is lost [1]")

    def given(self, given: "PlantGiven") -> "PlantGiven":
        """See PlantFault."""
        array = given.power.sources[self.source]
        if not isinstance(array, PhotovoltaicArrayParams):
            raise InvalidValueError("source", self.source, "a solar array")
        return with_source(given, self.source, spectral_factor=array.spectral_factor * (1.0 - self.share))
