"""A step of the thermal network of a machine.

    C_i T_i' = Q_i + q_i + sum_j G_ij (T_j - T_i) + sum_j A_ij sigma (T_j^4 - T_i^4)
               + A_sky,i eps_i sigma (T_sky^4 - T_i^4) + A_ground,i eps_i sigma (T_ground^4 - T_i^4)
               + alpha_i A_sun,i S_i + h A_air,i (T_air - T_i) + G_i,ground (T_ground - T_i)

Q: heat of loads, stores and motors, given; q: heaters by their thermostats and radioisotope heaters (Gilmore 2002,
"Spacecraft Thermal Control Handbook", vol. 1: lumped networks; sky and ground are taken for black). Time: the singly
diagonally implicit Runge-Kutta method of order 2 that forgets what is fast (gamma = 1 - 1/sqrt 2; Alexander 1977,
"Diagonally implicit Runge-Kutta methods for stiff O.D.E.'s", SIAM J. Numer. Anal. 14), each stage by Newton's method;
within a step of any length the kernel takes as many as the difference from the
method of order 1 asks for, and ends one where a thermostat switches. What a step takes in and gives off is summed with
the weights of the method, so that the account closes to the tolerance of the iteration.

A conductor with `opens_below` is a thermal switch or a variable conductance heat pipe (Gilmore, ch. 9 and 14): its
conductance goes with the temperature of its first node at the beginning of a step, in proportion over `switch_width`.

Range: temperatures that one number tells of each node; what is given holds over the step.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.finite import all_finite
from sojourn_machine.params import FloatArray
from sojourn_machine.thermal.thermal_kernels import ACCOUNT, Account, Outside, Rows, Thermostats, step_kernel
from sojourn_machine.thermal.thermal_params import GROUND, ThermalParams

_SECONDS_PER_YEAR = 365.25 * 86400.0


class ThermalSurroundings(NamedTuple):
    """What is round the machine while a step lasts."""

    ground: float
    """Temperature of the ground [K]."""
    sky: float
    """Temperature that the sky radiates as [K]; 2.7: no air."""
    sunlight: FloatArray | None = None
    """On each node's `area_to_sun`, shape (N,) [W/m2]; None: dark."""
    air: float = 0.0
    """Temperature of the air, where there is any [K]."""
    convection: float = 0.0
    """Coefficient of heat transfer to the air [W/(m2 K)]."""


class HeatAccount(NamedTuple):
    """Heat since the start, into the nodes positive [J]."""

    given: float = 0.0
    """Of loads, stores, motors."""
    heaters: float = 0.0
    radioisotope: float = 0.0
    sunlight: float = 0.0
    outside: float = 0.0
    """From sky, ground and air: radiated, conducted, carried."""

    @property
    def taken_in(self) -> float:
        """All of them [J]."""
        return math.fsum(self)


NOTHING_YET = HeatAccount()


@dataclass(frozen=True, eq=False, slots=True)
class ThermalState:
    """What the network remembers."""

    temperatures: FloatArray
    """Of the nodes in the order of the parameters, shape (N,) [K]."""
    heating: FloatArray
    """Of each heater: 1 where its thermostat calls, else 0, shape (K,)."""
    age: float = 0.0
    """Since the start [s]."""
    account: HeatAccount = NOTHING_YET
    heater_energy: FloatArray | None = None
    """Of each heater since the start, shape (K,) [J]; None: at the start."""


