"""A candidate alone on its bench, to which a bag is played: for scripts/replay and scripts/contract check --exec."""

import argparse
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sojourn_bags.errors import BagsError, UnansweredError
from sojourn_bags.reading import Bag
from sojourn_bags.replay_choices import ROLES_TO_REPLAY
from sojourn_bags.replay_harness import ReplaySettings
from sojourn_bags.run_configuration import RunConfiguration, run_configuration
from sojourn_bringup.candidate_process import ProcessCandidate
from sojourn_bringup.instance import RoleTokens
from sojourn_config.command_errors import CommandError, UsageError
from sojourn_config.interruption import ended_by_signals
from sojourn_config.ros_environment import ros_variables


def replay_settings(given: argparse.Namespace) -> ReplaySettings:
    """What the options of `add_bench` and `command_line.add_place` ask for."""
    return ReplaySettings(given.domain, given.namespace, given.timeout, given.start_timeout)


@contextmanager
def bench(
    given: argparse.Namespace, role: str, command: str, bag: Bag
) -> Iterator[tuple[ProcessCandidate, RunConfiguration]]:
    """A candidate, not started yet, and the configuration of the bag's run; no process and no file stays behind.

    Args:
        given: with the options of `add_bench` and `command_line.add_place`. command: "" for our own node.

    Raises:
        UsageError: the bag cannot be played. CommandError: the candidate does not answer.
    """
    ros = ros_variables(given.domain)  # before the run's configuration takes the place of ours
    os.environ.update(ros)
    try:
        with (
            tempfile.TemporaryDirectory(prefix="sojourn-replay-") as folder,
            run_configuration(bag) as configuration,
            RoleTokens(given.domain, given.namespace, ROLES_TO_REPLAY),
            ended_by_signals(),
        ):
            for warning in configuration.warnings():
                print(f"note: {warning}")
            log = given.log or Path(folder) / f"{role}.log"
            yield ProcessCandidate(role, command, ros, given.namespace, log), configuration
    except UnansweredError as error:
        raise CommandError(str(error)) from error
    except BagsError as error:
        raise UsageError(str(error)) from error
