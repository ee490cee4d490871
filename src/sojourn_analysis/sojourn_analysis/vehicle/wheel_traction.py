"""One driven wheel in steady straight rolling: pull, torque and sinkage for a load and a slip, on three kinds of
ground.

Net pull P of the ground on the hub, torque T of the motor, slip s = 1 - v/(r w), load W.

`ClosedFormWheel`, design formulas (Bekker 1969, sec. 2.7 and 2.8; Janosi and Hanamoto 1961; the method of Carrier,
Olhoeft and Mendell 1991, Lunar Sourcebook, sec. 9.1.9):
    sinkage z and compaction resistance R_c as in `soil.pressure_sinkage`, bulldozing R_b as in `soil.bearing`
    contact length l = (D/2) acos(1 - 2 z/D), area A = b l
    thrust H = (A c + W tan f)[1 - K/(|s| l)(1 - exp(-|s| l/K))] sign(s)
    P = H - R_c - R_b,   T = r (H + R_r),   R_r = (f_0 + K_v V^2) W: hysteresis of the wheel, a moment on its hub that
    the motor overcomes; on a towed wheel, T = 0, the thrust is -R_r
    Bulldozing is counted where the sinkage is more than 6 % of the diameter, or not at all for less: the wedge that the
    formula supposes needs a wheel that digs in (Apostolopoulos 2001, CMU-RI-TR-01-08). Rigid rim, load range of
    Bekker's z.
`RimStressWheel`: stresses over the rim as in `contact.wheel_on_soil` (Wong and Reece 1967), the law of the plant; it
holds
    compaction and bulldozing in one, and finds the sinkage for which the vertical force is the load.
`FirmWheel`, ground that does not yield: P = m W s/(s + s_c) for s > 0, a thrust that saturates (Pacejka 2012, sec. 1.2:
    slip stiffness m W/s_c at zero slip), odd in s.

Range: |s| <= 1, loads of more than 0 N, sinkage up to half the diameter.
"""

import math
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np

from sojourn_analysis.wheels.wheel_bench import RESULT_COLUMNS, shape_row, solve
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.bearing import bulldozing_resistance, failure_strength
from sojourn_physics.soil.params import SoilParams, kernel_row
from sojourn_physics.soil.pressure_sinkage import compaction_resistance, wheel_sinkage
from sojourn_physics.soil.shear import contact_thrust

BULLDOZING_SINKAGE = 0.06
"""Of the diameter: below it no bulldozing is counted in the closed form."""


class WheelForces(NamedTuple):
    """Forces on one wheel: pull [N], torque of the motor [N m], sinkage [m], parts of the resistance [N].

    `compaction` and `bulldozing` are 0 where the model does not tell them apart.
    """

    pull: float
    torque: float
    sinkage: float
    rolling: float
    compaction: float
    bulldozing: float


class WheelTraction(Protocol):
    """A wheel on one ground."""

    @property
    def radius(self) -> float:
        """Radius r of the slip 1 - v/(r w) [m]."""

    def forces(self, load: float, slip: float, speed: float = 0.0) -> WheelForces:
        """Forces at a load [N], a slip in -1..1 and a speed [m/s]."""


class RollingLoss(NamedTuple):
    """f_0 [-] and K_v [s^2/m^2] of the resistance (f_0 + K_v V^2) W that the wheel itself makes."""

    constant: float = 0.0
    quadratic: float = 0.0

    def force(self, load: float, speed: float) -> float:
        """Resistance [N] at a load [N] and a speed [m/s]."""
        return (self.constant + self.quadratic * speed * speed) * load


NO_LOSS = RollingLoss()


