"""/link/status: what the Earth knows of the link and of its last commands."""

from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.values import DiagnosticArray, DiagnosticStatus, Odometry
from sojourn_operator.link.commands import OVER, VELOCITIES
from sojourn_operator.link.earth_link import EarthLink, LinkState
from sojourn_physics.link.channel import ChannelState

SHOWN = 16
"""Last commands that it tells of, beside all that are not over."""


def link_status(link: EarthLink, state: LinkState, stamp: int, truth: Odometry) -> DiagnosticArray:
    """The message of a stamp [ns]."""
    is_open, _ = link.window(stamp, truth)
    values = {
        "window": "open" if is_open else "closed",
        "light_time_s": f"{link.light_time(stamp) / NANOSECONDS:.3f}",
        "up_waiting": str(len(state.up.waiting) + (state.up.sending is not None)),
        "up_waiting_bits": f"{state.up.bits_waiting:.0f}",
        "down_waiting": str(len(state.down.waiting) + (state.down.sending is not None)),
        "down_waiting_bits": f"{state.down.bits_waiting:.0f}",
    }
    commands = [command for command in state.log if command.topic not in VELOCITIES]
    shown = [*(command for command in commands[:-SHOWN] if command.state not in OVER), *commands[-SHOWN:]]
    told = (DiagnosticStatus(f"command {one.number}", tuple(one.values().items()), one.state) for one in shown)
    return DiagnosticArray(stamp, (DiagnosticStatus("link", tuple(values.items()), values["window"]), *told))


def tally_values(state: LinkState) -> dict[str, str]:
    """What has become of all messages so far, in truth, for the heartbeat."""
    return {"uplink": _tally(state.up), "downlink": _tally(state.down)}


def _tally(channel: ChannelState) -> str:
    tally = channel.tally
    way = len(channel.flying)
    waiting = len(channel.waiting) + (channel.sending is not None)
    return (
        f"{tally.offered} offered, {tally.arrived} arrived, {tally.lost} lost, {tally.expired} expired, "
        f"{tally.dropped} dropped, {tally.cancelled} cancelled, {way} on the way, {waiting} waiting, "
        f"{channel.bits_sent:.0f} bits sent"
    )
