"""Names of the kinds of faults, for those who only name them; `fault_choice` has what each of them asks for."""

from typing import TYPE_CHECKING

from sojourn_machine.registry import Registry

if TYPE_CHECKING:
    from sojourn_machine.fault_choice import FaultChoice

FAULTS: "Registry[type[FaultChoice]]" = Registry("sojourn.faults", "kind of fault")
"""What each kind asks for, by its name."""