@dataclass(frozen=True, slots=True)
class ClosedFormWheel:
    """Rigid wheel on soil by design formulas. Lengths in m, gravity in m/s^2."""

    soil: SoilParams
    radius: float
    width: float
    gravity: float
    loss: RollingLoss = NO_LOSS

    def forces(self, load: float, slip: float, speed: float = 0.0) -> WheelForces:
        """As `WheelTraction.forces`."""
        _check(load, slip)
        diameter = 2.0 * self.radius
        sinkage = wheel_sinkage(self.soil, load, diameter, self.width)
        if sinkage > self.radius:
            raise InvalidValueError("load", load, f"one that sinks the wheel to less than its axle on {self.soil.name}")
        compaction = compaction_resistance(self.soil, self.width, sinkage)
        bulldozing = 0.0
        if sinkage > BULLDOZING_SINKAGE * diameter:
            weight = self.soil.unit_weight(self.gravity)
            failing = failure_strength(
                self.soil.cohesion, self.soil.friction_angle, self.soil.bulldozing_failure == "local"
            )
            bulldozing = bulldozing_resistance(
                failing.friction_angle, failing.cohesion, weight, self.width, diameter, sinkage
            )
        length = self.radius * math.acos(1.0 - sinkage / self.radius)
        limit = self.width * length * self.soil.cohesion + load * math.tan(self.soil.friction_angle)
        thrust = math.copysign(contact_thrust(limit, length, abs(slip), self.soil.shear_modulus), slip)
        rolling = self.loss.force(load, speed)
        pull = thrust - compaction - bulldozing
        return WheelForces(pull, self.radius * (thrust + rolling), sinkage, rolling, compaction, bulldozing)


@dataclass(frozen=True, slots=True, eq=False)
class RimStressWheel:
    """Rigid wheel on soil by the stresses over its rim, as on the test bed of `contact.wheel_bench`.

    Gravity in m/s^2.
    """

    soil: SoilParams
    shape: WheelShape
    gravity: float
    loss: RollingLoss = NO_LOSS
    bench: "WheelBench" = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "bench", WheelBench(self.soil, self.shape, self.gravity))

    @property
    def radius(self) -> float:
        """Of the rim: the contact law counts slip on it, not on the tips of the grousers [m]."""
        return self.shape.radius

    def forces(self, load: float, slip: float, speed: float = 0.0) -> WheelForces:
        """As `WheelTraction.forces`."""
        _check(load, slip)
        sinkage, pull, _, torque, _, _, compaction, bulldozing = self.bench.state(load, slip)
        rolling = self.loss.force(load, speed)
        return WheelForces(pull, torque + self.radius * rolling, sinkage, rolling, compaction, bulldozing)


class WheelBench:
    """The test bed with one wheel on one soil; gravity in m/s^2."""

    def __init__(self, soil: SoilParams, shape: WheelShape, gravity: float) -> None:
        self._name, self._gravity = soil.name, gravity
        self._shape, self._soil = shape_row(shape)[None], kernel_row(soil)

    def state(self, load: float, slip: float, slip_angle: float = 0.0) -> list[float]:
        """One row of `wheel_bench.solve`'s results.

        Raises:
            InvalidValueError: a load that the soil does not carry.
        """
        results = np.empty((1, RESULT_COLUMNS))
        solve(self._shape, np.array([[load, slip, slip_angle, self._gravity]]), self._soil, results)
        row: list[float] = results[0].tolist()
        if math.isnan(row[0]):
            raise InvalidValueError("load", load, f"one that {self._name} carries under this wheel")
        return row


@dataclass(frozen=True, slots=True)
class FirmWheel:
    """Wheel on ground that does not yield: friction coefficient and slip at which half of it is used."""

    radius: float
    friction: float
    half_slip: float = 0.05
    loss: RollingLoss = NO_LOSS

    def forces(self, load: float, slip: float, speed: float = 0.0) -> WheelForces:
        """As `WheelTraction.forces`."""
        _check(load, slip)
        thrust = self.friction * load * slip / (abs(slip) + self.half_slip)
        rolling = self.loss.force(load, speed)
        return WheelForces(thrust, self.radius * (thrust + rolling), 0.0, rolling, 0.0, 0.0)


def _check(load: float, slip: float) -> None:
    if not (math.isfinite(load) and load > 0.0):
        raise InvalidValueError("load", load, "a finite number more than 0 N")
    if not -1.0 <= slip <= 1.0:
        raise InvalidValueError("slip", slip, "-1 to 1")
