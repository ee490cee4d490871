"""Current and voltage of motors as a message: the plant tells them in runs of machines with a sensor of them."""

from collections.abc import Mapping, Sequence

from sojourn_contract.heartbeat import status_message, status_values
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.values import DiagnosticArray
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray

MOTORS = Topic(
    "/truth/motors",
    "diagnostic_msgs/DiagnosticArray",
    "plant",
    ("sensors",),
    5,
    0.5,
    "true current and voltage of each motor, `current JOINT` [A] and `voltage JOINT` [V]; in runs of machines with a "
    "sensor of them",
    (FieldRule("status.values", "A, V"),),
)
QUANTITIES = ("current", "voltage")


def motors_message(stamp: int, joints: Sequence[str], told: Mapping[str, FloatArray]) -> DiagnosticArray:
    """Of motors by their joints; told: of each of QUANTITIES, (n,)."""
    values = {
        f"{quantity} {joint}": f"{number:.9g}"
        for quantity in QUANTITIES
        for joint, number in zip(joints, told[quantity].tolist(), strict=True)
    }
    return status_message(stamp, "motors", values)


def of_motors(message: DiagnosticArray, quantity: str, joints: Sequence[str]) -> list[float]:
    """What a message says of one of QUANTITIES, of these joints. Raises InvalidValueError where it does not."""
    values = status_values(message)
    try:
        return [float(values[f"{quantity} {joint}"]) for joint in joints]
    except (KeyError, ValueError) as error:
        raise InvalidValueError(
            f"{MOTORS.name} {quantity}", str(error), f"a number for each of {', '.join(joints)}"
        ) from None
