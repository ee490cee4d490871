"""Base of the parameter sets of contact laws: which law, what of the soil it needs, its part of the wheel's row."""

from enum import IntEnum
from typing import Any, ClassVar

from sojourn_machine.contact_choice import ContactChoice
from sojourn_machine.params import FloatArray
from sojourn_physics.soil.params import SoilParams

FIRM_GROUND = ("n", "k_c", "k_phi", "friction_angle_deg", "contact_damping")
"""What every law needs of the ground: how it gives way, and its friction."""
YIELDING_SOIL = (
    *FIRM_GROUND,
    "cohesion",
    "shear_modulus",
    "shear_modulus_lateral",
    "theta_m_c1",
    "theta_m_c2",
    "density",
)
"""What a law of soil that shears and flows needs."""


class ContactLawParams(ContactChoice):
    """One contact law with its own parameters. Each law has a subclass, registered under the value of its `model`."""

    needs: ClassVar[tuple[str, ...]] = YIELDING_SOIL
    """Fields of `SoilParams` without which the law cannot be used."""
    columns: ClassVar[type[IntEnum] | None] = None
    """Places of the fields in the wheel's row, by their names."""

    @classmethod
    def law(cls) -> Any:
        """The compiled law, as `contact_law` says."""
        raise NotImplementedError

    def missing_in(self, soil: SoilParams) -> tuple[str, ...]:
        """What the law needs of a soil and the soil does not give."""
        return soil.missing(self.needs)

    def fill(self, row: FloatArray) -> None:
        """Write the law's own parameters into a wheel's row."""
        for column in self.columns or ():
            row[column] = getattr(self, column.name.lower())
