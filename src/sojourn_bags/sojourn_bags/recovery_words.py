"""A bag mended, and what is lost of it in words: the work of scripts/recover."""

import argparse
from datetime import UTC, datetime

from rich.console import Console
from rich.table import Table

from sojourn_bags.completeness import HEARTBEATS
from sojourn_bags.errors import BagsError, NothingToRecoverError, UnreadableBagError
from sojourn_bags.recovery import Findings, examine, recover, recovered_folder
from sojourn_config.command_errors import CommandError, UsageError
from sojourn_config.command_line import only_owner

NANOSECONDS = 1_000_000_000
A_DAY = 86400 * NANOSECONDS


def report(found: Findings, console: Console) -> None:
    """What is there, what is lost, and what nobody can know."""
    names = sorted(found.counts | found.lost)
    counted = bool(found.published)
    table = Table(box=None, pad_edge=False)
    table.add_column("topic")
    table.add_column("recovered", justify="right")
    table.add_column("up to", justify="right")
    if counted:
        table.add_column("published by the last heartbeat", justify="right")
        table.add_column("certainly lost", justify="right")
    for name in names:
        row = [name, str(found.counts.get(name, 0)), _moment(found.last.get(name))]
        if counted:
            lost = found.lost.get(name, 0)
            row += [str(found.published.get(name, "not counted")), str(lost) if lost else ""]
        table.add_row(*row)
    console.print(table)
    console.print(_words(found))


def _words(found: Findings) -> str:
    lost = sum(found.lost.values())
    until = _moment(max(found.last.values()))
    parts = [f"{found.total} messages recovered, up to {until}."]
    if found.all_messages:
        return f"{parts[0]} No message is lost: the damage lies behind the last one."
    if found.heartbeat is None:
        source = "heartbeats that count" if HEARTBEATS in found.counts else f"{HEARTBEATS}"
        parts.append(f"How many are lost cannot be known: the bag has no {source}.")
        return " ".join(parts)
    if lost:
        parts.append(f"{lost} messages are certainly lost: sent before the last heartbeat, and not in the bag.")
    else:
        parts.append("Nothing that was sent before the last heartbeats is missing.")
    parts.append(
        f"What was sent after the last heartbeat, at {_moment(found.heartbeat)}, and is not in the bag cannot be "
        "known; nor can the end of the run, or why it ended."
    )
    return " ".join(parts)


def _moment(time_ns: int | None) -> str:
    """A time in simulation, or a stretch of wall clock where it is one."""
    if time_ns is None:
        return ""
    if time_ns < 3650 * A_DAY:
        return f"{time_ns / NANOSECONDS:.2f} s"
    return datetime.fromtimestamp(time_ns / NANOSECONDS, tz=UTC).strftime("%Y-%m-%d %H:%M:%S.%f")[:-3] + " UTC"


@only_owner()
def run(given: argparse.Namespace) -> int:
    """Mend a bag; 0 if there is a whole one in the end."""
    console = Console(highlight=False, soft_wrap=True)
    try:
        found = examine(given.bag)
        if found.whole:
            console.print(f"{found.path} is whole, {found.total} messages: there is nothing to mend.", markup=False)
            return 0
        console.print(f"{found.path} is damaged from byte {found.at} of {found.size} on: {found.damage}.", markup=False)
        file = recover(found, (given.out or recovered_folder(found.path)).absolute())
    except UnreadableBagError as error:
        raise UsageError(str(error)) from error
    except NothingToRecoverError as error:
        raise CommandError(str(error)) from error
    except BagsError as error:
        raise UsageError(str(error)) from error
    report(found, console)
    console.print(f"The new bag is {file.parent}; the old one is as it was.", markup=False)
    return 0
