"""Whom a data sheet is about: a vehicle on a soil of a body, with a machine of the plant behind it or without."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from sojourn_analysis.modal.linearise import LinearPlant
from sojourn_analysis.vehicle.law_wheel import LawWheel
from sojourn_analysis.vehicle.longitudinal import Course, loads
from sojourn_analysis.vehicle.multi_pass import following_wheels
from sojourn_analysis.vehicle.params import AxleParams, VehicleParams
from sojourn_analysis.vehicle.side_force import SideForce
from sojourn_analysis.vehicle.side_view import side_view
from sojourn_analysis.vehicle.step_climbing import SideView, SideWheel
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_analysis.vehicle.wheel_traction import ClosedFormWheel, RimStressWheel, WheelTraction
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.rigid_wheel_on_soil import RigidWheelOnSoilParams
from sojourn_physics.contact.rows import law_of
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.soil.params import SoilParams

CLOSED_FORM, RIM_STRESS, OWN = "closed form", "rim stress", "contact model of the plant"
LAWS = (CLOSED_FORM, RIM_STRESS, OWN)
"""Bekker's and Janosi's formulas; stresses over a rigid rim; the contact model that the wheels have in the plant."""
CLOSED_FORM_DIAMETER = 0.5
"""Bekker's closed forms hold for wheels larger than this [m]; smaller ones are taken by their rim stresses."""
GRADES = np.radians(np.arange(-40.0, 41.0, 10.0))


@dataclass(frozen=True, slots=True, eq=False)
class Subject:
    """A vehicle, where it is, and the machine it was made of (None: parameters alone, suspension locked).

    `standing` and `driving` are that machine's plant, linearised at rest and at cruise speed; None where not known.
    """

    vehicle: VehicleParams
    soil: SoilParams
    body: BodyParams
    machine: StandingMachine | None = None
    angles: Mapping[str, float] | None = None
    standing: LinearPlant | None = None
    driving: LinearPlant | None = None

    @property
    def gravity(self) -> float:
        """[m/s^2]"""
        return self.body.surface_gravity

    @property
    def law(self) -> str:
        """Law of the wheels in all figures that name no other: one of `LAWS`."""
        smallest = min(axle.wheel_radius for axle in self.vehicle.axles)
        if all(law_of(axle.contact).missing_in(self.soil) == () for axle in self.vehicle.axles) and not self.on_soil:
            return OWN
        return CLOSED_FORM if 2.0 * smallest >= CLOSED_FORM_DIAMETER else RIM_STRESS

    @property
    def on_soil(self) -> bool:
        """Whether all wheels have a contact model of wheels on soil."""
        return all(axle.contact.model.endswith("on_soil") for axle in self.vehicle.axles)

    @property
    def laws(self) -> tuple[str, ...]:
        """The laws that its wheels can be taken by."""
        rigid = all(isinstance(axle.contact, RigidWheelOnSoilParams) for axle in self.vehicle.axles)
        if not self.on_soil:
            return (OWN,)
        return LAWS[:2] if rigid else LAWS

    @property
    def articulation(self) -> str | None:
        """The joint between two bodies that steers the wheels of one of them; None where wheels steer by themselves."""
        if self.machine is None:
            return None
        joints = [wheel.steer_joint for wheel in self.machine.machine.wheels if wheel.steer_joint is not None]
        return next((joint for joint in joints if joints.count(joint) > 1), None)

    @property
    def rolls_sideways(self) -> bool:
        """Whether its wheels have rollers."""
        return all(axle.contact.model == "roller_wheel" for axle in self.vehicle.axles)

    @property
    def places(self) -> FloatArray:
        """Wheels from the centre of mass, left before right, axle by axle: (wheels, 2) [m]."""
        return np.array([[axle.x, side * 0.5 * axle.track] for axle in self.vehicle.axles for side in (1.0, -1.0)])

    def wheel(self, axle: AxleParams, law: str | None = None) -> WheelTraction:
        """The law of an axle's wheels on this soil."""
        chosen = law or self.law
        if chosen == CLOSED_FORM:
            return ClosedFormWheel(self.soil, axle.wheel_radius, axle.wheel_width, self.gravity, self.vehicle.loss)
        if chosen == OWN:
            return LawWheel(axle.wheel, self.soil, self.gravity)
        return RimStressWheel(self.soil, axle.shape, self.gravity, self.vehicle.loss)

    def side_force(self, axle: AxleParams) -> SideForce:
        """The law of the side force of an axle's wheels: that of the plant."""
        return LawWheel(axle.wheel, self.soil, self.gravity)

    def course_in_ruts(self, rigid: bool = False) -> Course:
        """The vehicle on this soil by the laws of the plant, its rear wheels in the ruts of those before them.

        Args:
            rigid: with rigid wheels, whatever contact model they have.
        """
        virgin = self.course(OWN)
        change = {"contact": RigidWheelOnSoilParams()} if rigid else {}
        wheels = [
            LawWheel(axle.wheel.model_copy(update=change), self.soil, self.gravity) for axle in self.vehicle.axles
        ]
        tracks = np.array([axle.track for axle in self.vehicle.axles])
        return replace(virgin, wheels=following_wheels(wheels, loads(virgin, 0.0), tracks))

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
