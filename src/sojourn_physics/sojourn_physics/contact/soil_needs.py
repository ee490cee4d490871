"""What the supports of a machine need of a soil, each by its law."""

from collections.abc import Iterator

from sojourn_machine.machine import MachineParams
from sojourn_physics.contact.law_params import YIELDING_SOIL
from sojourn_physics.contact.rows import law_of
from sojourn_physics.soil.params import SoilParams


def needs_of_soil(machine: MachineParams, soil: SoilParams) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """Name of each support, of its law, and what that needs of a soil which does not give it."""
    for wheel in machine.wheels:
        yield wheel.name, wheel.contact.model, law_of(wheel.contact).missing_in(soil)
    for track in machine.tracks:
        yield track.name, "track", soil.missing(YIELDING_SOIL)
    for foot in machine.feet:
        yield foot.name, foot.contact.model, law_of(foot.contact).missing_in(soil)
