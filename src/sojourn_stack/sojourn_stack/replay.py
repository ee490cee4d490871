"""Replays one role of a bag without middleware: its app hears what it heard in the run, and its answers are compared.

with run_configuration(bag) as configuration:
    result = replay(bag, "drive", app_of("drive", configuration))
result.comparison.verdict, result.answers["/odom"]

The values are those of the replay over topics (`sojourn_bags.replay`), in a small part of its time; what only a
middleware can tell, endpoints and their quality of service, it cannot.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from sojourn_bags.comparison import compare
from sojourn_bags.definitions import full_type
from sojourn_bags.errors import ReplayError
from sojourn_bags.reading import Bag, Messages
from sojourn_bags.replay import Replay
from sojourn_bags.replay_script import HEARTBEATS, ReplayScript, script_of
from sojourn_bags.run_configuration import RunConfiguration
from sojourn_config.scenario import load_scenario
from sojourn_contract.app import App
from sojourn_contract.codecs import encode
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Message
from sojourn_stack.apps import APPS
from sojourn_stack.errors import WaitingError
from sojourn_stack.recorded_role import recorded_role
from sojourn_stack.stack import Said, Stack


def app_of(role: str, configuration: RunConfiguration) -> App[Any]:
    """The app of a role, as its node makes it of a bag's configuration. Raises ConfigError."""
    app = APPS[role].of(load_scenario(configuration.scenario, configuration.overrides))
    app.warm_up()
    return app


def replay(bag: Bag, role: str, app: App[Any]) -> Replay:
    """Replay a bag through the app of a role.

    Raises:
        ReplayError: the bag cannot be replayed through this role, or not without middleware.
        OtherContractError, IncompleteConfigError: of the bag.
    """
    script = script_of(bag, role)
    answers = _Answers(script)
    stack = _stack(script, bag.topics, app)
    state, said = stack.begin()
    answers.take(said)
    for step in script.steps:
        if step.unannounced:
            name = min(step.unannounced)
            raise ReplayError(f"a goal on {name} was sent by hand: its bag is replayed over topics alone")
        try:
            state, said = stack.step(state)
        except WaitingError as error:
            raise ReplayError(f"{bag.path}: {error}") from error
        answers.take(said)
    return Replay(script, answers.by_topic, compare(script.recorded, answers.by_topic))


def _stack(script: ReplayScript, topics: Mapping[str, Messages], app: App[Any]) -> Stack:
    """The role's app among the others of the run, who say what they said."""
    roles = [role for role in APPS if role in script.participants]
    apps: dict[str, App[Any]] = {
        role: recorded_role(role, script.table.outputs_of(role, {*script.participants, role}), topics, script.leaps)
        for role in roles
        if role != script.role
    }
    return Stack({role: apps.get(role, app) for role in roles}, script.participants, script.table)


class _Answers:
    """What a role says, as its bag would have it."""

    def __init__(self, script: ReplayScript) -> None:
        self._role = script.role
        self._rows = {row.name for row in script.table.outputs_of(script.role, script.participants) if row.logged}
        self.by_topic: dict[str, Messages] = {}

    def take(self, said: Sequence[Said]) -> None:
        """Of all that is said in a period, the role's own."""
        for row, message in said:
            if row.name in self._rows and (row.name != HEARTBEATS or message.status[0].name == self._role):
                self._keep(row, message)

    def _keep(self, row: Topic, message: Message) -> None:
        messages = self.by_topic.setdefault(row.name, Messages(row.name, full_type(row.type)))
        messages.log_times.append(message.stamp)
        messages.data.append(encode(row, message))
