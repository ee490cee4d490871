"""The test bed for a wheel of any contact law: `wheel_bench` for a rigid wheel on soil, `LawWheel` for all others.

Both answer in the same signs and with the same slip, that of the carriage: see `wheel_bench`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sojourn_analysis.vehicle.law_wheel import DEEPEST, LawWheel
from sojourn_analysis.wheels.wheel_bench import BenchResult, OverloadError, check_case, measure
from sojourn_machine.contact_choice import ContactChoice
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.supports import WheelParams
from sojourn_physics.contact.contact_law import OutColumn
from sojourn_physics.contact.rigid_wheel_on_soil import RigidWheelOnSoilParams
from sojourn_physics.contact.rows import law_of
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.params import SoilParams


@dataclass(frozen=True, slots=True)
class Bed:
    """A wheel with its contact law under a load [N] on a soil, where gravity is so large [m/s^2]."""

    wheel: WheelShape
    contact: ContactChoice
    soil: SoilParams
    load: float
    gravity: float

    def measure(self, slips: Sequence[float], slip_angles_deg: Sequence[float] = (0.0,)) -> list[BenchResult]:
        """Steady states at every slip for every slip angle.

        Raises:
            InvalidValueError: as `check_case`, or a soil that lacks what the law needs. OverloadError: the ground does
            not carry the load.
        """
        if isinstance(self.contact, RigidWheelOnSoilParams):
            return measure(self.wheel, self.soil, self.load, slips, slip_angles_deg, self.gravity)
        if missing := law_of(self.contact).missing_in(self.soil):
            allowed = f"one with {', '.join(missing)}, which the law {self.contact.model} needs"
            raise InvalidValueError("soil", self.soil.name, allowed)
        pairs = [(slip, angle) for angle in slip_angles_deg for slip in slips]
        for slip, angle in pairs:
            check_case(self.load, slip, angle)
        return [self._state(slip, angle) for slip, angle in pairs]

    def _state(self, slip: float, slip_angle_deg: float) -> BenchResult:
        try:
            out = self._law_wheel.steady(self.load, slip, math.radians(slip_angle_deg))
        except InvalidValueError as error:
            raise OverloadError(
                f"load = {self.load:g} N: {self.soil.name} does not carry it under wheel {self.wheel.name} by the law "
                f"{self.contact.model}, not even at a sinkage of {DEEPEST:g} radii"
            ) from error
        resistances = {
            "rolling_n": float(out[OutColumn.ROLLING_RESISTANCE]),
            "compaction_n": float(out[OutColumn.COMPACTION_RESISTANCE]),
            "bulldozing_n": float(out[OutColumn.BULLDOZING_RESISTANCE]),
        }
        return BenchResult(
            self.load,
            slip,
            slip_angle_deg,
            float(out[OutColumn.SINKAGE]),
            float(out[OutColumn.FORCE_X]),
            float(out[OutColumn.FORCE_Y]),
            float(out[OutColumn.TORQUE]),
            None,
            None,
            resistances,
            float(out[OutColumn.DEFLECTION]),
        )

    @property
    def _law_wheel(self) -> LawWheel:
        shape = self.wheel
        params = WheelParams(
            name=shape.name,
            joint=shape.name,
            radius=shape.radius,
            width=shape.width,
            grouser_height=shape.grouser_height,
            grouser_count=shape.grouser_count,
            contact=self.contact,
        )
        return LawWheel(params, self.soil, self.gravity)
