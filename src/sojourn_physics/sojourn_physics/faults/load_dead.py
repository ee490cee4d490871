"""A load that is open: a heater whose wire has burnt through, a computer that does not start. It draws nothing."""

from sojourn_physics.faults.plant_fault import LoadFault
from sojourn_physics.faults.switch_stuck import switched
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand


class LoadDead(LoadFault):
    """See the module."""

    kind: str = "load_dead"

    def command(self, model: PlantModel, command: PlantCommand, noted: float) -> PlantCommand:
        """See PlantFault."""
        return switched(model, command, self.load, 0.0)
