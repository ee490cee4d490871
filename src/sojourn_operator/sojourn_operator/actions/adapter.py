"""The adapter beside a running stack: the servers of the actions that are installed, and their goals."""

import argparse
from collections.abc import Callable

from sojourn_config import command_line
from sojourn_config.command_errors import UsageError
from sojourn_contract.topics import topic
from sojourn_contract.values import Message
from sojourn_operator.actions.carrier import Carrier
from sojourn_operator.actions.follow_joint_trajectory import FollowJointTrajectory
from sojourn_operator.actions.kind import ActionKind, action_type
from sojourn_operator.actions.navigate_to_pose import NavigateToPose
from sojourn_operator.actions.server import GoalServer
from sojourn_operator.goal_sending import GoalClient

LOOK_S = 0.05
"""Wall time between two looks at the goals."""
LAST_WORDS_S = 0.3
"""Wall time in which the last results go out."""


def installed(kinds: list[tuple[ActionKind, str]]) -> list[tuple[ActionKind, str]]:
    """Those whose packages are there; of the others it is said that they are not. Raises UsageError if none is."""
    found, missing = [], []
    for kind, name in kinds:
        try:
            action_type(kind)
        except ImportError:
            missing.append(kind.package)
        else:
            found.append((kind, name))
    if missing:
        are, them = ("is", "it") if len(missing) == 1 else ("are", "them")
        words = f"{' and '.join(missing)} {are} not installed: source a ROS 2 Jazzy that has {them}"
        if not found:
            raise UsageError(words)
        command_line.say(words)
    return found


def run(given: argparse.Namespace) -> int:
    """Serve until somebody stops it."""
    kinds = installed([(NavigateToPose(), given.navigate), (FollowJointTrajectory(), given.arm)])
    with GoalClient(given.domain, given.namespace, "actions") as client:
        messages: dict[str, Message] = {}
        names = sorted({name for kind, _ in kinds for name in kind.hears})
        readers = [client.listen(topic(name), _keeping(messages, name), lockstep=False) for name in names]
        servers = [GoalServer(client.node, kind, name, command_line.say) for kind, name in kinds]
        carriers = [Carrier(client, server, messages) for server in servers]
        for server in servers:
            command_line.say(f"{server.kind.package}/{server.kind.name} on {server.name}, {client.place}")
        while not client.stop.is_set:
            client.spin(LOOK_S)
            for carrier in carriers:
                carrier.step()
        for carrier in carriers:
            carrier.drop("the adapter has ended; the machine goes on: stop it with scripts/goal stop")
        client.spin(LAST_WORDS_S)
        for server in servers:
            server.destroy()
        del readers
    return 0


def _keeping(messages: dict[str, Message], name: str) -> Callable[[Message], None]:
    def keep(message: Message) -> None:
        messages[name] = message

    return keep
