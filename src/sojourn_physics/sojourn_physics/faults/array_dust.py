"""Dust that falls on a solar array all at once, as a gust or a wheel throws it: a share of the light is lost.

It goes into the light that the cells make power of, and not into that which warms the plane (`photovoltaic_array`).
"""

from collections.abc import Iterable
from typing import ClassVar

from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.fault_choice import FaultableMachine, FaultProblem, unknown
from sojourn_machine.power.photovoltaic_array import PhotovoltaicArrayParams
from sojourn_machine.power.power_params import PowerParams
from sojourn_physics.faults.supply import SupplyFault, changed


class ArrayFault(SupplyFault):
    """A fault of a solar array."""

    target: ClassVar[str] = "source"
    source: str = Field(min_length=1, description="name of the array")

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        sources = machine.power.sources.items()
        arrays = [name for name, source in sources if isinstance(source, PhotovoltaicArrayParams)]
        yield from (found := list(unknown("source", self.source, arrays, "is no solar array")))
        if not found:
            yield from super().problems(machine)

    def supply(self, power: PowerParams) -> PowerParams:
        """See SupplyFault."""
        array = power.sources.get(self.source)
        if not isinstance(array, PhotovoltaicArrayParams):
            raise InvalidValueError("source", self.source, "a solar array")
        return power.model_copy(update={"sources": {**power.sources, self.source: self.array(array)}})

    def array(self, array: PhotovoltaicArrayParams) -> PhotovoltaicArrayParams:
        """The array with the fault. Raises InvalidValueError for one that cannot have it."""
        raise NotImplementedError


class ArrayDust(ArrayFault):
    """See the module."""

    kind: str = "array_dust"
    share: float = Field(gt=0.0, lt=1.0, description="of the light that is lost [1]")

    def array(self, array: PhotovoltaicArrayParams) -> PhotovoltaicArrayParams:
        """See ArrayFault."""
        return changed(array, spectral_factor=array.spectral_factor * (1.0 - self.share))
