"""Whom a data sheet is about: a vehicle on a soil of a body, with a machine of the plant behind it or without."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sojourn_mechanics.environment.body import BodyParams
from sojourn_mechanics.errors import InvalidValueError
from sojourn_mechanics.params import FloatArray
from sojourn_mechanics.soil.params import SoilParams
from sojourn_mechanics.vehicle.longitudinal import Course
from sojourn_mechanics.vehicle.params import AxleParams, VehicleParams
from sojourn_mechanics.vehicle.side_view import side_view
from sojourn_mechanics.vehicle.step_climbing import SideView, SideWheel
from sojourn_mechanics.vehicle.wheel_loads import StandingMachine
from sojourn_mechanics.vehicle.wheel_traction import ClosedFormWheel, RimStressWheel, WheelTraction

CLOSED_FORM_DIAMETER = 0.5
"""Bekker's closed forms hold for wheels larger than this [m]; smaller ones are taken by their rim stresses."""
GRADES = np.radians(np.arange(-40.0, 41.0, 10.0))


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """A vehicle, where it is, and the machine it was made of (None: parameters alone, suspension locked)."""

    vehicle: VehicleParams
    soil: SoilParams
    body: BodyParams
    machine: StandingMachine | None = None
    angles: Mapping[str, float] | None = None

    @property
    def gravity(self) -> float:
        """[m/s^2]"""
        return self.body.surface_gravity

    @property
    def law(self) -> str:
        """Law of the wheels: `closed form` or `rim stress`."""
        smallest = min(axle.wheel_radius for axle in self.vehicle.axles)
        return "closed form" if 2.0 * smallest >= CLOSED_FORM_DIAMETER else "rim stress"

    @property
    def places(self) -> FloatArray:
        """Wheels from the centre of mass, left before right, axle by axle: (wheels, 2) [m]."""
        return np.array([[axle.x, side * 0.5 * axle.track] for axle in self.vehicle.axles for side in (1.0, -1.0)])

    def wheel(self, axle: AxleParams, law: str | None = None) -> WheelTraction:
        """The law of an axle's wheels on this soil."""
        if (law or self.law) == "closed form":
            return ClosedFormWheel(self.soil, axle.wheel_radius, axle.wheel_width, self.gravity, self.vehicle.loss)
        return RimStressWheel(self.soil, axle.shape, self.gravity, self.vehicle.loss)

    def course(self, law: str | None = None) -> Course:
        """The vehicle on this soil."""
        wheels = [self.wheel(axle, law) for axle in self.vehicle.axles]
        if self.machine is None or not self.vehicle.equalising:
            return Course(self.vehicle, wheels, self.gravity)
        shares = self._shares(self.machine)

        def sharing(grade: float) -> FloatArray:
            return np.array([np.interp(grade, GRADES, column) for column in shares.T])

        return Course(self.vehicle, wheels, self.gravity, sharing)

    def side(self) -> SideView | None:
        """Seen from the side; None for a vehicle that the step analysis has no place for."""
        if self.machine is not None:
            try:
                return side_view(self.machine, self.angles)
            except InvalidValueError:
                return None
        vehicle = self.vehicle
        if len(vehicle.axles) != 2:
            return None
        wheels = tuple(SideWheel(axle.x, axle.wheel_radius, axle.wheel_radius, False) for axle in vehicle.axles)
        front, rear = vehicle.axles
        belly = (rear.x + rear.wheel_radius, front.x - front.wheel_radius, vehicle.clearance)
        return SideView(0.5 * vehicle.mass, (0.0, vehicle.height), wheels, belly=belly)

    def _shares(self, machine: StandingMachine) -> FloatArray:
        """Part of the pressing weight on each axle at GRADES, (grades, axles), by virtual work on tilted planes."""
        rows = []
        for grade in GRADES:
            slope = math.tan(grade)
            stance = machine.stand(lambda x, y, slope=slope: slope * x, angles=self.angles)  # type: ignore[misc]
            normal = machine.loads(stance).normal
            order = np.argsort(-stance.contacts[:, 0])
            axle = normal[order].reshape(-1, 2).sum(axis=1)
            rows.append(axle / axle.sum())
        return np.array(rows)
