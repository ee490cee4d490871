"""A solar panel that stands where it should not: a hinge that stuck half way, a drive that does not follow the Sun."""

from typing import TYPE_CHECKING

from pydantic import Field

from sojourn_physics.faults.array_dust import ArrayFault
from sojourn_physics.faults.supply import with_source

if TYPE_CHECKING:
    from sojourn_physics.plant.model import PlantGiven


class PanelStuck(ArrayFault):
    """See the module."""

    kind: str = "panel_stuck"
    normal: tuple[float, float, float] = Field(description="of its plane in base_link, as it stands [1]")

    def given(self, given: "PlantGiven") -> "PlantGiven":
        """See PlantFault."""
        return with_source(given, self.source, normal=self.normal)
