"""The link as the operator's role carries it: commands up, telemetry and acknowledgements down. No ROS, no clock.

What scripted or other operators send waits for its turn on the uplink (`sojourn_physics.link.channel`). What arrives is
given out on the goal's own topic, for whoever carries it out, and acknowledged; so is its end, as drive, arm and power
manager tell it. Acknowledgements go down before all telemetry. What the Earth has received is all that the script goes
by: it knows nothing earlier than light.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sojourn_config.scenario import LoadedScenario
from sojourn_contract.app import Period
from sojourn_contract.link_topics import CANCEL, EARTH, PLACE
from sojourn_contract.linked_table import telemetry
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS, seconds
from sojourn_contract.values import DiagnosticArray, Message, Odometry
from sojourn_machine.evolution import replace
from sojourn_operator.goal_messages import report_of, stamped
from sojourn_operator.link.commands import (
    ANSWERS,
    CANCELLED,
    DROPPED,
    EXPIRED,
    FIRST,
    KEPT,
    MOVES,
    RECEIVED,
    ROLE_OF,
    SENT,
    VELOCITIES,
    MachineWord,
    SentCommand,
    TelemetrySample,
    after_word,
    settled,
)
from sojourn_operator.link.length import bits
from sojourn_operator.steps.step import LEAD_NS, GoalReport
from sojourn_physics.link.channel import ChannelState, News, Packet
from sojourn_physics.link.params import LinkParams
from sojourn_physics.link.window import AnyOf

WORD_BITS = 8 * 32
"""Of an acknowledgement: a packet of space telemetry of 32 bytes [bit]."""
STATUSES = tuple(dict.fromkeys(name for name, _, _ in ANSWERS.values()))
_ROLES = {"/drive/status": "drive", "/arm/status": "arm"}
Said = list[tuple[str, Message]]


@dataclass(frozen=True, slots=True)
class LinkState:
    """Of the link, and on both of its ends."""

    up: ChannelState = field(default_factory=ChannelState)
    down: ChannelState = field(default_factory=ChannelState)
    log: tuple[SentCommand, ...] = ()
    """The last commands and the last velocities, the newest last."""
    taken: Mapping[str, int] = field(default_factory=dict)
    """Stamp of the last message of telemetry that has been taken, by topic [ns]."""
    samples: tuple[TelemetrySample, ...] = ()
    """Telemetry since the last look."""
    by_hand: tuple[TelemetrySample, ...] = ()
    """What people have sent since the last look."""
    statuses: Mapping[str, DiagnosticArray] = field(default_factory=dict)
    """Last ones on the machine, by topic."""
    reports: Mapping[str, GoalReport] = field(default_factory=dict)
    """Last ones that the Earth has received, by role."""
    place: Odometry | None = None
    """Where the machine is as the Earth knows: the last /odom that it has received."""


class EarthLink:
    """The link of a run.

    Args:
        scenario: the run's. link: as the scenario has it.

    Raises:
        InvalidValueError, LinkError: it does not fit the site, or the topics of the run.
    """

    def __init__(self, scenario: LoadedScenario, link: LinkParams) -> None:
        self._sky, seed = scenario.link_sky, scenario.config.seed
        link.check(self._sky)
        self._up, self._down = link.up.channel(seed, "up"), link.down.channel(seed, "down")
        self._expires = None if link.expires_s is None else round(link.expires_s * NANOSECONDS)
        self._windows = AnyOf([window.build(self._sky) for window in link.windows])
        self._light_time_s = link.light_time_s
        carried = telemetry(table_of(scenario), link)
        self._telemetry = {row.name: how for row, how in carried}

    def light_time(self, now: int) -> int:
        """One way, at a time [ns]."""
        fixed, earth = self._light_time_s, self._sky.earth
        if fixed is None and earth is not None:
            fixed = earth.light_time(now / NANOSECONDS)
        return round((fixed or 0.0) * NANOSECONDS)

    def window(self, now: int, truth: Odometry) -> tuple[bool, int]:
        """Whether it is open over the machine, and until when that stays as it is at least [ns]."""
        x, y, _ = truth.position.tolist()
        return self._windows.at(now, x, y)

    def heard(self, state: LinkState, period: Period) -> LinkState:
        """With what has come in a period: telemetry on the machine, and what people have sent on Earth."""
        statuses = {name: period.inputs[name] for name in STATUSES if period.inputs.get(name) is not None}
        if statuses:
            state = replace(state, statuses={**state.statuses, **statuses})
        if period.goals:
            state = replace(state, by_hand=(*state.by_hand, *(TelemetrySample(*goal) for goal in period.goals)))
        fresh, taken = list[TelemetrySample](), dict(state.taken)
        for name, how in self._telemetry.items():
            message = period.inputs.get(name)
            last = taken.get(name)
            if message is not None and (last is None or message.stamp >= last + max(1, how.every_s * NANOSECONDS)):
                taken[name] = message.stamp
                fresh.append(TelemetrySample(name, message))
        return replace(state, samples=(*state.samples, *fresh), taken=taken) if fresh else state

    def turned(self, state: LinkState, now: int, truth: Odometry) -> tuple[LinkState, Said]:
        """Reckon up to a look [ns]: what the machine's receiver gives out, and what has reached the Earth."""
        light = self.light_time(now)

        def over_machine(time: int) -> tuple[bool, int]:
            return self.window(time, truth)

        def from_earth(time: int) -> tuple[bool, int]:
            is_open, until = self.window(time + light, truth)
            return is_open, until - light

        up, news = self._up.advanced(state.up, now, light, from_earth)
        state, words, said = _after_uplink(replace(state, up=up), news, now)
        state, ends = _with_ends(state)
        down, earlier = self._down.advanced(state.down, now, light, over_machine)
        for word in (*words, *ends):
            down, _ = self._down.offered(down, Packet(word, WORD_BITS, 0, "acknowledgement", keep=1000))
        for sample in state.samples:
            how = self._telemetry[sample.topic]
            packet = Packet(sample, bits(sample.message), how.priority, sample.topic, how.keep)
            down, _ = self._down.offered(down, packet)
        down, later = self._down.advanced(down, now, light, over_machine)
        state = replace(state, down=down, samples=())
        return _after_downlink(state, [packet.content for _, packet in (*earlier.arrived, *later.arrived)], now, said)

    def sent(self, state: LinkState, now: int, said: Sequence[tuple[str, Message]] = ()) -> LinkState:
        """With what people have sent since the last look, and what the script says at this one [ns]."""
        for name, message in (*state.by_hand, *said):
            if name == CANCEL.name:
                state = self._cancelled(state, now, message.frame)
            else:
                state = self._queued(state, now, name.removeprefix(EARTH), message)
        return replace(state, by_hand=()) if state.by_hand else state

    def _queued(self, state: LinkState, now: int, name: str, message: Message) -> LinkState:
        if name in FIRST:
            state = self._overtaken(state, now, name)
        deadline = None if self._expires is None else now + self._expires
        message = message if message.stamp else stamped(message, now)
        keep, priority = (1 if name in VELOCITIES else KEPT), int(name not in FIRST)
        packet = Packet(TelemetrySample(name, message), bits(message), priority, name, keep, deadline)
        up, packet = self._up.offered(state.up, packet)
        gone = {one.number for one in state.up.waiting} - {one.number for one in up.waiting}
        dropped = _marked(state.log, gone, DROPPED, now, "too many of its topic were waiting")
        log = (*dropped, SentCommand(packet.number, name, message.stamp, now, known=now))
        return replace(state, up=up, log=_last(log))

    def _overtaken(self, state: LinkState, now: int, name: str) -> LinkState:
        """Without the goals of a role that wait while a stop or a velocity for it is sent: that goes before them, and
        would be undone by them.
        """
        for packet in state.up.waiting:
            goal = packet.content.topic
            if ROLE_OF[goal] == ROLE_OF[name] and goal in MOVES:
                state = self._without(state, now, packet.number, f"{name} was sent after it")
        return state

    def _cancelled(self, state: LinkState, now: int, number: str) -> LinkState:
        """Without what waits: the command of a number, or all where none is said."""
        for packet in state.up.waiting:
            if number in ("", str(packet.number)):
                state = self._without(state, now, packet.number, "before it was sent")
        return state

    def _without(self, state: LinkState, now: int, number: int, reason: str) -> LinkState:
        """A command that waits is taken back."""
        up, _ = self._up.cancelled(state.up, number)
        return replace(state, up=up, log=_marked(state.log, {number}, CANCELLED, now, reason))


