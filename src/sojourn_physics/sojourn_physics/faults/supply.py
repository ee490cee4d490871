"""Changes of a machine's power supply, for the faults that are some."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.fault_choice import FaultableMachine, FaultProblem, unknown
from sojourn_machine.power.battery import BatteryParams
from sojourn_machine.power.power_params import BATTERY, PowerParams
from sojourn_physics.faults.plant_fault import PlantFault

if TYPE_CHECKING:
    from sojourn_physics.plant.model import PlantGiven


def batteries(power: PowerParams) -> dict[str, BatteryParams]:
    """The stores that are packs of cells, by their names."""
    return {name: store for name, store in power.all_stores.items() if isinstance(store, BatteryParams)}


class BatteryFault(PlantFault):
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
        found, taken = batteries(machine.power), getattr(self, self.taken)
        yield from unknown("store", self.store, found, "is no battery")
        if self.store in found and taken >= (there := getattr(found[self.store], self.number)):
            yield self.taken, taken, f"allowed is fewer than the {there} that {self.store} has"

    def given(self, given: "PlantGiven") -> "PlantGiven":
        """See PlantFault. Raises InvalidValueError where there is no such pack, or too little of it."""
        found, power = batteries(given.power), given.power
        if self.store not in found:
            raise InvalidValueError("store", self.store, "one of " + ", ".join(found))
        pack = found[self.store]
        left = getattr(pack, self.number) - getattr(self, self.taken)
        pack = type(pack).model_validate({**_fields(pack), self.number: left})
        if self.store == BATTERY and power.battery is not None:
            return given._replace(power=power.model_copy(update={"battery": pack}))
        return given._replace(power=power.model_copy(update={"stores": {**power.stores, self.store: pack}}))


def with_source(given: "PlantGiven", name: str, **changes: Any) -> "PlantGiven":
    """A plant whose source of a name has other numbers."""
    source = given.power.sources[name]
    changed = type(source).model_validate({**_fields(source), **changes})
    power = given.power.model_copy(update={"sources": {**given.power.sources, name: changed}})
    return given._replace(power=power)


def _fields(params: Any) -> dict[str, Any]:
    return {name: getattr(params, name) for name in type(params).model_fields}
