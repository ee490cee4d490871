"""When the faults of a scenario come and go: by the time, or by what the operator sees of the run.

The operator sends them like its goals, stamped ahead, so that a run is the same in every layout: a fault that comes at
a time is there at that time (not before the first goals could be), and one that an event brings so long after the look
at which the event is seen as a goal takes to act.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pydantic import TypeAdapter

from sojourn_contract.fault_messages import FaultEvent, fault_message
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.values import DiagnosticArray, Odometry
from sojourn_machine.evolution import replace
from sojourn_machine.fault_choice import FaultChoice, TriggerParams
from sojourn_machine.timing import period_stamp
from sojourn_operator.steps.step import LEAD_NS, GoalReport

NEXT_LOOK_NS = LEAD_NS
"""A fault that is due before what is said at the next look could act is said now [ns]."""


@dataclass(frozen=True, slots=True)
class ScheduleState:
    """How far it is; times by the names of the faults [ns], so that a schedule with others can go on from it."""

    met: Mapping[str, int] = field(default_factory=dict)
    """When an event was seen."""
    begun: Mapping[str, int] = field(default_factory=dict)
    """From when on a fault is there."""
    over: Mapping[str, int] = field(default_factory=dict)
    """From when on it is there no more."""
    distance: float = 0.0
    """Driven so far, in truth [m]."""
    place: tuple[float, float, float] | None = None
    """At the last look, in map [m]."""


_PLAIN = TypeAdapter(ScheduleState)


def schedule_as_data(state: ScheduleState) -> Any:
    """How far a schedule is as plain data, for JSON."""
    return _PLAIN.dump_python(state, mode="json")


def schedule_from_data(data: Any) -> ScheduleState:
    """The reverse of `schedule_as_data`. Raises ValueError."""
    return _PLAIN.validate_python(data)


@dataclass(frozen=True)
class SeenRun:
    """What a look shows.

    Args:
        now: [ns]. steps: how many are over. reports: last word of "drive" and "arm". truth: where the machine is.
    """

    now: int
    steps: int
    reports: Mapping[str, GoalReport]
    truth: Odometry


class FaultSchedule:
    """The faults of a run.

    Args:
        faults: as the scenario has them. seed: of the run.
    """

    def __init__(self, faults: Sequence[FaultChoice], seed: int) -> None:
        self.faults = tuple(faults)
        self._times = {fault.called: fault.time(seed) for fault in faults}

    def look(self, state: ScheduleState, seen: SeenRun) -> tuple[ScheduleState, list[DiagnosticArray]]:
        """Look at the run; what is to be sent now."""
        state = self._moved(state, seen)  # also without a fault: a branch may have one that asks for the distance
        said = []
        for fault in self.faults:
            name = fault.called
            if name not in state.begun:
                if name in state.over:
                    continue
                state, due = self._due(state, fault, seen)
                if due is None or due > seen.now + LEAD_NS + NEXT_LOOK_NS:
                    continue
                stamp = max(due, seen.now + LEAD_NS)
                if fault.until is not None and period_stamp(fault.until) <= stamp:
                    # its event has come too late: it is over, and has never begun
                    state = replace(state, over={**state.over, name: stamp})
                    continue
                said.append(fault_message(stamp, FaultEvent(name, fault, comes=True)))
                state = replace(state, begun={**state.begun, name: stamp})
            elif name not in state.over:
                ends = self._ends(fault, state.begun[name])
                if ends is None or ends > seen.now + LEAD_NS + NEXT_LOOK_NS:
                    continue
                stamp = max(ends, seen.now + LEAD_NS, state.begun[name] + CONTROL_PERIOD_NS)
                said.append(fault_message(stamp, FaultEvent(name, fault, comes=False)))
                state = replace(state, over={**state.over, name: stamp})
        return state, said

    def quiet_until(self, state: ScheduleState) -> float:
        """Until when nothing comes or goes by the clock [s], with a second to say so before; infinity for ever. What an
        event brings comes while the machine does something.
        """
        coming = [self._comes(state, fault) for fault in self.faults]
        times = [time for time in coming if time is not None]
        return min(times) // NANOSECONDS - 1 if times else math.inf

    def _comes(self, state: ScheduleState, fault: FaultChoice) -> int | None:
        """When the next of a fault is due, its beginning or its end, as far as the clock tells [ns]."""
        name = fault.called
        if name in state.over:
            return None
        if name in state.begun:
            return self._ends(fault, state.begun[name])
        time, met = self._times[name], state.met.get(name)
        if time is None and met is not None and fault.when is not None:
            return met + period_stamp(fault.when.later)
        return None if time is None else period_stamp(time)

    def _due(self, state: ScheduleState, fault: FaultChoice, seen: SeenRun) -> tuple[ScheduleState, int | None]:
        """When a fault that has not come yet is due [ns], None as long as nobody knows."""
        name = fault.called
        time = self._times[name]
        if time is not None:
            return state, period_stamp(time)
        trigger = fault.when
        if trigger is None:
            return state, None
        if name not in state.met:
            if not _happened(trigger, state, seen):
                return state, None
            state = replace(state, met={**state.met, name: seen.now})
        return state, state.met[name] + period_stamp(trigger.later)

    @staticmethod
    def _ends(fault: FaultChoice, begun: int) -> int | None:
        """When a fault goes [ns]; None: never."""
        if fault.until is not None:
            return period_stamp(fault.until)
        return None if fault.lasts is None else begun + period_stamp(fault.lasts)

    @staticmethod
    def _moved(state: ScheduleState, seen: SeenRun) -> ScheduleState:
        x, y, z = seen.truth.position.tolist()
        driven = 0.0 if state.place is None else math.dist(state.place, (x, y, z))
        return replace(state, distance=state.distance + driven, place=(x, y, z))


def _happened(trigger: TriggerParams, state: ScheduleState, seen: SeenRun) -> bool:
    if trigger.after_step is not None:
        return seen.steps >= trigger.after_step
    if trigger.distance is not None:
        return state.distance >= trigger.distance
    who, word = ("drive", trigger.drive) if trigger.drive is not None else ("arm", trigger.arm)
    report = seen.reports.get(who)
    return report is not None and report.state == word
