"""Parameters of a wheeled vehicle as the analysis of this chapter sees it: a rigid body on axles with their drives.

Axles are in the order from front to rear; x is measured forward from the centre of mass, y to the left, z up. Every
axle has two wheels, left and right, of one size. The plant does not use this set: its machines are URDFs.
"""

import itertools
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_analysis.vehicle.wheel_traction import RollingLoss
from sojourn_machine.contact_choice import DEFAULT_CONTACT, Contact
from sojourn_machine.drives import GearParams, MotorParams, SeriesMotorParams
from sojourn_machine.params import FloatArray, Params
from sojourn_machine.supports import WheelParams
from sojourn_physics.contact.wheel_shape import WheelShape


class TrapezoidParams(Params):
    """Steering linkage of an axle: two arms on the steering axes, to the other axle's side, with a rod between them."""

    track: float = Field(gt=0.0, le=50.0, description="between the steering axes [m]")
    arm: float = Field(gt=0.0, le=5.0, description="length of the arms [m]")
    inclination_deg: float = Field(ge=-60.0, le=60.0, description="of the arms to the inside, straight ahead [degree]")


class AxleParams(Params):
    """Two wheels, one on each side."""

    name: str = Field(min_length=1, description="name of the axle, for example front")
    x: float = Field(ge=-100.0, le=100.0, description="forward of the centre of mass [m]")
    track: float = Field(gt=0.0, le=50.0, description="distance between its wheels [m]")
    wheel_radius: float = Field(gt=0.0, le=5.0, description="rolling radius, through the tips of grousers [m]")
    rim_radius: float = Field(gt=0.0, le=5.0, description="radius of the rim, without grousers [m]")
    grouser_count: int = Field(default=0, ge=0, le=500, description="grousers on one rim [-]")
    wheel_width: float = Field(gt=0.0, le=3.0, description="[m]")
    wheel_inertia: float = Field(ge=0.0, le=1e4, description="of one wheel about its axle, without the motor [kg m^2]")
    driven: bool = Field(default=True, description="true if its wheels have motors")
    max_steer: float = Field(default=0.0, ge=0.0, le=3.2, description="largest steer angle, 0 for fixed [rad]")
    full_lock: tuple[float, float] | None = Field(
        default=None, description="angles of inner and outer wheel at full lock, where a linkage couples them [rad]"
    )
    linkage: TrapezoidParams | None = Field(default=None, description="what couples its two wheels, where known")
    spring_rate: float | None = Field(
        default=None, gt=0.0, le=1e9, description="of one wheel's suspension [N/m]; none: rigid or equalising"
    )
    damping: float = Field(default=0.0, ge=0.0, le=1e7, description="of one wheel's suspension [N s/m]")
    unsprung_mass: float = Field(default=0.0, ge=0.0, le=1e4, description="at one wheel [kg]")
    tyre_rate: float | None = Field(default=None, gt=0.0, le=1e9, description="vertical stiffness of one wheel [N/m]")
    contact: Contact = Field(default=DEFAULT_CONTACT, description="contact model of its wheels")

    @model_validator(mode="after")
    def _radii_fit(self) -> Self:
        if self.rim_radius > self.wheel_radius:
            raise ValueError(f"rim_radius = {self.rim_radius:g}: allowed is at most {self.wheel_radius:g} m")
        if self.rim_radius < self.wheel_radius and self.grouser_count == 0:
            raise ValueError("grouser_count: allowed is more than 0 where the rim is smaller than the wheel")
        return self

    @property
    def wheel(self) -> WheelParams:
        """One of its wheels as the plant has it."""
        return WheelParams(
            name=self.name,
            joint=self.name,
            radius=self.rim_radius,
            width=self.wheel_width,
            grouser_height=self.wheel_radius - self.rim_radius,
            grouser_count=self.grouser_count,
            contact=self.contact,
        )

    @property
    def shape(self) -> WheelShape:
        """One of its wheels as the soil sees it."""
        return WheelShape(
            name="wheel",
            citation="vehicle",
            radius=self.rim_radius,
            width=self.wheel_width,
            grouser_height=self.wheel_radius - self.rim_radius,
            grouser_count=self.grouser_count,
        )