class ThermalNetwork:
    """A machine's nodes as rows for the kernel, made once. The same object serves truth and belief."""

    def __init__(self, params: ThermalParams) -> None:
        self.params = params
        self.names = tuple(params.nodes)
        self.heater_names = tuple(params.heaters)
        self._rows = _rows(params)
        self._thermostats = _thermostats(params)
        self._switches = _switches(params)

    @cached_property
    def _index(self) -> dict[str, int]:
        return {name: i for i, name in enumerate(self.names)}

    def initial_state(self) -> ThermalState:
        """Nodes at their temperatures of the start; thermostats call where it is colder than they allow."""
        temperatures = np.array([node.temperature for node in self.params.nodes.values()])
        heating = np.array(
            [
                float(self.params.nodes[heater.node].temperature < heater.on_below)
                for heater in self.params.heaters.values()
            ]
        )
        return ThermalState(temperatures, heating)

    def temperature(self, state: ThermalState, node: str) -> float:
        """Of a node by its name [K].

        Raises:
            InvalidValueError: no such node.
        """
        if node not in self._index:
            raise InvalidValueError("node", node, ", ".join(self.names))
        return float(state.temperatures[self._index[node]])

    def heat_to_nodes(self, losses: dict[str, float]) -> FloatArray:
        """Heat of loads, stores and motors by their names [W], at the nodes that they warm, shape (N,) [W]."""
        heat = np.zeros(len(self.names))
        for name, loss in losses.items():
            if name in self.params.warms:
                heat[self._index[self.params.warms[name]]] += loss
        return heat

    def stored(self, state: ThermalState) -> float:
        """Heat above 0 K in all nodes [J]."""
        return float(self._rows.capacity @ state.temperatures)

    def radioisotope_heat(self, age: float) -> FloatArray:
        """At the nodes, an age [s] after the start, shape (N,) [W]."""
        heat = np.zeros(len(self.names))
        for unit in self.params.radioisotope_heaters:
            years = unit.age_years + age / _SECONDS_PER_YEAR
            heat[self._index[unit.node]] += unit.count * unit.power_w * 2.0 ** (-years / unit.half_life_years)
        return heat

    def _switched(self, temperatures: FloatArray) -> Rows:
        """Rows with the thermal switches as temperatures have them, held over a step."""
        if not self._switches:
            return self._rows
        conductance, to_ground = self._rows.conductance.copy(), self._rows.to_ground.copy()
        for first, second, most, opens, width in self._switches:
            part = min(max((float(temperatures[first]) - opens) / width, 0.0), 1.0) * most
            if second < 0:
                to_ground[first] += part
            else:
                conductance[first, second] += part
                conductance[second, first] += part
        return self._rows._replace(conductance=conductance, to_ground=to_ground)

    def step(
        self,
        state: ThermalState,
        surroundings: ThermalSurroundings,
        heat: FloatArray,
        dt: float,
        fed: FloatArray | None = None,
    ) -> ThermalState:
        """After dt [s].

        Args:
            heat: of loads, stores and motors at the nodes, shape (N,) [W].
            fed: share of its power that each heater gets if its thermostat calls, shape (K,) [1]; None: all.

        Raises:
            InvalidValueError: a number that is not finite or out of range, an array of another shape.
        """
        rows = self._rows
        supply = np.ones(len(self.heater_names)) if fed is None else fed
        light = np.zeros(len(self.names)) if surroundings.sunlight is None else surroundings.sunlight
        _check(surroundings, dt)
        for name, array, like in (
            ("heat at the nodes [W]", heat, rows.capacity),
            ("sunlight [W/m2]", light, rows.capacity),
            ("share that heaters are fed [1]", supply, self._thermostats.power),
            ("temperatures [K]", state.temperatures, rows.capacity),
        ):
            if array.shape != like.shape or not all_finite(array):
                raise InvalidValueError(name, array, f"{like.size} finite numbers")
        rows = self._switched(state.temperatures)
        radioisotope = self.radioisotope_heat(state.age + 0.5 * dt)
        sunlit = rows.sun * light
        temperatures = state.temperatures.copy()
        heating = state.heating.copy()
        energy = np.zeros(heating.size) if state.heater_energy is None else state.heater_energy.copy()
        account = np.zeros(ACCOUNT)
        outside = Outside(
            surroundings.ground,
            surroundings.sky,
            surroundings.air,
            surroundings.convection,
            heat + sunlit + radioisotope,
        )
        step_kernel(rows, outside, self._thermostats, Account(temperatures, heating, energy, account), supply, dt)
        before = state.account
        after = HeatAccount(
            before.given + dt * float(heat.sum()),
            before.heaters + float(account[0]),
            before.radioisotope + dt * float(radioisotope.sum()),
            before.sunlight + dt * float(sunlit.sum()),
            before.outside + float(account[1]),
        )
        return ThermalState(temperatures, heating, state.age + dt, after, energy)


def _switches(params: ThermalParams) -> list[tuple[int, int, float, float, float]]:
    """First node, second node (-1: ground), conductance, where it opens, width of the switches."""
    index = {name: i for i, name in enumerate(params.nodes)}
    return [
        (index[one.between[0]], index.get(one.between[1], -1), one.conductance, one.opens_below, one.switch_width)
        for one in params.conductors
        if one.opens_below is not None
    ]


def _rows(params: ThermalParams) -> Rows:
    nodes = list(params.nodes.values())
    index = {name: i for i, name in enumerate(params.nodes)}
    count = len(nodes)
    conductance, exchange, to_ground = np.zeros((count, count)), np.zeros((count, count)), np.zeros(count)
    ground = np.array([node.emissivity * node.area_to_ground for node in nodes])
    for conductor in params.conductors:
        first, second = index[conductor.between[0]], conductor.between[1]
        always = conductor.conductance if conductor.opens_below is None else 0.0
        if second == GROUND:
            to_ground[first] += always
            ground[first] += conductor.radiating_area
            continue
        for i, j in ((first, index[second]), (index[second], first)):
            conductance[i, j] += always
            exchange[i, j] += conductor.radiating_area
    return Rows(
        capacity=np.array([node.heat_capacity for node in nodes]),
        conductance=conductance,
        exchange=exchange,
        sky=np.array([node.emissivity * node.area_to_sky for node in nodes]),
        ground=ground,
        to_ground=to_ground,
        air=np.array([node.area_to_air for node in nodes]),
        sun=np.array([node.absorptivity * node.area_to_sun for node in nodes]),
    )


def _thermostats(params: ThermalParams) -> Thermostats:
    index = {name: i for i, name in enumerate(params.nodes)}
    heaters = list(params.heaters.values())
    return Thermostats(
        node=np.array([index[heater.node] for heater in heaters], dtype=np.int64),
        power=np.array([heater.power_w for heater in heaters], dtype=np.float64),
        on_below=np.array([heater.on_below for heater in heaters], dtype=np.float64),
        off_above=np.array([heater.off_above for heater in heaters], dtype=np.float64),
    )


def _check(surroundings: ThermalSurroundings, dt: float) -> None:
    if not (math.isfinite(dt) and dt > 0.0):
        raise InvalidValueError("dt [s]", dt, "a finite number above 0")
    for name in ("ground", "sky", "air", "convection"):
        value = getattr(surroundings, name)
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidValueError(f"surroundings: {name}", value, "a finite number, at least 0")
