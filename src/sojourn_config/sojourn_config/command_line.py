"""Options that the scripts share, with checks that answer in one sentence."""

import argparse
import math
import os
import re
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

from sojourn_config.collector import collect_seldom
from sojourn_config.command_errors import CommandError, UsageError
from sojourn_config.errors import ConfigError
from sojourn_config.paths import available
from sojourn_config.ros_environment import HIGHEST_DOMAIN, default_domain
from sojourn_config.shared_memory import remove_tracing_files
from sojourn_config.shown import shown

OUTPUT_CLOSED = 128 + signal.SIGPIPE
"""Exit status where nobody reads our output any more: what a shell reports of a program that this signal ends."""
ONLY_OWNER = 0o077
"""Mask of what a run or a report writes: it tells where a machine is and what it does, and is its owner's alone."""
_NEGATIVE = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")
"""A number below zero as float() reads it; argparse takes one with an exponent for an option."""
_NAMESPACE = re.compile(r"(/[A-Za-z][A-Za-z0-9_]*)+")


class Parser(argparse.ArgumentParser):
    """An argument parser whose errors are one sentence, and to which every number below zero is one."""

    def __init__(self, *args: Any, **settings: Any) -> None:
        super().__init__(*args, **settings)
        self._negative_number_matcher = _NEGATIVE

    def error(self, message: str) -> NoReturn:
        """Print the sentence and end with status 2."""
        self.exit(UsageError.exit_status, f"{self.prog}: {message} (see {self.prog} --help)\n")


def add_place(parser: argparse.ArgumentParser) -> None:
    """--domain and --namespace: where the nodes meet."""
    parser.add_argument(
        "--domain",
        type=domain,
        default=default_domain(),
        metavar="N",
        help="ROS domain, 0 to 232 (default: ROS_DOMAIN_ID, else 42)",
    )
    parser.add_argument(
        "--namespace", type=namespace, default="", metavar="NS", help="ROS namespace of every topic (default: none)"
    )


def add_machine(parser: argparse.ArgumentParser) -> None:
    """--machine: another than the scenario's."""
    known = ", ".join(available("machines"))
    help_text = f"machine in place of the scenario's: the path of its folder, or one of {known}"
    parser.add_argument("--machine", metavar="NAME", help=help_text)


def add_scenario(parser: argparse.ArgumentParser, default: str, what: str) -> None:
    """--scenario, --machine and --set: a scenario and what is changed of it, see `changes_of`.

    Args:
        what: of it is looked at, in words.
    """
    parser.add_argument("--scenario", default=default, help=f"{what} (default: %(default)s)")
    add_machine(parser)
    add_changes(parser)


def add_changes(parser: argparse.ArgumentParser, what: str = "change a value of a file") -> None:
    """--set, as often as wanted; a list of texts KEY=VALUE in the attribute `set`.

    Args:
        what: it does, in words.
    """
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help=f"{what}; again for more")


def changes_of(given: argparse.Namespace) -> list[str]:
    """The options of `add_scenario` but for its name, as overrides of a scenario."""
    return [*given.set, *([] if given.machine is None else [f"machine={given.machine}"])]


def add_result(parser: argparse.ArgumentParser, names: str) -> None:
    """--json and --bag: where the result of a comparison goes.

    Args:
        names: how the second side's topics are called in the bag, in words.
    """
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the result into this file, too")
    parser.add_argument("--bag", type=Path, dest="both", metavar="OUT", help=f"write a bag with both, {names}")


def domain(text: str) -> int:
    """A ROS domain."""
    if not text.isdigit() or int(text) > HIGHEST_DOMAIN:
        raise argparse.ArgumentTypeError(f"domain {text!r}: allowed is a whole number from 0 to {HIGHEST_DOMAIN}")
    return int(text)


def namespace(text: str) -> str:
    """A ROS namespace, with its leading slash; empty for none."""
    name = "/" + text.strip("/") if text.strip("/") else ""
    if name and not _NAMESPACE.fullmatch(name):
        raise argparse.ArgumentTypeError(f"namespace {text!r}: allowed are letters, digits and _, a letter first")
    return name


def positive(text: str) -> float:
    """A finite number above zero."""
    value = number(text)
    if value <= 0.0:
        raise argparse.ArgumentTypeError(f"{text}: allowed is a number above 0")
    return value


def number(text: str) -> float:
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is no number")
    return value


def number_list(text: str) -> list[float]:
    """Finite numbers with commas between them."""
    return [number(part) for part in text.split(",")]


def whole_number(text: str) -> int:
    """A whole number of at least zero."""
    if not text.isdigit():
        raise argparse.ArgumentTypeError(f"{text!r}: allowed is a whole number of at least 0")
    return int(text)


def count(text: str) -> int:
    """A whole number of at least one."""
    if not text.isdigit() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"{text!r}: allowed is a whole number of at least 1")
    return int(text)


def say(text: str) -> None:
    """Lines for whoever looks, shown at once: what a long command is at, and what others say; see `shown`."""
    print(shown(text), flush=True)


@contextmanager
def only_owner() -> Iterator[None]:
    """What is written meanwhile is its owner's alone, see ONLY_OWNER; also as a decorator."""
    before = os.umask(ONLY_OWNER)
    try:
        yield
    finally:
        os.umask(before)


def run_script(main: Callable[[Sequence[str] | None], int], arguments: Sequence[str] | None = None) -> NoReturn:
    """Main of a script: its errors as one sentence on the standard error, its status as ours."""
    collect_seldom()
    try:
        status = main(arguments)
        sys.stdout.flush()
        sys.exit(status)
    except BrokenPipeError:  # whoever read our output, such as head, has had enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or the interpreter stumbles over it at its end
        sys.exit(OUTPUT_CLOSED)
    except CommandError as error:
        print(error, file=sys.stderr)
        sys.exit(error.exit_status)
    except ConfigError as error:
        print(error, file=sys.stderr)
        sys.exit(UsageError.exit_status)
    except KeyboardInterrupt:
        sys.exit(130)
    finally:
        remove_tracing_files()
