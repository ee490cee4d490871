"""Parameters of obstacle handling: what the rover can pass, its outline, the map that it keeps."""

import math
from typing import NamedTuple, Self

from pydantic import Field, model_validator

from sojourn_flight.hazards.camera_watch import CameraWatchParams
from sojourn_machine.params import Params


class OutlineParams(Params):
    """What must not touch, seen from above: a rectangle in base_link."""

    front: float = Field(gt=0.0, le=20.0, description="foremost point of a wheel [m]")
    rear: float = Field(gt=0.0, le=20.0, description="rearmost point of a wheel, backwards positive [m]")
    half_width: float = Field(gt=0.0, le=20.0, description="outermost point of a wheel [m]")
    ride_height: float = Field(gt=0.0, le=20.0, description="base_link above level ground [m]")

    @property
    def turn_radius(self) -> float:
        """Radius of the circle that a point turn sweeps [m]."""
        return math.hypot(max(self.front, self.rear), self.half_width)


class TiltLimits(NamedTuple):
    """Tangents of the steepest slopes [-]."""

    climb: float
    descent: float
    side: float


class PassableParams(Params):
    """The limits of the rover."""

    max_step: float = Field(gt=0.0, le=10.0, description="highest step up or down [m]")
    max_climb_deg: float = Field(gt=0.0, le=60.0, description="steepest slope up which it drives [degree]")
    max_descent_deg: float = Field(gt=0.0, le=60.0, description="steepest slope down which it drives [degree]")
    max_side_deg: float = Field(gt=0.0, le=60.0, description="steepest slope across which it drives [degree]")
    clearance: float = Field(gt=0.0, le=10.0, description="highest bump between the wheels [m]")
    hysteresis: float = Field(
        ge=0.0,
        lt=1.0,
        description="part of a limit by which what was passable may exceed it, and the other way round [-]",
    )

    @property
    def tilts(self) -> TiltLimits:
        """The slopes as tangents."""
        climb, descent, side = self.max_climb_deg, self.max_descent_deg, self.max_side_deg
        return TiltLimits(*(math.tan(math.radians(limit)) for limit in (climb, descent, side)))


class ObstacleMapParams(Params):
    """The grid round the rover."""

    size: float = Field(gt=1.0, le=100.0, description="side of the map [m]")
    cell: float = Field(gt=0.01, le=1.0, description="side of a cell [m]")
    memory: float = Field(gt=0.0, le=1e4, description="distance driven after which a cell is forgotten [m]")
    near: float = Field(
        gt=0.0, le=20.0, description="distance from the camera within which unseen ground is a drop [m]"
    )
    view_deg: float = Field(gt=0.0, le=160.0, description="sector in which the camera sees all distances [degree]")

    wide_size: float = Field(gt=1.0, le=1000.0, description="side of the wide map [m]")
    wide_cells: int = Field(ge=1, le=20, description="cells of the map along a side of one of the wide map [-]")
    wide_memory: float = Field(gt=0.0, le=1e5, description="distance driven after which the wide map forgets [m]")

    @property
    def cells(self) -> int:
        """Cells along a side."""
        return max(8, round(self.size / self.cell))

    @property
    def wide_cell(self) -> float:
        """Side of a cell of the wide map [m]."""
        return self.wide_cells * self.cell

    @model_validator(mode="after")
    def _wider(self) -> Self:
        if not self.wide_size >= self.size + 4.0 * self.wide_cell:
            raise ValueError(
                f"wide_size = {self.wide_size}: allowed is more than size = {self.size} by four wide cells"
            )
        if self.cells % (2 * self.wide_cells) or round(self.wide_size / self.wide_cell) % 2:
            raise ValueError(f"wide_cells = {self.wide_cells}: allowed is an even number of wide cells in both maps")
        return self


class ObstacleParams(Params):
    """Obstacle handling of the drive."""

    outline: OutlineParams = Field(description="what must not touch")
    passable: PassableParams = Field(description="what the rover can do")
    map: ObstacleMapParams = Field(description="the grid round the rover")
    margin: float = Field(gt=0.0, le=5.0, description="clearance that a plan keeps between rover and obstacle [m]")
    guard_margin: float = Field(ge=0.0, le=5.0, description="clearance below which a motion is stopped [m]")
    guard_cmd_vel: bool = Field(description="whether /cmd_vel is stopped before an obstacle, too")
    blind_timeout: float = Field(gt=0.0, le=3600.0, description="time without a cloud after which the rover waits [s]")
    camera: CameraWatchParams = Field(default=CameraWatchParams(), description="when it does not see")
    max_detour: float = Field(gt=0.0, le=1000.0, description="distance driven beyond the way asked for, at most [m]")
    back_off: float = Field(gt=0.0, le=10.0, description="longest way back to find room for a turn [m]")
    back_off_speed: float = Field(gt=0.0, le=1.0, description="[m/s]")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.guard_margin < self.margin:
            raise ValueError(f"guard_margin = {self.guard_margin}: allowed is less than margin = {self.margin}")
        if not self.outline.turn_radius + self.margin < 0.4 * self.map.size:
            raise ValueError(f"map.size = {self.map.size}: allowed is more than 2.5 times the circle of a point turn")
        return self
