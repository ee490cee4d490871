"""Heat in the ground under a site: conduction down, light and radiation at the surface.

    rho(z) c(T) dT/dt = d/dz (k(z, T) dT/dz)
    at z = 0:     absorbed + eps L + h (T_air - T) - eps sigma T^4 = -k dT/dz      L: infrared light of the sky
    far below:    -k dT/dz = -heat flow of the interior

Finite volumes on nodes that start at the surface and grow with depth, backward Euler in time, all of a step's fluxes at
its end, solved by Newton's method with the conductivity of the last iterate: a tridiagonal matrix each. Heat is kept
as the integral of c dT, so that what a step takes in is what its layers hold more, to the tolerance of the iteration
(Patankar 1980, "Numerical Heat Transfer and Fluid Flow", ch. 4; Hayne et al. 2017, appendix A, for the grid).
First order in time: steps of a thousandth of a day are within 0.3 K (`test/physics/thermal`), at sunrise and sunset on
the Moon, where the surface turns by up to 5 K in a step, within 2.5 K.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.thermal.regolith_kernels import Layers, advance_kernel
from sojourn_physics.thermal.regolith_params import RegolithParams

_NODES_PER_SKIN_DEPTH = 12.0
_GROWTH = 1.1
_SKIN_DEPTHS = 14.0
"""How deep the nodes go: the wave of the day is below a millionth there."""


class Irradiation(NamedTuple):
    """What the surface is given while a step lasts."""

    absorbed: float
    """Sunlight, less what is reflected [W/m2]."""
    infrared: float = 0.0
    """Of the sky, before the emissivity [W/m2]."""
    convection: float = 0.0
    """Coefficient of heat transfer from the air [W/(m2 K)]."""
    air_temperature: float = 0.0
    """Only where there is convection [K]."""


@dataclass(frozen=True, eq=False, slots=True)
class LayeredGround:
    """A regolith cut into layers for one length of day."""

    params: RegolithParams
    depths: FloatArray
    """Of the nodes; 0: the surface, shape (N,) [m]."""
    layers: Layers

    def heat(self, temperatures: FloatArray) -> float:
        """Stored above 0 K by a column of temperatures, shape (N,) [J/m2]."""
        powers = np.arange(1, 6)
        per_kilogram = (temperatures[:, None] ** powers) @ (np.array(self.params.heat_capacity) / powers)
        return float(self.layers.mass @ per_kilogram)


def cut_ground(params: RegolithParams, day: float, temperature: float = 250.0) -> LayeredGround:
    """Layers for waves of a day [s] in ground of about a temperature [K].

    Raises:
        InvalidValueError: day or temperature not finite and above 0.
    """
    for name, value in (("day [s]", day), ("temperature [K]", temperature)):
        if not (math.isfinite(value) and value > 0.0):
            raise InvalidValueError(name, value, "a finite number above 0")
    step = params.skin_depth(day, temperature) / _NODES_PER_SKIN_DEPTH
    deepest = _SKIN_DEPTHS * params.skin_depth(day, temperature, 10.0 * params.density_scale)
    depths = [0.0]
    while depths[-1] < deepest:
        depths.append(depths[-1] + step)
        step *= _GROWTH
    z = np.array(depths)
    middles = 0.5 * (z[1:] + z[:-1])
    edges = np.concatenate(([0.0], middles, [z[-1]]))
    density = np.array([params.density(depth) for depth in 0.5 * (edges[1:] + edges[:-1])])
    contact = np.array([params.contact_conductivity(depth) for depth in middles])
    layers = Layers(
        mass=density * np.diff(edges),
        contact=contact / np.diff(z),
        radiative=params.radiative_conductivity,
        heat_capacity=np.array(params.heat_capacity),
        emissivity=params.emissivity,
        heat_flow=params.heat_flow,
    )
    return LayeredGround(params, z, layers)


def step(ground: LayeredGround, temperatures: FloatArray, given: Irradiation, dt: float) -> FloatArray:
    """Temperatures of the nodes, shape (N,) [K], after dt [s].

    Raises:
        InvalidValueError: temperatures not finite, above 0 and of the ground's shape, dt not above 0, a term of
            `given` not finite, or negative.
    """
    if temperatures.shape != ground.depths.shape or not np.all(np.isfinite(temperatures) & (temperatures > 0.0)):
        raise InvalidValueError("temperatures [K]", temperatures, f"{ground.depths.size} finite numbers above 0")
    if not (math.isfinite(dt) and dt > 0.0):
        raise InvalidValueError("dt [s]", dt, "a finite number above 0")
    for name, value in given._asdict().items():
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidValueError(name, value, "a finite number, at least 0")
    over_time, _ = advance(ground, temperatures, np.array([given]), dt)
    after: FloatArray = over_time[0]
    return after


def advance(
    ground: LayeredGround, temperatures: FloatArray, given: FloatArray, dt: float
) -> tuple[FloatArray, FloatArray]:
    """Many steps at once: temperatures after each of them, shape (M, N) [K], and heat that went down between the nodes
    in each, shape (M, N + 1) [W/m2]: first that through the surface, last that from the interior.

    Args:
        given: rows of `Irradiation`, shape (M, 4). dt: of each step [s].
    """
    over_time = np.empty((given.shape[0], temperatures.size))
    fluxes = np.empty((given.shape[0], temperatures.size + 1))
    advance_kernel(ground.layers, temperatures, given, dt, over_time, fluxes)
    return over_time, fluxes
