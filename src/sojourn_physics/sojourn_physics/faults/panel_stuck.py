"""A solar panel that stands where it should not: a hinge that stuck half way, a drive that does not follow the Sun."""

from pydantic import Field

from sojourn_machine.power.photovoltaic_array import PhotovoltaicArrayParams
from sojourn_physics.faults.array_dust import ArrayFault
from sojourn_physics.faults.supply import changed


class PanelStuck(ArrayFault):
    """See the module."""

    kind: str = "panel_stuck"
    normal: tuple[float, float, float] = Field(description="of its plane in base_link, as it stands [1]")

    def array(self, array: PhotovoltaicArrayParams) -> PhotovoltaicArrayParams:
        """See ArrayFault."""
        return changed(array, normal=self.normal)
