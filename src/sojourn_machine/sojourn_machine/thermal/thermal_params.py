"""What a machine is to heat: nodes of one temperature each, what joins them, what warms them.

A node is what is at one temperature: electronics, a battery, motors, the arm, an array. It stores heat, conducts and
radiates to other nodes (`conductors`), radiates to sky and ground, takes in sunlight, gives heat to the air where there
is any. Heaters are loads of the power network by their names, with a thermostat each; radioisotope heaters need no
power. The heat of other loads goes where `warms` says.

A light weight radioisotope heater unit gives 1 W at the fuelling (Tate 1982, "The light weight radioisotope heater
unit", Los Alamos LA-9078-MS).
"""

from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.names import names_text
from sojourn_machine.params import Params


class NodeParams(Params):
    """One temperature. Areas are of the surface that meets the outside: 0 leaves it inside."""

    heat_capacity: float = Field(gt=0.0, le=1e8, description="of all that is at this temperature [J/K]")
    temperature: float = Field(gt=2.0, le=1500.0, description="at the start [K]")
    emissivity: float = Field(default=0.0, ge=0.0, le=1.0, description="of its outside in the infrared [1]")
    area_to_sky: float = Field(default=0.0, ge=0.0, le=1e4, description="area times view of the sky [m2]")
    area_to_ground: float = Field(default=0.0, ge=0.0, le=1e4, description="area times view of the ground [m2]")
    absorptivity: float = Field(default=0.0, ge=0.0, le=1.0, description="of sunlight [1]")
    area_to_sun: float = Field(default=0.0, ge=0.0, le=1e4, description="area that sunlight is reckoned on [m2]")
    level: bool = Field(default=False, description="that area lies level; else it is the area that the Sun sees")
    area_to_air: float = Field(default=0.0, ge=0.0, le=1e4, description="area that the air flows along [m2]")


class ConductorParams(Params):
    """A way for heat between two nodes, or from a node to the ground that the machine stands on (`ground`)."""

    between: tuple[str, str] = Field(description="two nodes; the second may be `ground`")
    conductance: float = Field(default=0.0, ge=0.0, le=1e5, description="[W/K]")
    opens_below: float | None = Field(
        default=None,
        gt=2.0,
        le=1500.0,
        description="of a thermal switch or a heat pipe that shuts down: temperature of the first node at which "
        "nothing is left of the conductance; it is whole `switch_width` above [K]",
    )
    switch_width: float = Field(default=10.0, gt=0.0, le=500.0, description="see opens_below [K]")
    radiating_area: float = Field(
        default=0.0, ge=0.0, le=1e4, description="area times view times effective emissivity of both surfaces [m2]"
    )


class HeaterParams(Params):
    """A heater with a thermostat: a load of the power network of the same name."""

    node: str = Field(description="what it warms, and where the thermostat sits")
    power_w: float = Field(gt=0.0, le=1e5, description="while it is on and fed [W]")
    on_below: float = Field(gt=2.0, le=1500.0, description="temperature under which it switches on [K]")
    off_above: float = Field(gt=2.0, le=1500.0, description="temperature over which it switches off [K]")

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.off_above - self.on_below < 0.1:
            raise ValueError(
                f"off_above = {self.off_above}: allowed is 0.1 K and more above on_below, {self.on_below} K"
            )
        return self


class RadioisotopeHeaterParams(Params):
    """Some radioisotope heaters in one place."""

    node: str = Field(description="what they warm")
    count: int = Field(default=1, ge=1, le=1000, description="how many [1]")
    power_w: float = Field(default=1.0, gt=0.0, le=1000.0, description="heat of one at the fuelling [W]")
    half_life_years: float = Field(default=87.7, gt=0.0, le=1e6, description="87.7: plutonium 238 [year]")
    age_years: float = Field(default=0.0, ge=0.0, le=1000.0, description="since the fuelling, at the start [year]")


class ThermalParams(Params):
    """All of a machine, by the names of the nodes."""

    nodes: dict[str, NodeParams] = Field(min_length=1, max_length=100)
    conductors: tuple[ConductorParams, ...] = ()
    heaters: dict[str, HeaterParams] = Field(
        default_factory=dict, description="by the name of the load that feeds them"
    )
    radioisotope_heaters: tuple[RadioisotopeHeaterParams, ...] = ()
    warms: dict[str, str] = Field(
        default_factory=dict,
        description="node that takes the heat of a load or a source, or that is round a store, by its name",
    )
    convection: float = Field(
        default=0.0,
        ge=0.0,
        le=1e3,
        description="of heat to the air, where there is any [W/(m2 K)]",
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        names = list(self.nodes)
        if GROUND in names:
            raise ValueError(f"nodes: allowed is any name but {GROUND!r}, which is the ground under the machine")
        for i, conductor in enumerate(self.conductors):
            first, second = conductor.between
            _require_node(f"conductors[{i}].between[0]", first, names)
            _require_node(f"conductors[{i}].between[1]", second, [*names, GROUND])
            if first == second:
                raise ValueError(f"conductors[{i}].between = {first}, {second}: allowed are two different nodes")
        for name, heater in self.heaters.items():
            _require_node(f"heaters.{name}.node", heater.node, names)
        for i, unit in enumerate(self.radioisotope_heaters):
            _require_node(f"radioisotope_heaters[{i}].node", unit.node, names)
        for name, node in self.warms.items():
            _require_node(f"warms.{name}", node, names)
        return self


GROUND = "ground"
"""What a conductor may end at beside a node."""


def _require_node(key: str, name: str, names: list[str]) -> None:
    if name not in names:
        raise ValueError(f"{key} = {name!r}: {names_text(name, names)}")
