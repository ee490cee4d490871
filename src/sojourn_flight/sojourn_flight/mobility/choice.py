"""What a machine moves on, as its flight file says it: a mobility by its name, with its own parameters.

A kind is found by its name when it is needed (entry points `sojourn.mobility`), so that goals, planning, odometry and
supervision know none of them, and one may come from any package. See `mobility` for what it must do.
"""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, SerializeAsAny

from sojourn_machine.body import JointPlace, MachineBody
from sojourn_machine.choice import kinds_of
from sojourn_machine.machine import MachineParams
from sojourn_machine.params import Params
from sojourn_machine.registry import Registry

if TYPE_CHECKING:
    from sojourn_flight.mobility.mobility import Mobility
    from sojourn_flight.supervision.params import DriveParams

MOBILITIES: "Registry[type[MobilityChoice]]" = Registry("sojourn.mobility", "kind of mobility")
"""Parameter sets of what a machine may move on, by their names."""


class MobilityChoice(Params):
    """A mobility by its name: `mobility` of the table `drive`. Each kind has a subclass with its parameters."""

    kind: str = Field(description="kind of mobility")

    def joints(self, machine: MachineParams) -> tuple[str, ...]:
        """Joints of the machine that move it, in the order of its commands."""
        raise NotImplementedError

    def excesses(self, machine: MachineParams, joints: Mapping[str, JointPlace]) -> Iterator[tuple[str, float, float]]:
        """Keys that ask for more than the machine's joints can do: name, value, and the most that they can."""
        del machine, joints
        yield from ()

    def build(self, drive: "DriveParams", body: MachineBody) -> "Mobility[Any]":
        """The mobility of one machine. Raises MachineError where the machine has not what this kind needs."""
        raise NotImplementedError


ChosenMobility = Annotated[SerializeAsAny[MobilityChoice], *kinds_of(MOBILITIES, "kind")]
