"""One direction of a link: what waits to be sent, what is on its way, what arrives, and what does not.

A packet is sent when its turn comes, bit by bit at the channel's rate while a window is open; where the window closes
it goes on in the next one. Those of the lowest number of priority go first, equals in turn: what is new goes behind
them, and what is dropped for newer ones of its name leaves its turn to the next of that name, so that a name that comes
often does not wait for ever. One that has begun is not interrupted. It arrives one light time after its last bit has
left, unless it is lost, which chance decides for each packet by itself, or comes too late. So that

    offered = arrived + lost + expired + dropped + cancelled + on its way + waiting

at all times, and no more bits leave than rate x open time. A state and a step: the step goes from one change of the
window to the next and from packet to packet, and so costs nothing where nothing is sent, however long it is.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeAlias

from sojourn_machine.chance import chance
from sojourn_machine.evolution import replace
from sojourn_machine.timing import NANOSECONDS

OpenAt: TypeAlias = Callable[[int], tuple[bool, int]]
"""Of a time [ns]: whether something can be sent then, and until when that stays as it is at least, later than it."""
_LOSS = 0
"""Salt of the chance that decides on losses."""


class Packet(NamedTuple):
    """What is sent.

    Args:
        content: whatever it is. bits: its length. priority: 0 goes first.
        name: of what it is one of, and `keep`: how many of that name may wait; older ones are dropped.
        deadline: time by which it has to arrive [ns]; None: it does not matter.
        number: of the channel's packets, given by it.
    """

    content: Any
    bits: int
    priority: int = 0
    name: str = ""
    keep: int = 1
    deadline: int | None = None
    number: int = 0


class InFlight(NamedTuple):
    """A packet on its way."""

    arrival: int
    """[ns]"""
    packet: Packet


@dataclass(frozen=True, slots=True)
class PacketTally:
    """Packets since the start."""

    offered: int = 0
    arrived: int = 0
    lost: int = 0
    expired: int = 0
    dropped: int = 0
    cancelled: int = 0


@dataclass(frozen=True, slots=True)
class ChannelState:
    """Of one direction."""

    until: int = 0
    """Time up to which it has been reckoned [ns]."""
    waiting: tuple[Packet, ...] = ()
    """In the order in which they are sent."""
    sending: Packet | None = None
    left: float = 0.0
    """Bits of it that have not been sent yet."""
    flying: tuple[InFlight, ...] = ()
    """In the order in which they arrive."""
    tally: PacketTally = field(default_factory=PacketTally)
    bits_sent: float = 0.0

    @property
    def is_idle(self) -> bool:
        """Whether nothing waits and nothing is on its way."""
        return not (self.waiting or self.flying or self.sending)

    @property
    def bits_waiting(self) -> float:
        """Bits that have not been sent yet."""
        return self.left + sum(packet.bits for packet in self.waiting)


class News(NamedTuple):
    """What has happened in a step, each with its time [ns]."""

    sent: Sequence[tuple[int, Packet]] = ()
    arrived: Sequence[tuple[int, Packet]] = ()
    expired: Sequence[tuple[int, Packet, bool]] = ()
    """The last says whether it had been sent: then the other end knows of it, else this one."""


@dataclass(frozen=True)
class Channel:
    """One direction.

    Args:
        rate: [bit/s]; infinity: whatever waits leaves at once. loss: probability for each packet.
        stream: of its random numbers.
    """

    rate: float = math.inf
    loss: float = 0.0
    stream: int = 0

    def offered(self, state: ChannelState, packet: Packet) -> tuple[ChannelState, Packet]:
        """With one more that waits, and that packet with its number."""
        number = state.tally.offered + 1
        packet = packet._replace(number=number)
        waiting = [*state.waiting, packet]
        alike = [one for one in waiting if one.name == packet.name]
        dropped = max(0, len(alike) - packet.keep)
        moved = {one.number for one in alike[1 : dropped + 1]}  # dropped, but for the last, which has the first's place
        waiting = [alike[dropped] if one is alike[0] else one for one in waiting if one.number not in moved]
        waiting.sort(key=lambda one: one.priority)
        tally = replace(state.tally, offered=number, dropped=state.tally.dropped + dropped)
        return replace(state, waiting=tuple(waiting), tally=tally), packet

    def cancelled(self, state: ChannelState, number: int) -> tuple[ChannelState, bool]:
        """Without a packet that still waits, and whether there was one: what is being sent cannot be called back."""
        waiting = tuple(one for one in state.waiting if one.number != number)
        if len(waiting) == len(state.waiting):
            return state, False
        return replace(state, waiting=waiting, tally=replace(state.tally, cancelled=state.tally.cancelled + 1)), True

    def advanced(self, state: ChannelState, now: int, light_time: int, open_at: OpenAt) -> tuple[ChannelState, News]:
        """Reckon up to a time.

        Args:
            now: not before the state's [ns]. light_time: [ns]. open_at: when something can be sent.
        """
        step = _Step(self, state, light_time)
        time = state.until
        while step.has_work():
            is_open, until = open_at(time)
            end = min(until, now)
            if is_open:
                step.send(time, end)
            time = end
            if time >= now:
                break
        step.drop_late(now)
        return step.arrivals(now)

    def is_lost(self, number: int) -> bool:
        """Whether the packet of a number does not arrive."""
        return chance(self.stream, _LOSS, number) < self.loss


class _Step:
    """A step while it is reckoned."""

    def __init__(self, channel: Channel, state: ChannelState, light_time: int) -> None:
        self._channel, self._state, self._light_time = channel, state, light_time
        self._waiting, self._flying = list(state.waiting), list(state.flying)
        self._sending, self._left = state.sending, state.left
        self._bits = state.bits_sent
        self._lost = 0
        self._sent: list[tuple[int, Packet]] = []
        self._expired: list[tuple[int, Packet, bool]] = []

    def has_work(self) -> bool:
        """Whether something is there to be sent."""
        return self._sending is not None or bool(self._waiting)

    def send(self, begin: int, end: int) -> None:
        """Send from one time to another [ns]; of no length, what takes no time."""
        rate, time = self._channel.rate, begin
        while self.has_work():
            if self._sending is None and not self._take(time, end):
                return
            packet = self._sending
            if packet is None:
                continue
            needed = 0 if math.isinf(rate) else math.ceil(self._left / rate * NANOSECONDS)
            if time + needed > end:
                sent = min(self._left, rate * (end - time) / NANOSECONDS)
                self._left -= sent
                self._bits += sent
                return
            time += needed
            self._bits += self._left
            self._sending, self._left = None, 0.0
            self._sent.append((time, packet))
            if self._channel.is_lost(packet.number):
                self._lost += 1
            else:
                self._flying.append(InFlight(time + self._light_time, packet))

    def _take(self, time: int, end: int) -> bool:
        """Begin with the next; False where there is no time for any."""
        if time >= end and not math.isinf(self._channel.rate):
            return False
        packet = self._waiting.pop(0)
        if self._is_late(packet, time):
            self._expired.append((time, packet, False))
        else:
            self._sending, self._left = packet, float(packet.bits)
        return True

    def drop_late(self, now: int) -> None:
        """Do not keep what would come too late whenever it is sent."""
        late = {packet.number for packet in self._waiting if self._is_late(packet, now)}
        self._expired += [(now, packet, False) for packet in self._waiting if packet.number in late]
        self._waiting = [packet for packet in self._waiting if packet.number not in late]

    def _is_late(self, packet: Packet, time: int) -> bool:
        return packet.deadline is not None and time + self._light_time > packet.deadline

    def arrivals(self, now: int) -> tuple[ChannelState, News]:
        """What has arrived by a time [ns], and the state then."""
        flying = sorted(self._flying, key=lambda flight: flight.arrival)
        there = [flight for flight in flying if flight.arrival <= now]
        arrived = []
        for arrival, packet in there:
            if packet.deadline is not None and arrival > packet.deadline:
                self._expired.append((arrival, packet, True))
            else:
                arrived.append((arrival, packet))
        old = self._state.tally
        tally = replace(
            old,
            arrived=old.arrived + len(arrived),
            lost=old.lost + self._lost,
            expired=old.expired + len(self._expired),
        )
        state = ChannelState(
            max(now, self._state.until),
            tuple(self._waiting),
            self._sending,
            self._left,
            tuple(flying[len(there) :]),
            tally,
            self._bits,
        )
        return state, News(self._sent, arrived, self._expired)
