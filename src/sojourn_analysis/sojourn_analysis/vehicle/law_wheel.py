"""A wheel of the plant in steady rolling: any of its contact laws, asked for pull, torque and side force at a load.

The laws of `contact` hold a memory that settles as the wheel rolls. One implicit step so long that everything has
settled (the memory's own equations are advanced implicitly) gives the steady state; what is left is the penetration at
which the ground bears the load,

    N(h, s, b) = W,   s = (r w - v)/max(r w, v),  b slip angle,  no vertical motion, upright wheel

So analysis and plant speak of the same wheel, whatever its law: a rigid rim, a wire mesh pressed flat, a brush, a
roller. A wheel in the rut of others meets the soil that they have left, by the laws of `contact.ground_memory`: its
penetration is then counted from the bottom of the rut. Range: that of the law; slip -1 to 1.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from sojourn_analysis.vehicle.wheel_traction import WheelForces
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_machine.supports import WheelParams
from sojourn_physics.contact.contact_law import (
    MOTION_COLUMNS,
    OUT_COLUMNS,
    STATE_COLUMNS,
    MotionColumn,
    OutColumn,
)
from sojourn_physics.contact.ground_memory import GREATEST, PAST_COLUMNS, RUT, settle_soil
from sojourn_physics.contact.law_call import apply_law
from sojourn_physics.contact.rows import wheel_rows
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import SoilColumn, SoilParams, kernel_row
from sojourn_physics.soil.repeated_loading import rut_depth

SETTLED = 1e6
"""Step in which every memory settles [s]."""
LEAST_SPEED = 1.0
"""Slower wheels are asked at this speed: near rest the laws add a damping that steady rolling does not have [m/s]."""
SHALLOWEST, DEEPEST = 1e-8, 1.0
"""Bounds of the penetration, over the radius."""


@dataclass(frozen=True)
class LawWheel:
    """A wheel of the plant on one soil.

    Args:
        gravity: [m/s^2]. greatest: sinkage that wheels before it have reached there; 0 on virgin soil [m].
    """

    wheel: WheelParams
    soil: SoilParams
    gravity: float
    greatest: float = 0.0

    @property
    def radius(self) -> float:
        """Of the rim [m]."""
        return self.wheel.radius

    def forces(self, load: float, slip: float, speed: float = 0.0) -> WheelForces:
        """As `WheelTraction.forces`."""
        out = self.steady(load, slip, speed=speed)
        return WheelForces(
            float(out[OutColumn.FORCE_X]),
            float(out[OutColumn.TORQUE]),
            float(out[OutColumn.SINKAGE]),
            float(out[OutColumn.ROLLING_RESISTANCE]),
            float(out[OutColumn.COMPACTION_RESISTANCE]),
            float(out[OutColumn.BULLDOZING_RESISTANCE]),
        )

    def force(self, load: float, slip_angle: float) -> float:
        """As `SideForce.force`, of a wheel that rolls without longitudinal slip."""
        return float(self.steady(load, 0.0, slip_angle)[OutColumn.FORCE_Y]) if load > 0.0 else 0.0

    def steady(self, load: float, slip: float, slip_angle: float = 0.0, speed: float = 0.0) -> FloatArray:
        """Row of `OutColumn` in steady rolling.

        Raises:
            InvalidValueError: a load that is not positive, a slip beyond -1 to 1, a load that the ground does not bear.
        """
        if not (math.isfinite(load) and load > 0.0):
            raise InvalidValueError("load", load, "a finite number more than 0 N")
        if not -1.0 <= slip <= 1.0:
            raise InvalidValueError("slip", slip, "-1 to 1")
        moving = max(speed, LEAST_SPEED)
        motion = np.zeros(MOTION_COLUMNS)
        motion[MotionColumn.RIM_SPEED] = moving * (1.0 + min(slip, 0.0))
        motion[MotionColumn.V_ALONG] = moving * (1.0 - max(slip, 0.0)) * math.cos(slip_angle)
        motion[MotionColumn.V_SIDE] = moving * (1.0 - max(slip, 0.0)) * math.sin(slip_angle)
        out = np.zeros(OUT_COLUMNS)

        def excess(penetration: float) -> float:
            out[:] = 0.0
            motion[MotionColumn.PENETRATION] = penetration
            apply_law(self._row, self._ground_at(penetration), motion, SETTLED, np.zeros(STATE_COLUMNS), out)
            return float(out[OutColumn.FORCE_Z]) - load

        low, high = SHALLOWEST * self.radius, SHALLOWEST * self.radius
        while excess(high) < 0.0:  # the least penetration that bears the load
            low, high = high, 1.6 * high
            if low > DEEPEST * self.radius:
                raise InvalidValueError("load", load, f"one that {self.soil.name} carries under this wheel")
        excess(float(brentq(excess, low, high, xtol=1e-14, rtol=1e-13)) if high > low else high)
        return out.copy()

    @cached_property
    def rut(self) -> float:
        """Depth of the rut in which it rolls [m]."""
        modulus = pressure_modulus(self._ground, self.wheel.width)
        return float(
            rut_depth(
                modulus,
                self._ground[SoilColumn.N],
                self.greatest,
                self._ground[SoilColumn.UNLOADING_STIFFNESS],
                self._ground[SoilColumn.UNLOADING_STIFFNESS_PER_SINKAGE],
            )
        )

    def _ground_at(self, penetration: float) -> FloatArray:
        """The soil as a wheel so deep below the rut meets it."""
        if self.rut <= 0.0:
            return self._ground
        past = np.zeros(PAST_COLUMNS)
        past[GREATEST], past[RUT] = self.greatest, self.rut
        soil = self._ground.copy()
        settle_soil(self._row, penetration, soil, past)
        return soil

    @cached_property
    def _row(self) -> FloatArray:
        return wheel_rows([self.wheel], self.gravity).reshape(-1)

    @cached_property
    def _ground(self) -> FloatArray:
        return kernel_row(self.soil)
