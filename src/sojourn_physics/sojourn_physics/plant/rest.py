"""A machine at rest, and long steps of its plant while it stays so.

It rests when for `REST_PERIODS` control periods nothing has moved faster than `REST_SPEED` and what moves it has been
told the same. Body, soil and drives then stay as they are, what the motors take to hold goes on, and power network,
heat of the machine and of its motors take long steps, as a plan of its days does
(`sojourn_flight.power_manager.preview`): the light is that of the middle of a step, the loads are those of its
beginning, a thermostat's duty is that of the step before. A step is as short as the temperatures of the machine ask
for: halved while one of them changes by more than `HEATED_FAST` in it, doubled while none does by a quarter of that.

A leap of such steps ends early where the plant is no longer what it was at its beginning and somebody might act on it
(`Noticed.differs`), so that decisions are as late as one step at most.

Source of the scheme: multirate integration of a system whose fast part is at its fixed point (Gear and Wells 1984, BIT
24, 484); bounds on charge, temperature and light are what adapts. Range: rest on ground, in calm air or steady wind.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.evolution import replace
from sojourn_machine.params import FloatArray
from sojourn_machine.power.network_state import NetworkOutput
from sojourn_physics.plant.heat import Moved
from sojourn_physics.plant.light import sunlight_on
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand, PlantOutput, PlantState
from sojourn_physics.plant.supply import powered

REST_SPEED = 1e-5
"""What moves no faster rests [m/s], [rad/s]."""
REST_PERIODS = 25
"""Control periods for which it has to."""
SAME_REFERENCE = 1e-5
"""Two references that differ by no more are the same [rad], [rad/s]."""
CHARGE_STEP = 0.005
"""Of a store in one leap [1]."""
TEMPERATURE_STEP = 2.0
"""Of a store in one leap [K]."""
POWER_STEP = 0.05
"""Of the sources in one leap, as a part of what the loads or the sources give and take, whichever is more [1]."""
HEATED_FAST = 0.1
"""A step in which the machine is heated or cooled by more is followed by one of half its length [K]."""
MOST_PARTS = 8
"""Into so many steps a minute falls at most."""


class Rest(NamedTuple):
    """How long a machine has rested."""

    periods: int = 0
    told: PlantCommand | None = None
    """What it has been told since."""
    output: PlantOutput | None = None
    """What was last seen."""

    @property
    def is_deep(self) -> bool:
        """Whether nothing will move by itself."""
        return self.periods >= REST_PERIODS


RESTLESS = Rest()


def rest_after(model: PlantModel, rest: Rest, state: PlantState, command: PlantCommand, output: PlantOutput) -> Rest:
    """After a control period with a command that ended in a state."""
    moves = np.abs(state.velocity).max(initial=0.0) > REST_SPEED or state.flight.periods
    if moves or state.outside or (state.tool is not None and abs(state.tool.rate) > REST_SPEED):
        return RESTLESS
    if rest.told is None or not is_told_the_same(model, rest.told, command):
        return Rest(1, command, output)
    return Rest(rest.periods + 1, rest.told, output)


def is_told_the_same(model: PlantModel, one: PlantCommand, other: PlantCommand) -> bool:
    """Whether two commands have the machine hold the same: positions, no rates, motors with current or without.

    A torque that is fed forward follows the noise of what it is computed from, and is no motion.
    """
    rates = [other.reference[1], () if other.tool is None else other.tool[1:2]]
    if max(np.abs(rate).max(initial=0.0) for rate in rates) > SAME_REFERENCE:
        return False
    pairs = [(one.reference[0], other.reference[0])]
    pairs += [] if one.tool is None or other.tool is None else [(one.tool[:1], other.tool[:1])]
    if any(np.abs(before - after).max(initial=0.0) > SAME_REFERENCE for before, after in pairs):
        return False
    on = [each.load_fractions[model.joints.loads] > 0.0 for each in (one, other)]
    well = [np.ones(len(on[0])) if each.motor_health is None else each.motor_health for each in (one, other)]
    return bool((on[0] == on[1]).all() and (well[0] == well[1]).all())


class Noticed(NamedTuple):
    """Of the plant what somebody may act on."""

    charges: FloatArray
    """Of each store [1]."""
    temperatures: FloatArray
    """Likewise [K]."""
    given: float
    """By all sources [W]."""
    taken: float
    """By all loads [W]."""
    short: tuple[bool, ...]
    """Buses that fall short or are locked out, and blown fuses."""
    lit: bool
    """Whether the Sun is up."""

    def differs(self, now: "Noticed") -> bool:
        """Whether it is no longer what it was."""
        most = POWER_STEP * max(self.given, self.taken, now.taken)
        return bool(
            self.short != now.short
            or self.lit != now.lit
            or np.abs(now.charges - self.charges).max(initial=0.0) > CHARGE_STEP
            or np.abs(now.temperatures - self.temperatures).max(initial=0.0) > TEMPERATURE_STEP
            or abs(now.given - self.given) > most
        )


def _seen(model: PlantModel, state: PlantState, output: NetworkOutput) -> Noticed:
    stores, fuses = state.power.stores, state.power.fuses
    blown = () if fuses is None else tuple(bool(each) for each in fuses.blown)
    return Noticed(
        np.array([store.soc for store in stores]),
        np.array([store.temperature for store in stores]),
        float(sum(output.source_powers)),
        float(output.load_power.sum()),
        (*(served < 1.0 for served in output.served), *output.locked_out, *blown),
        sunlight_on(model, state).direct > 0.0,
    )


def leap(
    model: PlantModel, state: PlantState, rest: Rest, command: PlantCommand, spans: Iterable[int]
) -> tuple[PlantState, PlantOutput]:
    """Spans of so many control periods each, fewer of them where something ends it.

    Args:
        model: the machine and its ground. state: in which it rests. rest: deep. command: holds for all of it.

    Returns:
        the state at the end; what was seen on the way, powers and currents in the mean.

    Raises:
        InvalidValueError: a machine that has not been seen at rest.
    """
    if rest.output is None or not rest.is_deep:
        raise InvalidValueError("periods at rest before a leap", rest.periods, f"{REST_PERIODS} or more")
    begun, parts = None, MOST_PARTS
    taken, supplies = list[int](), list[NetworkOutput]()
    for span in spans:
        left = span
        while left > 0:
            before, periods = state, min(-(-span // parts), left)
            state, supply = _long_step(model, before, rest.output, command, periods)
            taken.append(periods)
            supplies.append(supply)
            left -= periods
            begun = begun or _seen(model, before, supply)
            parts = _parts_after(parts, _heated(before, state))
        if begun is not None and begun.differs(_seen(model, state, supplies[-1])):
            break
    return state, replace(rest.output, power=_mean(supplies, taken))


def _heated(before: PlantState, after: PlantState) -> float:
    """By how much a node of the machine's heat has become warmer or colder at most [K]."""
    if before.heat is None or after.heat is None:
        return 0.0
    nodes = [state.nodes.thermal.temperatures for state in (before.heat, after.heat)]
    return float(np.abs(nodes[1] - nodes[0]).max(initial=0.0))


