"""A short from a bus to the frame, of a resistance, as worn insulation makes one: V^2 / R, and no switch stops it."""

from collections.abc import Iterable
from typing import ClassVar

from pydantic import Field

from sojourn_machine.fault_choice import FaultableMachine, FaultProblem, unknown
from sojourn_machine.power.stores import MAIN
from sojourn_physics.faults.plant_fault import PlantFault
from sojourn_physics.plant.model import PlantModel


class BusShort(PlantFault):
    """See the module."""

    target: ClassVar[str] = "bus"
    kind: str = "bus_short"
    bus: str = Field(default=MAIN, min_length=1, description="name of the bus")
    resistance: float = Field(gt=0.0, le=1e6, description="of the short [ohm]")

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        return unknown("bus", self.bus, machine.power.all_buses, "is no bus")

    def model(self, model: PlantModel) -> None:
        """See PlantFault."""
        model.power = model.power.shorted(self.bus, self.resistance)
