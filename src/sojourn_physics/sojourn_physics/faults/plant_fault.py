"""What a fault of the plant is: another machine, or another command on its way to the joints.

A kind says in which of three ways it acts; what it does not say stays as it is:

    given    what a plant is made of: its power supply, its site
    model    the tables of a plant that has just been made, in place
    command  what the machine is told, period by period

A machine with faults is thus a plant like any other, and one without them pays nothing.
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar

from pydantic import Field

from sojourn_machine.fault_choice import FaultableMachine, FaultChoice, FaultProblem, unknown
from sojourn_physics.plant.state import PlantCommand, PlantState

if TYPE_CHECKING:
    from sojourn_physics.plant.model import PlantGiven, PlantModel


class PlantFault(FaultChoice):
    """Base of the kinds."""

    role: ClassVar[str] = "plant"

    def noted(self, model: "PlantModel", state: PlantState) -> float:
        """A number that is remembered of the moment at which it comes."""
        return 0.0

    def given(self, given: "PlantGiven") -> "PlantGiven":
        """What the plant is made of with the fault. Raises InvalidValueError where it cannot be of that."""
        return given

    def model(self, model: "PlantModel") -> None:
        """Change the tables of a plant made for the fault alone. Raises InvalidValueError where it has none such."""

    def command(self, model: "PlantModel", command: PlantCommand, noted: float) -> PlantCommand:
        """The command as the machine gets it; the one given is not changed. noted: what `noted` said."""
        return command


class JointFault(PlantFault):
    """One of a joint with a motor."""

    target: ClassVar[str] = "joint"
    joint: str = Field(min_length=1, description="joint with a motor")

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        driven = [joint for drive in machine.machine.drives for joint in drive.joints]
        return unknown("joint", self.joint, driven, "has no motor")


class LoadFault(PlantFault):
    """One of a load of a bus."""

    target: ClassVar[str] = "load"
    load: str = Field(min_length=1, description="name of the load")

    def problems(self, machine: FaultableMachine) -> Iterable[FaultProblem]:
        """See FaultChoice."""
        return unknown("load", self.load, [load.name for load in machine.power.loads], "is no load of a bus")