def _parts_after(parts: int, heated: float) -> int:
    """Into how many steps the next span falls."""
    if heated > HEATED_FAST:
        return min(2 * parts, MOST_PARTS)
    return max(parts // 2, 1) if heated < 0.25 * HEATED_FAST else parts


def _mean(supplies: Sequence[NetworkOutput], periods: Sequence[int]) -> NetworkOutput:
    """Powers and currents of a leap in the mean of its steps, the rest as at its end."""
    weights = np.array(periods) / sum(periods)

    def mean(name: str) -> FloatArray:
        found: FloatArray = weights @ np.array([getattr(supply, name) for supply in supplies], dtype=np.float64)
        return found

    return supplies[-1]._replace(
        load_power=mean("load_power"),
        load_current=mean("load_current"),
        store_currents=tuple(mean("store_currents").tolist()),
        source_powers=tuple(mean("source_powers").tolist()),
        converter_powers=tuple(mean("converter_powers").tolist()),
    )


def _long_step(
    model: PlantModel, state: PlantState, output: PlantOutput, command: PlantCommand, periods: int
) -> tuple[PlantState, NetworkOutput]:
    """Power, heat and the account of so many control periods at rest, in one step."""
    dt = periods * model.simulation.control_period
    holds = np.array([load.kind == "commanded" for load in model.loads])
    held = np.where(holds, output.power.load_power, 0.0) * dt
    lost = float(held.sum())
    middle = replace(state, tick=state.tick + periods // 2)
    network, supply, heat = powered(model, middle, command.load_fractions, Moved(held, lost), periods)
    old = state.energy
    after = replace(
        state,
        tick=state.tick + periods,
        power=network,
        heat=heat,
        conditions=_warmed(model, state, output, command, dt),
        energy=replace(old, electrical=old.electrical + lost, winding_heat=old.winding_heat + lost),
    )
    return after, supply


def _warmed(
    model: PlantModel, state: PlantState, output: PlantOutput, command: PlantCommand, dt: float
) -> FloatArray | None:
    """Heat of the motors, and their brakes, after a time [s] in which they hold."""
    if model.conditions is None or state.conditions is None:
        return state.conditions
    limits = (command.load_fractions * model.power.served_at_loads(state.power))[model.joints.loads]
    if command.motor_health is not None:
        limits = limits * command.motor_health
    parameters, around = model.conditions.now(state.conditions), model.round_drives(state.heat)
    return model.conditions.after(state.conditions, parameters, output.currents**2, limits, dt, around)
