"""A patch of ground that bears less than the map says: the soil that is there, with a part of its stiffness and of its
cohesion. It is there at once, as a crust that breaks; what stands on it sinks.
"""

import dataclasses
from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from pydantic import Field

from sojourn_machine.fault_choice import FaultableMachine, FaultProblem
from sojourn_physics.faults.plant_fault import PlantFault

if TYPE_CHECKING:
    from sojourn_physics.plant.model import PlantGiven

SCALED = ("k_c", "k_phi", "cohesion")


class SoftPatch(PlantFault):
    """See the module."""

    heals: ClassVar[bool] = False
    kind: str = "soft_patch"
    x: float = Field(ge=-1e6, le=1e6, description="its middle in map [m]")
    y: float = Field(ge=-1e6, le=1e6, description="its middle in map [m]")
    radius: float = Field(gt=0.0, le=1e4, description="[m]")
    part: float = Field(gt=0.0, lt=1.0, description="of stiffness and cohesion that is left [-]")

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        x_min, x_max, y_min, y_max = machine.bounds
        for key, value, low, high in (("x", self.x, x_min, x_max), ("y", self.y, y_min, y_max)):
            if not low <= value <= high:
                yield key, value, f"is off the terrain: allowed is {low:g} to {high:g} m"

    def given(self, given: "PlantGiven") -> "PlantGiven":
        """See PlantFault."""
        terrain, soils = given.site.terrain, {soil.name: soil for soil in given.site.soils}
        rows, columns = np.indices(terrain.soil_index.shape)
        x, y = terrain.origin_x + columns * terrain.resolution, terrain.origin_y + rows * terrain.resolution
        inside = np.hypot(x - self.x, y - self.y) <= self.radius
        index, names = terrain.soil_index.copy(), list(terrain.soil_names)
        for place in np.unique(terrain.soil_index[inside]).tolist():
            soil = soils[names[place]]
            softer = {name: self.part * getattr(soil, name) for name in SCALED}
            names.append(f"{soil.name} {len(names)}, softer")  # another name than of a patch that it lies upon
            soils[names[-1]] = soil.model_copy(update={**softer, "name": names[-1]})
            index[inside & (terrain.soil_index == place)] = len(names) - 1
        ground = dataclasses.replace(terrain, soil_index=index, soil_names=tuple(names))
        return given._replace(site=given.site._replace(terrain=ground, soils=tuple(soils.values())))
