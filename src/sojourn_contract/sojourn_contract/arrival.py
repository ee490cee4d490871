"""What the contract refuses of a message on its arrival, whoever takes it."""

from collections.abc import Callable

from sojourn_contract.checks import check_complete, check_message
from sojourn_contract.clouds import check_cloud
from sojourn_contract.errors import RefusedMessageError, unreadable
from sojourn_contract.events import parse_tick
from sojourn_contract.heartbeat import status_values
from sojourn_contract.switches import check_switches
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Message

TICK = "/operator/tick"
SWITCHES = "/power/switches"
MEASURED_BY = ("plant", "sensors")
"""Publishers whose joint states are measurements: complete, or refused."""


def check_input(row: Topic, message: Message) -> None:
    """Raise RefusedMessageError for a message that no node may take."""
    check_message(row.name, message)
    if row.name == TICK:
        parse_tick(message.frame)
    elif row.name == SWITCHES:
        check_switches(row.name, status_values(message))
    elif row.type == "sensor_msgs/PointCloud2":
        check_cloud(row, message)
    elif row.type == "sensor_msgs/JointState" and row.publisher in MEASURED_BY:
        check_complete(row.name, message)


def refusal_of(check: Callable[[Topic, Message], None], row: Topic, message: Message) -> str:
    """Why a message does not pass a check, empty where it does; whatever the check raises is the message's fault."""
    try:
        check(row, message)
    except RefusedMessageError as refusal:
        return str(refusal)
    except Exception as error:
        return str(unreadable(row.name, f"a {row.type} that can be read", error))
    return ""
