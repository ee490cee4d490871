"""The link to Earth and the commands on it, in the words of the page."""

from collections.abc import Mapping

from sojourn_console.link_ahead import LinkAhead
from sojourn_console.uplink import LinkMoment, Uplink
from sojourn_contract.link_topics import EARTH
from sojourn_contract.stamps import seconds
from sojourn_operator.link.commands import OVER, QUEUED, RECEIVED, SENT
from sojourn_physics.link.params import LinkChannelParams

SHOWN = 8
"""Last commands that are told."""
ROLES = ("drive", "arm", "power")
LATE_S = 5.0
"""So much later than it could have come the word of a command is missed [s]."""


def link_rows(uplink: Uplink, now: int, ahead: LinkAhead) -> list[tuple[str, str]]:
    """Names and values. uplink: has heard the link. now: simulation time [ns]."""
    light, link = ahead.light_time_s(now), uplink.state
    rows = [
        ("link", _window(ahead, now)),
        ("light takes", f"{light:.2f} s, there and back {2.0 * light:.2f} s"),
        ("carries", f"{channel_words('up', ahead.link.up)}; {channel_words('down', ahead.link.down)}"),
    ]
    if not link:
        return [*rows, ("", "the operator's role has not told of it yet")]
    commands, moment = list(uplink.commands()), uplink.moment()
    flying = sum(_left_s(values, now, moment) > 0.0 for _, values in commands if values.get("state") == SENT)
    for way, words, more in (("up", "to the machine", flying), ("down", "to the Earth", 0)):
        count, bits = int(link[f"{way}_waiting"]), float(link[f"{way}_waiting_bits"])
        waits = f"{count} waiting, {bits / 8e3:.2f} kB" if count else "nothing waits"
        rows.append((words, f"{waits}; {more} on its way" if more else waits))
    rows += _received_rows(uplink, now)
    for number, values in commands[::-1][:SHOWN]:
        rows.append((f"command {number}", f"{uplink.name_of(values)}: {command_words(values, now, moment)}"))
    return rows if commands else [*rows, ("commands", "none yet")]


def _received_rows(uplink: Uplink, now: int) -> list[tuple[str, str]]:
    """What the Earth has heard of the machine last."""
    newest = uplink.newest()
    if newest is None:
        return [("heard on Earth", "nothing yet")]
    name, told = newest.row.name.removeprefix(EARTH), f"{_age(newest.time, now)} old"
    rows = [("heard on Earth", f"{name}, {told}")]
    for role in ROLES:
        values, stamp = uplink.received(f"/{role}/status") or ({}, 0)
        if values:
            words = ": ".join(word for word in (values.get("state", ""), values.get("reason", "")) if word)
            rows.append((f"{role}, as heard", f"{words}; {_age(stamp, now)} old"))
    return rows


def channel_words(name: str, channel: LinkChannelParams) -> str:
    """What one direction carries, and how much of it is lost."""
    rate = "without limit" if channel.bit_s is None else f"{channel.bit_s / 1e3:g} kbit/s"
    return f"{name} {rate}" + (f", {100.0 * channel.loss:.3g} % lost" if channel.loss else "")


def command_words(values: Mapping[str, str], now: int, link: LinkMoment) -> str:
    """Where a command is, as far as the Earth knows. values: of it in /link/status. now: simulation time [ns]."""
    state = values.get("state", "?")
    if state in OVER:
        told = ": ".join(word for word in (values.get("outcome", ""), values.get("reason", "")) if word)
        return state + (f" ({told})" if told else "")
    if state == SENT and values.get("sent_s"):
        return _sent_words(_left_s(values, now, link), link)
    if state == QUEUED and values.get("queued_s"):
        since = float(values["queued_s"])
        ends = "" if link.expires_s is None else f", expires in {span(since + link.expires_s - seconds(now))}"
        return f"waits on Earth since {since:.1f} s{ends}"
    if state == RECEIVED and values.get("received_s"):
        return f"received at {float(values['received_s']):.1f} s; of its end nothing is known yet"
    return state


def _sent_words(left: float, link: LinkMoment) -> str:
    """Of a command that has left the Earth. left: until it is there [s]."""
    if left > 0.0:
        return f"on its way, there in {span(left)}"
    answer = left + link.light_s
    if answer > 0.0:
        return f"should be there, word of it in {span(answer)} at the soonest"
    if not link.is_open:
        return "should be there, word of it waits for the window"
    if answer > -LATE_S:
        return "should be there, word of it is due"
    return f"no word of it, due for {span(-answer)}: it may be lost, or its word"


def _left_s(values: Mapping[str, str], now: int, link: LinkMoment) -> float:
    """Until a command that has been sent is there [s]; below zero where it should be."""
    return float(values.get("sent_s") or "nan") + link.light_s - seconds(now)


def _window(ahead: LinkAhead, now: int) -> str:
    """Whether it is open, and when that changes."""
    words = "open" if ahead.is_open else "closed"
    change = ahead.changes_at
    if change is None:
        return f"{words} for good" if ahead.is_over else f"{words} for {span(seconds(ahead.lasts(now)))} at least"
    verb, date = ("closes" if ahead.is_open else "opens"), ahead.date(change)
    return f"{words}, {verb} in {span(seconds(change - now))}, at {seconds(change):.0f} s{date and ', '}{date}"


def _age(stamp: int, now: int) -> str:
    """Of a message with a stamp, none of the future. stamp, now: [ns]."""
    return span(max(seconds(now - stamp), 0.0))


def span(time: float) -> str:
    """A length of time [s] in words, none below zero."""
    if time < 100.0:
        return f"{max(time, 0.0):.1f} s"
    minutes, rest = divmod(round(time), 60)
    hours, minutes = divmod(minutes, 60)
    days, hours = divmod(hours, 24)
    if days:
        return f"{days} d {hours} h"
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s"
