"""A role of a bag that was recorded in real time, replayed by what it heard: its app does again, period by period, what
it did then, on the messages on which it did it.
"""

from collections.abc import Iterable, Iterator
from typing import Any

from sojourn_bags.comparison import compare
from sojourn_bags.errors import ReplayError
from sojourn_bags.heard_script import HeardScript
from sojourn_bags.replay import Replay
from sojourn_bags.replay_script import ReplayScript
from sojourn_contract.app import App, Period
from sojourn_contract.codecs import decode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topic_types import Topic
from sojourn_contract.values import Message
from sojourn_stack.answers import OwnAnswers


def replay_as_heard(heard: HeardScript, app: App[Any]) -> Replay:
    """Replay a script through the app of its role. Raises ReplayError for bytes that hold no message of their type."""
    script, answers = heard.script, OwnAnswers(heard.script)
    state, before = app.initial_state(), 0
    answers.take(_named(script, app.first_messages(state, CONTROL_PERIOD_NS)))
    try:
        for period in heard.periods:
            if period.at <= before:
                state = app.on_new_time(state)
            before = period.at
            inputs = {name: _decoded(script, name, data) for name, data in period.inputs.items()}
            goals = [(name, _decoded(script, name, data)) for name, data in period.goals]
            state, answer = app.step(state, Period(period.at, inputs, goals, period.last_refusal))
            answers.take(_named(script, answer.messages))
    except RefusedMessageError as error:
        raise ReplayError(f"a message that was heard is none: {error}") from error
    return Replay(script, answers.by_topic, compare(script.recorded, answers.by_topic))


def _named(script: ReplayScript, said: Iterable[tuple[str, Message]]) -> Iterator[tuple[Topic, Message]]:
    """What was said on topics of the run, with their rows: `first_messages` may have others."""
    return ((row, message) for name, message in said if (row := script.table.get(name)) is not None)


def _decoded(script: ReplayScript, name: str, data: bytes | None) -> Any:
    return None if data is None else decode(script.table.topic(name), data)
