"""The contact law of a wheel, by the number in its row."""

from numba import njit

from sojourn_mechanics.contact.contact_law import WheelColumn
from sojourn_mechanics.contact.rigid_wheel_on_soil import rigid_wheel_on_soil
from sojourn_mechanics.params import FloatArray

_MODEL = int(WheelColumn.MODEL)


@njit(cache=True)
def apply_law(
    wheel: FloatArray, soil: FloatArray, motion: FloatArray, dt: float, state: FloatArray, out: FloatArray
) -> None:
    """The law that the wheel's row names; arguments as in `contact_law`."""
    rigid_wheel_on_soil(wheel, soil, motion, dt, state, out)
