"""Sensors whose process was started again: the node is another one, the sensors are those that they were.

Kept is what is wrong with them, which have power, what the parts themselves remember (`Sensor.hardware`) and what those
repeat that are stuck, images excepted. Noise begins anew, and so does what a camera has been told of the ground. What
has been measured and not told yet is lost, see `Timing.lost`.
"""

from collections.abc import Sequence
from typing import Any

from sojourn_contract.kept_data import Kept
from sojourn_contract.stamps import CONTROL_PERIOD_NS, CONTROL_PERIOD_S
from sojourn_machine.errors import MachineError
from sojourn_machine.evolution import replace
from sojourn_sensors.faults import SensorFaults
from sojourn_sensors.memory import SensorsRestart, SensorsState
from sojourn_sensors.plain import like, plain
from sojourn_sensors.sensor import Sensor, Truth

AnySensor = Sensor[Any, Any, Any]
ALL = "what is wrong with them", "what they remember"
"""That is lost where nothing was kept."""


def kept_values(sensors: Sequence[AnySensor], faults: SensorFaults, state: SensorsState) -> dict[str, Any]:
    """What the next process is to know, as JSON has it."""
    states = zip(sensors, state.sensors or (), strict=False)
    parts = {sensor.name: sensor.hardware(one) for sensor, one in states if one is not None}
    stuck = {name: one.last for name, one in state.faulty.items() if any(fault.stuck for _, fault in one.faults)}
    return {
        "faults": faults.kept(state.faulty),
        "dead": sorted(state.dead),
        "measured_at": state.measured_at,
        "hardware": _plain_ones(parts),
        "repeated": _plain_ones(stuck),
    }


def started_again(faults: SensorFaults, state: SensorsState, stamp: int, kept: Kept | None) -> SensorsState:
    """The first state of a process that acts at a stamp [ns], with what can be used of what was kept."""
    number = stamp // CONTROL_PERIOD_NS
    if kept is None:
        return replace(state, restart=SensorsRestart(number, ALL))
    faulty, lost = faults.of_kept(kept.values.get("faults"))
    hardware, repeated, dead, before = map(kept.values.get, ("hardware", "repeated", "dead", "measured_at"))
    if not (isinstance(hardware, dict) and isinstance(repeated, dict)):
        hardware, repeated, lost = {}, {}, [*lost, ALL[1]]
    return replace(
        state,
        dead=frozenset(name for name in faults.names if name in dead) if isinstance(dead, list) else state.dead,
        faulty=faulty,
        measured_at=before if isinstance(before, int) and 0 < before < stamp else 0,
        restart=SensorsRestart(number, tuple(lost), hardware, repeated),
    )


def begun(sensors: Sequence[AnySensor], state: SensorsState, truth: Truth) -> SensorsState:
    """With what the sensors begin with at the first truth.

    Raises:
        MachineError, RefusedMessageError: the truth is none with which they can.
    """
    states, faulty, restart = [sensor.initial_state(truth) for sensor in sensors], dict(state.faulty), state.restart
    if restart is not None:
        lost = list(restart.lost)
        for place, sensor in enumerate(sensors):
            name = sensor.name
            if name not in restart.hardware and name not in restart.repeated:
                continue
            usual, reading = sensor.step(states[place], truth, CONTROL_PERIOD_S)
            try:
                if name in restart.hardware:
                    part = like(sensor.hardware(usual), restart.hardware[name])
                    states[place] = sensor.with_hardware(states[place], part)
                if name in restart.repeated and name in faulty:
                    last = like(reading, restart.repeated[name], is_reading=True)
                    faulty[name] = replace(faulty[name], last=last)
            except (AttributeError, MachineError, TypeError, ValueError):
                lost.append(f"what {name} remembers")
        restart = SensorsRestart(restart.number, tuple(lost))
    return replace(state, sensors=tuple(states), readings=(None,) * len(states), faulty=faulty, restart=restart)


def _plain_ones(values: dict[str, Any]) -> dict[str, Any]:
    """Those of which there is something to keep, and that can be kept."""
    found = {}
    for name, value in values.items():
        try:
            found[name] = plain(value)
        except TypeError:
            continue
    return {name: value for name, value in found.items() if value is not None}