def _last(log: Sequence[SentCommand]) -> tuple[SentCommand, ...]:
    """What is remembered of a log. Velocities count by themselves: many a second, they would push out all else."""
    velocities = [one for one in log if one.topic in VELOCITIES][-KEPT:]
    others = [one for one in log if one.topic not in VELOCITIES][-KEPT:]
    return tuple(sorted((*velocities, *others), key=lambda one: one.number))


def _marked(
    log: tuple[SentCommand, ...], numbers: Collection[int], word: str, now: int, reason: str
) -> tuple[SentCommand, ...]:
    """The log with a state of the commands of these numbers that the Earth knows by itself."""
    if not numbers:
        return log
    return tuple(one._replace(state=word, known=now, reason=reason) if one.number in numbers else one for one in log)


def _after_uplink(state: LinkState, news: News, now: int) -> tuple[LinkState, list[MachineWord], Said]:
    """What has happened on the way up: the machine's words on it, and what its receiver gives out."""
    log, words, said = list(state.log), list[MachineWord](), Said()
    places = {command.number: place for place, command in enumerate(log)}
    for time, packet in news.sent:
        if packet.number in places:
            place = places[packet.number]
            log[place] = log[place]._replace(state=SENT, sent=time, known=time)
    for time, packet, was_sent in news.expired:
        reason = f"not there by {seconds(packet.deadline or 0):.2f} s"
        if was_sent:
            words.append(MachineWord(packet.number, EXPIRED, time, reason=reason))
        else:
            log = list(_marked(tuple(log), {packet.number}, EXPIRED, now, reason))
    for time, packet in news.arrived:
        name, message = packet.content
        message = stamped(message, _own_stamp(log, ROLE_OF[name], max(message.stamp, now + LEAD_NS)))
        said.append((name, message))
        if packet.number in places:
            place = places[packet.number]
            log[place] = log[place]._replace(given=message.stamp)
        if name not in VELOCITIES:
            words.append(MachineWord(packet.number, RECEIVED, time, given=message.stamp))
    return replace(state, log=tuple(log)), words, said


