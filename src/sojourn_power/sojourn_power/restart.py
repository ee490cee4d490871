"""A power manager whose process was started again: it goes on as the one before, or has loads come back in stages.

Beside what the manager's law keeps (`sojourn_flight.power_manager.restart`) these are the last request, and what is
believed of heat, dust on arrays and motors that hold.
"""

from dataclasses import asdict
from typing import Annotated, Any

import numpy as np
from pydantic import Field, ValidationError

from sojourn_contract.kept_data import Kept
from sojourn_flight.power_manager import law, restart
from sojourn_flight.power_manager.params import PowerManagerParams
from sojourn_flight.power_manager.restart import KeptManager, Numbers
from sojourn_machine.errors import InvalidValueError, MachineError
from sojourn_machine.evolution import replace
from sojourn_machine.params import Params
from sojourn_machine.thermal.machine_heat import HeatState
from sojourn_power.memory import PowerState
from sojourn_power.requests import LastRequest

RESTARTED = "the power manager was restarted"


class KeptHeat(Params):
    """Temperatures of the nodes [K], which thermostats call, and for which part of the last step each was closed."""

    temperatures: tuple[Annotated[float, Field(gt=0.0)], ...]
    heating: Numbers
    duty: Numbers


class KeptPower(Params):
    """What is kept of a state, by the names of its fields."""

    manager: KeptManager
    request: LastRequest
    stepped_at: int | None
    looked_at: int = Field(ge=0)
    heat: KeptHeat | None
    clean: float | None = Field(ge=0.0, le=1.0)
    held: float = Field(ge=0.0)


def kept_values(params: PowerManagerParams, state: PowerState) -> dict[str, Any]:
    """What the next process is to know, as JSON has it."""
    return {
        "manager": restart.kept_values(params, state.manager),
        "request": asdict(state.request),
        "stepped_at": state.stepped_at,
        "looked_at": state.looked_at,
        "heat": None if state.heat is None else _kept_heat(state.heat),
        "clean": state.clean,
        "held": state.held,
    }


def started_again(
    params: PowerManagerParams, at_start: HeatState | None, state: PowerState, stamp: int, kept: Kept | None
) -> PowerState:
    """The first state of a process that acts at a stamp [ns].

    Args:
        at_start: heat of the machine at the start of the run; None: its files do not say it.
    """
    why = ""
    try:
        if kept is not None:
            return _going_on(params, at_start, state, stamp, kept)
    except MachineError as error:
        why = f"; what was kept cannot be used: {error}"
    alarm = f"{RESTARTED} and does not know what was asked of it: loads come back one level after another{why}"
    return replace(state, manager=law.in_stages(params, state.manager), alarm=alarm)


def _going_on(
    params: PowerManagerParams, at_start: HeatState | None, state: PowerState, stamp: int, kept: Kept
) -> PowerState:
    """With what was kept. Raises MachineError where that is not what this machine's manager keeps."""
    known = _read(kept.values)
    stepped_at = known.stepped_at if known.stepped_at is not None and known.stepped_at < stamp else None
    elapsed = max(stamp - (kept.stamp if stepped_at is None else stepped_at), 0) * 1e-9
    manager = restart.manager_of(params, known.manager, elapsed)
    charges = ", ".join([f"{store.soc:.1%}" for store in manager.stores if store.soc is not None])
    return replace(
        state,
        manager=manager,
        request=known.request,
        stepped_at=stepped_at,
        looked_at=known.looked_at,
        heat=None if known.heat is None else _heat(at_start, known.heat, known.looked_at * 1e-9),
        clean=known.clean,
        held=known.held,
        alarm=f"{RESTARTED}: it goes on with what was asked of it"
        + (f", from a charge of {charges}" if charges else ""),
    )


def _read(values: Any) -> KeptPower:
    """What was kept. Raises InvalidValueError."""
    try:
        return KeptPower.model_validate(values)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise InvalidValueError(".".join(map(str, first["loc"])), first["input"], first["msg"]) from None


def _kept_heat(heat: HeatState) -> dict[str, Any]:
    of_nodes = {"temperatures": heat.thermal.temperatures.tolist(), "heating": heat.thermal.heating.tolist()}
    return {**of_nodes, "duty": heat.duty.tolist()}


def _heat(at_start: HeatState | None, kept: KeptHeat, age: float) -> HeatState:
    """The heat that was believed, `age` [s] after the start. Raises InvalidValueError for that of another machine."""
    found = [np.array(values) for values in (kept.temperatures, kept.heating, kept.duty)]
    usual = [] if at_start is None else [at_start.thermal.temperatures, at_start.thermal.heating, at_start.duty]
    shapes, allowed = [one.shape for one in found], [one.shape for one in usual]
    if at_start is None or shapes != allowed:
        raise InvalidValueError("heat", shapes, f"arrays of the shapes {allowed}")
    temperatures, heating, duty = found
    thermal = replace(at_start.thermal, temperatures=temperatures, heating=heating, age=age)
    return replace(at_start, thermal=thermal, duty=duty)
