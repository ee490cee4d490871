"""Replays one role of a bag without middleware: its app hears what it heard in the run, and its answers are compared.

with run_configuration(bag) as configuration:
    result = replay(bag, "drive", app_of("drive", configuration))
result.comparison.verdict, result.answers["/odom"]

The values are those of the replay over topics (`sojourn_bags.replay`), in a small part of its time; what only a
middleware can tell, endpoints and their quality of service, it cannot.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from sojourn_bags.comparison import compare
from sojourn_bags.errors import ReplayError
from sojourn_bags.heard_script import heard_script_of
from sojourn_bags.messages import Messages
from sojourn_bags.provenance import is_in_real_time
from sojourn_bags.reading import Bag
from sojourn_bags.replay import Replay
from sojourn_bags.replay_script import ReplayScript, script_of
from sojourn_bags.run_configuration import RunConfiguration
from sojourn_config.scenario import load_scenario
from sojourn_contract.app import App
from sojourn_contract.codecs import decode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topic_table import TopicTable
from sojourn_stack.answers import OwnAnswers
from sojourn_stack.apps import APPS, make_apps
from sojourn_stack.errors import WaitingError
from sojourn_stack.heard_replay import replay_as_heard
from sojourn_stack.recorded_role import recorded_role
from sojourn_stack.stack import Said, Stack


def app_of(role: str, configuration: RunConfiguration) -> App[Any]:
    """The app of a role, as its node makes it of a bag's configuration: what a fault of the run has done to messages on
    their way is done to them again. Raises ConfigError.
    """
    app = make_apps(load_scenario(configuration.scenario, configuration.overrides), (role,))[role]
    app.warm_up()
    return app


def replay(bag: Bag, role: str, app: App[Any]) -> Replay:
    """Replay a bag through the app of a role: one of lock-step by what was due, one of real time by what was heard.

    Raises:
        ReplayError: the bag cannot be replayed through this role, or not without middleware.
        OtherContractError, IncompleteConfigError: of the bag.
    """
    if is_in_real_time(bag):
        return replay_as_heard(heard_script_of(bag, role), app)
    script = script_of(bag, role)
    answers = OwnAnswers(script)
    stack = _stack(script, bag.topics, app)
    state, said = stack.begin()
    answers.take(said)
    for step in script.steps:
        if step.untold:
            name = min(step.untold)
            raise ReplayError(
                f"a goal on {name} was sent by hand, and nothing tells when {role} took it: replay it over topics"
            )
        try:
            if step.by_hand:
                state = stack.hearing(state, role, _messages(script, step.by_hand))
            state, said = stack.step(state)
        except (WaitingError, RefusedMessageError) as error:
            raise ReplayError(f"{bag.path}: {error}") from error
        answers.take(said)
    return Replay(script, answers.by_topic, compare(script.recorded, answers.by_topic))


def _messages(script: ReplayScript, goals: Sequence[tuple[str, bytes]]) -> list[Said]:
    return [(row, decode(row, data)) for row, data in ((script.table.topic(name), data) for name, data in goals)]


def _stack(script: ReplayScript, topics: Mapping[str, Messages], app: App[Any]) -> Stack:
    """The role's app among the others of the run, who say what they said."""
    roles = [role for role in APPS if role in script.participants]
    apps: dict[str, App[Any]] = {
        role: recorded_role(role, script.table.outputs_of(role, {*script.participants, role}), topics, script.leaps)
        for role in roles
        if role != script.role
    }
    return Stack({role: apps.get(role, app) for role in roles}, script.participants, _heard_by(script))


def _heard_by(script: ReplayScript) -> TopicTable:
    """The topics of the run, of which the role alone hears any: the others say what they said, whatever there is to
    hear, so that a bag need not hold it.
    """
    rows = (replace(row, subscribers=(script.role,) if script.role in row.subscribers else ()) for row in script.table)
    return TopicTable(rows, script.table.longest_leap)
