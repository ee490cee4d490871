"""What driving costs a machine, as measured: the numbers of its energy forecast (`energy_forecast`)."""

from itertools import pairwise
from typing import Self

from pydantic import Field, model_validator

from sojourn_machine.params import Params


class EnergyParams(Params):
    """What driving costs, measured."""

    grades_deg: tuple[float, ...] = Field(
        default=(-8.0, -4.0, 0.0, 4.0, 8.0), min_length=2, description="grades of the measurement, rising [deg]"
    )
    energy_per_metre: tuple[float, ...] = Field(min_length=2, description="of drive and steering on them [J/m]")
    time_per_metre: tuple[float, ...] = Field(min_length=2, description="likewise [s/m]")
    stop_energy: float = Field(ge=0.0, le=1e6, description="for starting, slowing down and stopping once [J]")
    stop_time: float = Field(ge=0.0, le=1e4, description="likewise [s]")
    turn_energy: float = Field(ge=0.0, le=1e6, description="for setting the wheels for a turn on the spot and back [J]")
    turn_time: float = Field(ge=0.0, le=1e4, description="likewise [s]")
    energy_per_radian: float = Field(ge=0.0, le=1e6, description="of a turn on the spot [J/rad]")
    time_per_radian: float = Field(ge=0.0, le=1e4, description="likewise [s/rad]")
    house_power: float = Field(ge=0.0, le=1e5, description="of all that goes on at a stand, too [W]")
    margin: float = Field(
        default=0.2,
        ge=0.0,
        le=5.0,
        description="part of the forecast to be left over: side slopes, rocks, unknown climbs [-]",
    )
    refuse: bool = Field(default=True, description="refuse a goal for which the charge does not suffice")

    @model_validator(mode="after")
    def _table(self) -> Self:
        for name in ("energy_per_metre", "time_per_metre"):
            values = getattr(self, name)
            if len(values) != len(self.grades_deg):
                raise ValueError(f"{name}: {len(values)} numbers, allowed are {len(self.grades_deg)}, as in grades_deg")
            if not all(0.0 <= value <= 1e6 for value in values):
                raise ValueError(f"{name} = {values}: allowed are numbers from 0 to 1e6")
        if any(later <= earlier for earlier, later in pairwise(self.grades_deg)):
            raise ValueError(f"grades_deg = {self.grades_deg}: allowed are rising numbers")
        return self
