"""The faults of the plant by the messages of /faults.

A fault that a sound machine can have is taken as it arrives; whether it can be besides those that are there is seen
when it is to come, and refused then.
"""

from collections.abc import Sequence
from typing import Any

from sojourn_contract.app import Refusal
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.fault_messages import FaultEvent, read_fault
from sojourn_contract.goal_topics import FAULTS_TOPIC
from sojourn_machine.errors import InvalidValueError, MachineError
from sojourn_machine.fault_choice import FaultableMachine, FaultChoice
from sojourn_physics.faults.acting import Acting, FaultyPlant, without
from sojourn_physics.faults.plant_fault import PlantFault
from sojourn_physics.plant.model import PlantModel
from sojourn_physics.plant.state import PlantCommand, PlantState


class PlantFaults:
    """Takes faults, and says what the plant is with them.

    Args:
        model: without a fault. machine: what may have one.
    """

    def __init__(self, model: PlantModel, machine: FaultableMachine) -> None:
        self._plant, self._machine = FaultyPlant(model), machine

    def check(self, message: Any) -> None:
        """Raise RefusedMessageError for what the machine cannot have; faults of other roles are theirs to judge."""
        event = read_fault(message)
        if isinstance(event.fault, PlantFault):
            check_fits(event.fault, self._machine)

    def after(
        self, acting: Acting, goals: Sequence[tuple[str, Any]], machine: PlantState
    ) -> tuple[Acting, list[Refusal]]:
        """Those that act from here on, and what cannot be. machine: state of the plant now."""
        refusals = list[Refusal]()
        for name, message in goals:
            if name != FAULTS_TOPIC:
                continue
            event = read_fault(message)
            try:
                changed = self._with(acting, event, machine)
                self._plant.model(changed)
                acting = changed
            except MachineError as error:
                refusals.append((name, str(refusal_of(event.fault, error))))
        return acting, refusals

    def _with(self, acting: Acting, event: FaultEvent, machine: PlantState) -> Acting:
        if not event.comes:
            return without(acting, event.name)
        if isinstance(event.fault, PlantFault):
            return self._plant.with_fault(acting, event.fault, event.name, machine)
        return acting

    def on(self, acting: Acting, command: PlantCommand) -> tuple[PlantModel, PlantCommand]:
        """The plant as it is, and the command as it gets it."""
        return self._plant.on(acting, command)


def check_fits(fault: PlantFault, machine: FaultableMachine) -> None:
    """Raise RefusedMessageError for a fault that a machine cannot have."""
    try:
        for key, value, allowed in fault.problems(machine):
            raise RefusedMessageError(FAULTS_TOPIC, key, str(value), allowed.rpartition("allowed is ")[2])
    except MachineError as error:
        raise refusal_of(fault, error) from None


def refusal_of(fault: FaultChoice, error: MachineError) -> RefusedMessageError:
    """Of a fault that a machine cannot have."""
    if isinstance(error, InvalidValueError):
        return RefusedMessageError(FAULTS_TOPIC, error.name, error.value, error.allowed)
    return RefusedMessageError(FAULTS_TOPIC, fault.kind, fault.called, str(error))
