"""An app that does not hear all that is said to it, or not as it was said: faults between the nodes.

What is lost, late, repeated, corrupted or stamped by a clock that is off is settled here, where a role takes messages,
from their stamps and the run's seed alone: a run is the same in every layout, its record has what was said, and the app
knows nothing of it.
Of a topic with a rate it is given, as everywhere, the newest message that has arrived, none where that is older than
the topic allows; messages of a topic do not overtake each other. Of an operator's goals it is given those that arrive.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from sojourn_contract.app import Answer, App, Period, Refusal
from sojourn_contract.arrival import check_input
from sojourn_contract.corruption import bits_of, with_bit_flipped
from sojourn_contract.disturbances import LISTENERS, concerns
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.kept_data import Kept
from sojourn_contract.kept_goal import newly_kept
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topic_types import Topic
from sojourn_contract.unfinished_image import finished
from sojourn_contract.values import Message
from sojourn_machine.chance import chance
from sojourn_machine.disturbance import Disturbance
from sojourn_machine.evolution import replace

State = TypeVar("State")
BIT = 1
"""Salt of which bit is another; 0 is whether any is."""


@dataclass(frozen=True, slots=True)
class Way:
    """The messages of one topic on their way."""

    coming: tuple[tuple[int, Message], ...] = ()
    """When each arrives [ns], in this order, and what arrives."""
    newest: Message = None
    """Of those that have; None: none, or one that was refused."""
    heard: int = -1
    """Stamp of the last one that was sent [ns]."""


@dataclass(frozen=True, slots=True)
class DisturbedState(Generic[State]):
    """Of the app, and of what is on its way to it."""

    app: State
    ways: Mapping[str, Way] = field(default_factory=dict)
    """By topic."""
    kept: Kept | None = None
    """What the app must not lose."""
    restarts: int = 0
    """How many are over."""


def undisturbed(state: Any) -> Any:
    """Of an app's state, which may be among disturbances, what is the app's own."""
    return state.app if isinstance(state, DisturbedState) else state


def disturbed(app: App[Any], table: TopicTable, disturbances: Sequence[Disturbance]) -> App[Any]:
    """An app among the disturbances of its run; itself where none concerns it."""
    if not disturbances:
        return app
    rows = [row for row in table if app.role in row.subscribers and app.role in LISTENERS]
    ways = {row.name: [each for each in disturbances if concerns(each, row)] for row in rows}
    ends = [each for each in disturbances if each.effect in ("restarted", "killed") and each.role == app.role]
    if not ends and not any(ways.values()):
        return app
    return DisturbedApp(app, {table.topic(name): found for name, found in ways.items() if found}, ends)


class DisturbedApp(App[DisturbedState[Any]]):
    """See the module.

    Args:
        app: that is disturbed. ways: what meets the messages of its rows. ends: of its node's process.
    """

    def __init__(self, app: App[Any], ways: Mapping[Topic, Sequence[Disturbance]], ends: Sequence[Disturbance]) -> None:
        self._app, self._killed = app, [each for each in ends if each.effect == "killed"]
        self._restarts = sorted(stamp for each in ends if (stamp := each.begins_anew) is not None)
        self._rows = {row.name: row for row in ways}
        self._met = {row.name: tuple(found) for row, found in ways.items()}
        self.role, self.acts_in_silence = app.role, app.acts_in_silence  # type: ignore[misc]

    def warm_up(self) -> None:
        """See App."""
        self._app.warm_up()

    def initial_state(self) -> DisturbedState[Any]:
        """See App."""
        return DisturbedState(self._app.initial_state(), {name: Way() for name in self._rows})

    def step(self, state: DisturbedState[Any], period: Period) -> tuple[DisturbedState[Any], Answer]:
        """See App."""
        app, kept, restarts = state.app, state.kept, state.restarts
        if restarts < len(self._restarts) and self._restarts[restarts] <= period.stamp:
            app, restarts = self._app.started_again(self._app.initial_state(), period.stamp, kept), restarts + 1
        is_dead = any(each.meets(period.stamp) for each in self._killed)
        refusals = list[Refusal]()
        ways, inputs, goals = dict(state.ways), dict(period.inputs), list[tuple[str, Any]]()
        for name, goal in period.goals:
            if name in self._rows:
                ways[name] = self._sent(ways[name], name, goal, period.stamp, refusals)
            else:
                goals.append((name, goal))
        for name, row in self._rows.items():
            if row.is_event:
                ways[name], arrived = _arrived(ways[name], period.stamp)
                goals += [(name, goal) for goal in arrived]
            elif name in inputs:
                ways[name] = self._sent(ways[name], name, inputs[name], period.stamp, refusals)
                ways[name], arrived = _arrived(ways[name], period.stamp)
                if arrived:
                    ways[name] = replace(ways[name], newest=arrived[-1])
                inputs[name] = _young(row, ways[name].newest, period.stamp)
        # the steps of a dead node go on, for whoever waits for its messages in lock-step, and nobody acts on them
        app, answer = self._app.step(app, replace(period, inputs=inputs, goals=[] if is_dead else goals))
        if self._restarts and not is_dead:
            kept = self._kept(kept, app, period.stamp)
        answer = replace(answer, refusals=(*refusals, *answer.refusals)) if refusals else answer
        return DisturbedState(app, ways, kept, restarts), answer

    def first_messages(self, state: DisturbedState[Any], stamp: int) -> Iterable[tuple[str, Any]]:
        """See App."""
        return self._app.first_messages(state.app, stamp)

    def check(self, row: Topic, message: Any) -> None:
        """See App."""
        self._app.check(row, message)

    def on_new_time(self, state: DisturbedState[Any]) -> DisturbedState[Any]:
        """See App."""
        return replace(state, app=self._app.on_new_time(state.app), ways={name: Way() for name in self._rows})

    def to_keep(self, state: DisturbedState[Any]) -> Mapping[str, Any] | None:
        """See App."""
        return self._app.to_keep(state.app)

    def started_again(self, state: DisturbedState[Any], stamp: int, kept: Kept | None) -> DisturbedState[Any]:
        """See App."""
        over = sum(begins <= stamp for begins in self._restarts)
        return replace(state, app=self._app.started_again(state.app, stamp, kept), restarts=over)

    def heartbeat_values(self, state: DisturbedState[Any], stamp: int) -> dict[str, str]:
        """See App."""
        return self._app.heartbeat_values(state.app, stamp)

    def _sent(self, way: Way, name: str, message: Message, now: int, refusals: list[Refusal]) -> Way:
        """With a message that has been sent, if it is a new one; what comes of it is settled by its stamp, or where it
        has none by the time.
        """
        row = self._rows[name]
        stamp = getattr(message, "stamp", 0) or now
        if not row.is_event and stamp == way.heard:
            return way
        effects = [each for each in self._met[name] if each.meets(stamp)]
        if any(each.effect in ("lost", "killed") for each in effects):
            return replace(way, heard=stamp)
        times = 1
        arrives = max([now, *(stamp + each.delay for each in effects), *(at for at, _ in way.coming)])
        for each in effects:
            if each.effect == "twice":
                times = 2
            elif each.effect == "corrupted" and message is not None:
                message = self._corrupted(row, message, each, refusals)
            elif each.effect == "shifted" and message is not None and getattr(message, "stamp", 0) > 0:
                message = _shifted(row, message, each.shift, now, refusals)
        if row.is_event and message is None:
            times = 0
        elif not row.is_event and times > 1:
            refused = RefusedMessageError(name, "header.stamp", f"{stamp / NANOSECONDS:.3f} s", "each message once")
            refusals.append((name, str(refused)))
            times = 1
        return replace(way, coming=(*way.coming, *[(arrives, message)] * times), heard=stamp)

    def _corrupted(self, row: Topic, message: Message, by: Disturbance, refusals: list[Refusal]) -> Message:
        """With a bit that is another, as it is read; None where that is refused."""
        message = finished(message)
        bit = int(chance(by.stream, BIT, message.stamp // CONTROL_PERIOD_NS) * bits_of(message))
        try:
            read = with_bit_flipped(message, bit)
            check_input(row, read)
            self._app.check(row, read)
        except RefusedMessageError as refusal:
            refusals.append((row.name, str(refusal)))
            return None
        return read

    def _kept(self, kept: Kept | None, app: Any, stamp: int) -> Kept | None:
        """What the app must not lose, as often as a node writes it."""
        return newly_kept(kept, stamp, lambda: self._app.to_keep(app)) or kept


def _arrived(way: Way, now: int) -> tuple[Way, list[Message]]:
    """What is left on its way, and what has come."""
    if not way.coming:
        return way, []
    arrived = [message for at, message in way.coming if at <= now]
    return replace(way, coming=way.coming[len(arrived) :]), arrived


def _shifted(row: Topic, message: Message, by: int, now: int, refusals: list[Refusal]) -> Message:
    """With the stamp of a clock that is off; None where that is refused, as in real time."""
    told, oldest = message.stamp + by, now - int(row.max_age_s * NANOSECONDS)
    if oldest <= told <= now:
        return message._replace(stamp=told)
    allowed = (
        f"simulation time, {now / NANOSECONDS:.3f} s at most"
        if told > now
        else f"{oldest / NANOSECONDS:.3f} s or later"
    )
    refused = RefusedMessageError(row.name, "header.stamp", f"{told / NANOSECONDS:.3f} s", allowed)
    refusals.append((row.name, str(refused)))
    return None


def _young(row: Topic, message: Message, now: int) -> Message:
    """A message, None where it is older than its row allows."""
    if message is None or now - message.stamp > row.max_age_s * NANOSECONDS:
        return None
    return message