class PublishedFigure(Params):
    """A figure that others have published of a vehicle, to stand beside its own in the data sheet."""

    figure: str = Field(min_length=1, description="key of the figure in the data sheet")
    low: float = Field(description="published value, or the lowest of several [unit of the figure]")
    high: float = Field(description="the same, or the highest of several")
    source: str = Field(min_length=1, description="where it is published")


class Traverse(Params):
    """A drive that has been done, for the data sheet to tell what it takes."""

    name: str = Field(pattern=r"^[a-z][a-z0-9_]*$", description="key of its figures in the data sheet")
    label: str = Field(min_length=1, description="what it is called")
    distance_km: float = Field(gt=0.0, le=1e4, description="driven [km]")
    hours: float = Field(gt=0.0, le=1e4, description="that it was driven for, without halts [h]")


class VehicleParams(Params):
    """A vehicle. `equalising` is true where the suspension gives every axle its static load on any ground."""

    name: str = Field(min_length=1, description="name of the vehicle")
    citation: str = Field(min_length=1, description="where the numbers are from")
    estimates: tuple[str, ...] = Field(default=(), description="keys that no source gives: estimates of ours")
    mass: float = Field(gt=0.0, le=1e6, description="with payload [kg]")
    roll_inertia: float = Field(gt=0.0, le=1e7, description="about the centre of mass, x axis [kg m^2]")
    pitch_inertia: float = Field(gt=0.0, le=1e7, description="about the centre of mass, y axis [kg m^2]")
    yaw_inertia: float = Field(gt=0.0, le=1e7, description="about the centre of mass, z axis [kg m^2]")
    height: float = Field(gt=0.0, le=20.0, description="of the centre of mass over flat ground [m]")
    clearance: float = Field(gt=0.0, le=20.0, description="below the body on flat ground [m]")
    axles: tuple[AxleParams, ...] = Field(min_length=2, max_length=16, description="from front to rear")
    equalising: bool = Field(default=False, description="rocker-bogie or the like: loads do not depend on the ground")
    motor: MotorParams | SeriesMotorParams = Field(description="motor of each driven wheel")
    gear: GearParams = Field(description="gear of each driven wheel")
    controller_efficiency: float = Field(gt=0.0, le=1.0, description="motor power over power from the bus [-]")
    bus_voltage: float = Field(gt=0.0, le=1e4, description="[V]")
    battery_energy_wh: float = Field(gt=0.0, le=1e7, description="that may be used [Wh]")
    house_power: float = Field(ge=0.0, le=1e5, description="computers, radio, controllers at rest [W]")
    cruise_speed: float = Field(gt=0.0, le=100.0, description="usual speed [m/s]")
    rolling_loss: float = Field(default=0.0, ge=0.0, le=1.0, description="f_0 of the wheel itself [-]")
    rolling_loss_quadratic: float = Field(default=0.0, ge=0.0, le=1.0, description="K_v [s^2/m^2]")
    published: tuple[PublishedFigure, ...] = Field(default=(), description="figures to compare with")
    traverses: tuple[Traverse, ...] = Field(default=(), description="drives to tell the charge of")

    published_on: tuple[str, str] | None = Field(
        default=None, description="body and soil that the published figures are for; none: any"
    )

    @model_validator(mode="after")
    def _axles_are_ordered(self) -> Self:
        places = [axle.x for axle in self.axles]
        if any(first <= second for first, second in itertools.pairwise(places)):
            raise ValueError(f"axles: x = {places}: allowed is from front to rear")
        if not places[-1] < 0.0 < places[0]:
            raise ValueError(f"axles: x = {places}: allowed is the centre of mass between first and last axle")
        if not any(axle.driven for axle in self.axles):
            raise ValueError("axles: allowed is at least one driven axle")
        return self

    @property
    def x(self) -> FloatArray:
        """Places of the axles, shape (axles,) [m]."""
        return np.array([axle.x for axle in self.axles])

    @property
    def wheelbase(self) -> float:
        """Between the first and the last axle [m]."""
        return self.axles[0].x - self.axles[-1].x

    @property
    def loss(self) -> RollingLoss:
        """Rolling resistance of the wheels themselves."""
        return RollingLoss(self.rolling_loss, self.rolling_loss_quadratic)
