"""The wheels and tracks of a machine as what moves it knows them, seen from above.

Frame: everything is in base_link (x forward, y left), with the steering straight. A wheel is a point at (x, y) that
rolls along its heading; a steered wheel turns about a vertical axis, through that same point unless its pivot says
otherwise. Wheels that name the same steering joint are rigid on one body that this joint turns. Angles are positive to
the left. Arrays of wheels are always in the order of `SteeringGeometryParams.wheels`.
"""

import math
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_flight.mobility.wheel_table import wheel_table
from sojourn_machine.body import MachineBody
from sojourn_machine.params import FloatArray, Params
from sojourn_machine.supports import TrackParams, WheelParams

SMALLEST_BASE = 1e-3
"""Two wheels must be at least this far apart [m], or the yaw rate cannot be told from the wheels."""


class WheelGeometry(Params):
    """One wheel, or a track that rolls like one, seen from above."""

    name: str = Field(..., min_length=1, description="name of the wheel, for example front_left")
    x: float = Field(..., ge=-100.0, le=100.0, description="position forward of base_link [m]")
    y: float = Field(..., ge=-100.0, le=100.0, description="position to the left of base_link [m]")
    radius: float = Field(..., gt=0.0, le=10.0, description="rolling radius [m]")
    steered: bool = Field(..., description="true if a motor turns the wheel's heading")
    steer_min: float = Field(0.0, ge=-2 * math.pi, le=2 * math.pi, description="smallest steer angle [rad]")
    steer_max: float = Field(0.0, ge=-2 * math.pi, le=2 * math.pi, description="largest steer angle [rad]")
    pivot_x: float | None = Field(
        default=None, ge=-100.0, le=100.0, description="steering axis; none: through the wheel [m]"
    )
    pivot_y: float | None = Field(
        default=None, ge=-100.0, le=100.0, description="steering axis; none: through the wheel [m]"
    )
    steer_joint: str | None = Field(default=None, min_length=1, description="what turns it; wheels may share one")
    roller_angle: float | None = Field(
        default=None,
        ge=-math.pi / 2,
        le=math.pi / 2,
        description="axle to roller axis, towards ahead; none: no rollers [rad]",
    )
    scrubs: bool = Field(default=False, description="true of a track: it is too long to roll freely in a turn")
    max_rate: float | None = Field(
        default=None, gt=0.0, le=1e3, description="of its drive motor; none: the machine's [rad/s]"
    )
    max_steer_rate: float | None = Field(
        default=None, gt=0.0, le=1e3, description="of its steering; none: likewise [rad/s]"
    )

    @property
    def pivot(self) -> tuple[float, float]:
        """Steering axis in base_link [m]; the origin for a fixed wheel."""
        if not self.steered:
            return 0.0, 0.0
        return self.x if self.pivot_x is None else self.pivot_x, self.y if self.pivot_y is None else self.pivot_y

    @property
    def steer_group(self) -> str | None:
        """What turns the wheel, by a name that rigid neighbours share; none for a fixed wheel."""
        return (self.steer_joint or self.name) if self.steered else None

    @model_validator(mode="after")
    def _limits_fit(self) -> Self:
        if self.steered and not self.steer_min < self.steer_max:
            raise ValueError(
                f"wheel {self.name}: steer_min = {self.steer_min}, allowed is less than steer_max = {self.steer_max}"
            )
        if not self.steered and (self.steer_min != 0.0 or self.steer_max != 0.0):
            raise ValueError(f"wheel {self.name}: steer limits of a fixed wheel must both be 0")
        if self.roller_angle == 0.0:
            raise ValueError(f"wheel {self.name}: roller_angle = 0, allowed is another: these rollers carry no wheel")
        return self