def _own_stamp(log: Sequence[SentCommand], role: str, stamp: int) -> int:
    """The first from a stamp [ns] on that no other goal of the role has: by it the answers tell which they are of."""
    taken = {one.given for one in log if one.role == role}
    while stamp in taken:
        stamp += CONTROL_PERIOD_NS
    return stamp


def _with_ends(state: LinkState) -> tuple[LinkState, list[MachineWord]]:
    """The machine's last words on commands that it is through with."""
    log, words = list(state.log), list[MachineWord]()
    for place, command in enumerate(log):
        word = settled(command, state.statuses) if command.given and not command.settled else None
        if word is not None:
            log[place] = command._replace(settled=True)
            words.append(word)
    return (replace(state, log=tuple(log)), words) if words else (state, words)


def _after_downlink(state: LinkState, contents: Sequence[Any], now: int, said: Said) -> tuple[LinkState, Said]:
    """What has reached the Earth."""
    log, reports, place = list(state.log), dict(state.reports), state.place
    for content in contents:
        if isinstance(content, MachineWord):
            log = [after_word(one, content, now) if one.number == content.number else one for one in log]
            continue
        said.append((EARTH + content.topic, content.message))
        if content.topic in _ROLES:
            reports[_ROLES[content.topic]] = report_of(content.message)
        elif content.topic == PLACE:
            place = content.message
    return (replace(state, log=tuple(log), reports=reports, place=place) if contents else state), said
