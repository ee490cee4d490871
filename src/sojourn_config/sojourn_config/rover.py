"""Schema of `config/rovers/NAME.yaml`: the machine beside its URDF, and the names of its other sets."""

from pydantic import Field

from sojourn_mechanics.plant.params import MachineParams


class RoverConfig(MachineParams):
    """One rover. It is also the plant's parameter set: wheels, pads, drives, couplings."""

    description: str = Field(min_length=1, description="what machine this is")
    mass: float | None = Field(
        default=None, gt=0.0, le=1e6, description="what the machine should weigh, against the sum of the URDF [kg]"
    )
    urdf: str = Field(min_length=1, description="file in urdf/, or a path from this file")
    battery: str = Field(min_length=1, description="name in config/power")
    loads: str = Field(min_length=1, description="loads on the bus: name in config/power")
    power_manager: str = Field(min_length=1, description="law of the power manager: name in config/power")
    sensors: str = Field(min_length=1, description="name in config/sensors")
    arm: str | None = Field(default=None, min_length=1, description="name in config/arms; left out: it has no arm")
    tool: str | None = Field(
        default=None, min_length=1, description="at the end of the arm: name in config/tools; left out: none"
    )
    drive: str = Field(min_length=1, description="goal follower, limits, odometry: name in config/nodes")