class SteeringGeometryParams(Params):
    """The wheels of a machine. Their order is the order of every array of wheels in this chapter."""

    wheels: tuple[WheelGeometry, ...] = Field(..., min_length=2, max_length=64, description="wheels, two or more")

    @model_validator(mode="after")
    def _wheels_differ(self) -> Self:
        names = [wheel.name for wheel in self.wheels]
        if len(set(names)) != len(names):
            raise ValueError(f"wheel names must differ, got {names}")
        first = self.wheels[0]
        base = max(math.hypot(wheel.x - first.x, wheel.y - first.y) for wheel in self.wheels)
        if base < SMALLEST_BASE:
            raise ValueError(f"wheels must be at least {SMALLEST_BASE} m apart, largest distance is {base} m")
        joints: dict[str, tuple[object, ...]] = {}
        for wheel in self.wheels:
            axis = (*wheel.pivot, wheel.steer_min, wheel.steer_max)
            if wheel.steer_joint and joints.setdefault(wheel.steer_joint, axis) != axis:
                raise ValueError(f"wheel {wheel.name}: pivot and limits must be those of all on {wheel.steer_joint}")
        return self

    @model_validator(mode="after")
    def _motion_is_observable(self) -> Self:
        rows = []
        for wheel in self.wheels:
            side = 0.0 if wheel.roller_angle is None else 1.0 / math.tan(wheel.roller_angle)
            rows.append((1.0, side, side * wheel.x - wheel.y))
            if wheel.roller_angle is None:
                rows.append((0.0, 1.0, wheel.x))
        if np.linalg.matrix_rank(np.array(rows)) < len(rows[0]):
            raise ValueError("wheels: their rollers leave a motion free; allowed are angles that hold all three")
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the wheels, in order."""
        return tuple(wheel.name for wheel in self.wheels)

    @property
    def steered(self) -> tuple[bool, ...]:
        """True for each wheel that can be steered, in order."""
        return tuple(wheel.steered for wheel in self.wheels)

    def table(self, track_ratio: float = 1.0) -> FloatArray:
        """Array for the kernels, one row a wheel, see `wheel_table`."""
        return wheel_table(self.wheels, track_ratio)


def steering_geometry(body: MachineBody) -> SteeringGeometryParams:
    """The wheels and tracks of a machine. They roll on the circle on which the soil shears."""
    wheels = (_wheel_geometry(wheel, body) for wheel in body.machine.wheels)
    tracks = (_track_geometry(track, body) for track in body.machine.tracks)
    return SteeringGeometryParams(wheels=(*wheels, *tracks))


def _wheel_geometry(wheel: WheelParams, body: MachineBody) -> WheelGeometry:
    place = body.joints[wheel.joint].place
    steering: dict[str, float | str | None] = {}
    if wheel.steer_joint is not None:
        joint = body.joints[wheel.steer_joint]
        steering = {
            "steer_min": joint.lower,
            "steer_max": joint.upper,
            "pivot_x": float(joint.place[0]),
            "pivot_y": float(joint.place[1]),
            "steer_joint": wheel.steer_joint,
            "max_steer_rate": _finite(joint.velocity),
        }
    rollers_deg = wheel.contact.rollers_deg()
    return WheelGeometry.model_validate(
        {
            "name": wheel.name,
            "x": float(place[0]),
            "y": float(place[1]),
            "radius": wheel.shear_radius,
            "steered": wheel.steer_joint is not None,
            "roller_angle": None if rollers_deg is None else math.radians(rollers_deg),
            "max_rate": _finite(body.joints[wheel.joint].velocity),
            **steering,
        }
    )


def _track_geometry(track: TrackParams, body: MachineBody) -> WheelGeometry:
    """A track rolls as a wheel in the middle of its flat run would that scrubs in every turn."""
    place = body.tracks[track.name]
    return WheelGeometry.model_validate(
        {
            "name": track.name,
            "x": float(place[0]),
            "y": float(place[1]),
            "radius": track.radius,
            "steered": False,
            "scrubs": True,
            "max_rate": _finite(body.joints[track.joint].velocity),
        }
    )


def _finite(limit: float) -> float | None:
    return limit if math.isfinite(limit) else None
