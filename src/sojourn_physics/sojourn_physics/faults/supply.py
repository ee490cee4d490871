"""Changes of a machine's power supply, for the faults that are some."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from pydantic import Field, ValidationError

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.fault_choice import FaultableMachine, FaultProblem, first_problem, unknown
from sojourn_machine.params import Params
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.power_params import BATTERY, PowerParams
from sojourn_physics.faults.plant_fault import PlantFault

if TYPE_CHECKING:
    from sojourn_physics.plant.model import PlantGiven

Changed = TypeVar("Changed", bound=Params)


class SupplyFault(PlantFault):
    """A fault with which a machine has another supply."""

    def supply(self, power: PowerParams) -> PowerParams:
        """The supply with the fault. Raises InvalidValueError for one that cannot have it."""
        raise NotImplementedError

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        try:
            self.supply(machine.power)
        except InvalidValueError as error:
            yield error.name, error.value, f"allowed is {error.allowed}"

    def left_of(self, machine: FaultableMachine) -> FaultableMachine:
        """See FaultChoice."""
        return machine._replace(power=self.supply(machine.power))

    def given(self, given: "PlantGiven") -> "PlantGiven":
        """See PlantFault."""
        return given._replace(power=self.supply(given.power))


def batteries(power: PowerParams) -> dict[str, BatteryParams]:
    """The stores that are packs of cells, by their names."""
    return {name: store for name, store in power.all_stores.items() if isinstance(store, BatteryParams)}


class BatteryFault(SupplyFault):
    """A fault that takes a number of cells from a pack."""

    target: ClassVar[str] = "store"
    heals: ClassVar[bool] = False
    taken: ClassVar[str] = ""
    """Key of its own that says how many."""
    number: ClassVar[str] = ""
    """Key of the pack of which they are taken."""
    store: str = Field(default=BATTERY, min_length=1, description="name of the store")

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        yield from (found := list(unknown("store", self.store, batteries(machine.power), "is no battery")))
        if not found:
            yield from super().problems(machine)

    def supply(self, power: PowerParams) -> PowerParams:
        """See SupplyFault."""
        found = batteries(power)
        if self.store not in found:
            raise InvalidValueError("store", self.store, "one of " + ", ".join(found))
        pack, taken = found[self.store], getattr(self, self.taken)
        there = getattr(pack, self.number)
        if taken >= there:
            allowed = f"fewer than the {there} that {self.store} still has: it cannot be without any"
            raise InvalidValueError(self.taken, taken, allowed)
        pack = changed(pack, **{self.number: there - taken})
        if self.store == BATTERY and power.battery is not None:
            return power.model_copy(update={"battery": pack})
        return power.model_copy(update={"stores": {**power.stores, self.store: pack}})


def changed(params: Changed, **changes: Any) -> Changed:
    """With other numbers. Raises InvalidValueError for those that it cannot have."""
    fields = {name: getattr(params, name) for name in type(params).model_fields}
    try:
        return type(params).model_validate({**fields, **changes})
    except ValidationError as error:
        raise first_problem(error, changes) from None
