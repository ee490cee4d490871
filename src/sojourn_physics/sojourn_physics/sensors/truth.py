"""What every emulator asks of the truth that it is given."""

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.finite import all_finite
from sojourn_machine.params import FloatArray


def require_numbers(name: str, value: FloatArray, shape: tuple[int, ...]) -> None:
    """Raise InvalidValueError, with the name, for an array of another shape, or with a number that is not finite."""
    if value.shape != shape:
        raise InvalidValueError(f"shape of {name}", value.shape, str(shape))
    # A sum is not finite where one of its numbers is not, and may be too large where all are.
    if not all_finite(value):
        raise InvalidValueError(name, value.tolist(), "finite numbers")
