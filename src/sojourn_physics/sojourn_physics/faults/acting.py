"""The faults that a plant has at a moment, and the plant that it is with them."""

from collections.abc import Sequence
from dataclasses import dataclass

from sojourn_machine.fault_choice import FaultChoice
from sojourn_physics.faults.plant_fault import PlantFault
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand, PlantState


@dataclass(frozen=True, slots=True)
class ActingFault:
    """A fault that has come.

    Args:
        fault: which. name: by which it goes again. noted: what it has noted of that moment.
    """

    fault: PlantFault
    name: str
    noted: float = 0.0


Acting = tuple[ActingFault, ...]
"""In the order in which they came."""


class FaultyPlant:
    """A plant that may have faults. Its models differ; state and command are those of all of them.

    Args:
        model: without a fault.
    """

    def __init__(self, model: PlantModel) -> None:
        self.sound = model
        self._made: dict[str, PlantModel] = {}

    def model(self, acting: Acting) -> PlantModel:
        """The plant with faults; made when it is first asked for."""
        if not acting:
            return self.sound
        key = "\n".join(str(one.fault.words()) for one in acting)
        if key not in self._made:
            given = self.sound.given
            for one in acting:
                given = one.fault.given(given)
            made = PlantModel(*given)
            for one in acting:
                one.fault.model(made)
            self._made = {key: made}  # one at a time: it holds a map
        return self._made[key]

    def on(self, acting: Acting, command: PlantCommand) -> tuple[PlantModel, PlantCommand]:
        """The plant as it is with faults, and the command as it gets it."""
        if not acting:
            return self.sound, command
        for one in acting:
            command = one.fault.command(self.sound, command, one.noted)
        return self.model(acting), command

    def with_fault(self, acting: Acting, fault: PlantFault, name: str, state: PlantState) -> Acting:
        """With one more that comes now; one of the same name gives way to it."""
        return (*without(acting, name), ActingFault(fault, name, fault.noted(self.sound, state)))


def without(acting: Acting, name: str) -> Acting:
    """Without the one of a name, if there is one."""
    return tuple(one for one in acting if one.name != name)


class TimedFaults:
    """The faults of a schedule that come at a time, for a loop without an operator.

    Args:
        plant: that has them. schedule: of the run; what is no matter of the plant, or comes by an event, is left out.
        seed: of the run.
    """

    def __init__(self, plant: FaultyPlant, schedule: Sequence[FaultChoice], seed: int = 0) -> None:
        self.plant = plant
        self._times: list[tuple[PlantFault, float, float]] = []
        for fault in schedule:
            begins = fault.time(seed)
            if isinstance(fault, PlantFault) and begins is not None:
                ends = float("inf") if fault.until is None else fault.until
                self._times.append((fault, begins, ends if fault.lasts is None else begins + fault.lasts))

    def at(self, acting: Acting, state: PlantState, time: float) -> Acting:
        """Those that act at a simulated time [s], from those that acted before."""
        for fault, begins, ends in self._times:
            is_there = any(one.name == fault.called for one in acting)
            if begins <= time < ends and not is_there:
                acting = self.plant.with_fault(acting, fault, fault.called, state)
            elif is_there and time >= ends:
                acting = without(acting, fault.called)
        return acting
