"""A switch of a load that is stuck, on or off, whatever the power manager commands. The lockout of its bus and a fuse
are behind it, and act still.
"""

from typing import Literal

from pydantic import Field

from sojourn_machine.evolution import replace
from sojourn_physics.faults.plant_fault import LoadFault
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand


class SwitchStuck(LoadFault):
    """See the module."""

    kind: str = "switch_stuck"
    where: Literal["on", "off"] = Field(description="how it is stuck")

    def command(self, model: PlantModel, command: PlantCommand, noted: float) -> PlantCommand:
        """See PlantFault."""
        return switched(model, command, self.load, 1.0 if self.where == "on" else 0.0)


def switched(model: PlantModel, command: PlantCommand, load: str, fraction: float) -> PlantCommand:
    """A command that switches a load to a fraction of its power [1]."""
    fractions = command.load_fractions.copy()
    fractions[[other.name for other in model.loads].index(load)] = fraction
    return replace(command, load_fractions=fractions)
