"""Options of what plays a bag to a candidate: scripts/replay and scripts/contract check --exec."""

import argparse
from pathlib import Path

from sojourn_bags.replay_choices import DEFAULT_TIMEOUT_S, ROLES_TO_REPLAY
from sojourn_bringup.plan import replacement_of
from sojourn_config import command_line
from sojourn_config.command_errors import UsageError


def add_bench(parser: argparse.ArgumentParser) -> None:
    """--log, --timeout and --start-timeout: how a candidate is treated."""
    parser.add_argument("--log", type=Path, metavar="FILE", help="what the program prints (default: not kept)")
    parser.add_argument(
        "--timeout", type=command_line.positive, default=DEFAULT_TIMEOUT_S, metavar="S",
        help="wall time after which a missing answer is an error (default: %(default)g s)",
    )  # fmt: skip
    parser.add_argument(
        "--start-timeout", type=command_line.positive, default=60.0, metavar="S",
        help="wall time within which it must be ready (default: %(default)g s)",
    )  # fmt: skip


def check_role(role: str, option: str) -> str:
    """The role, if a bag can be played to it. Raises UsageError."""
    if role not in ROLES_TO_REPLAY:
        raise UsageError(f"{option}: role {role!r} is unknown, allowed is one of {', '.join(ROLES_TO_REPLAY)}")
    return role


def candidate_of(command: str, role: str) -> tuple[str, str]:
    """Role and command of a program. Raises UsageError if one of them cannot be."""
    return replacement_of(f"{check_role(role, '--role')}={command}", "--exec")
