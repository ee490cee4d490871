"""How the rover stands under its arm: what its wheels carry, found anew a few times a second."""

from dataclasses import dataclass

from sojourn_arm.measurements import Measured
from sojourn_contract.values import JointState
from sojourn_flight.arm.footing import Footing, FootingLoads
from sojourn_flight.arm.params import ArmParams
from sojourn_machine.evolution import replace
from sojourn_machine.machine import MachineParams

PERIODS = 5
"""Between two looks: by then a joint has turned by 0.03 rad at most, and the wheels' loads by as little."""


@dataclass(frozen=True, slots=True)
class LastLoads:
    """By the last look."""

    loads: FootingLoads | None = None
    """None before it, and of a machine that stands fast."""
    age: int = 0
    """Periods in which they have been used."""


NOTHING_KNOWN = LastLoads()


class Stand:
    """Finds the loads of the wheels; none for a machine that stands fast.

    Args:
        machine: its wheels, drives and couplings.
    """

    def __init__(self, params: ArmParams, urdf_xml: str, machine: MachineParams) -> None:
        joints, links = params.joint_names, (params.base_link, params.tip_link)
        self._footing = Footing(urdf_xml, machine, joints, *links) if machine.wheels else None

    def loads(self, last: LastLoads, joints: JointState, measured: Measured, moves: bool) -> LastLoads:
        """Loads for this period, from /joint_states and what the arm took from it; an arm that does not move needs
        none.
        """
        if self._footing is None or not moves:
            return NOTHING_KNOWN
        if last.loads is None or last.age >= PERIODS:
            suspension = dict(zip(joints.names, joints.position, strict=True))
            return LastLoads(self._footing.loads(suspension, measured.positions, measured.gravity), 1)
        return replace(last, age=last.age + 1)
