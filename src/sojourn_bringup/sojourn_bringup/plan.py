"""What a run consists of, decided and checked before anything starts."""

import argparse
import json
import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from sojourn_bringup.access import enclave_of
from sojourn_bringup.process_table import PROCESSES
from sojourn_config import command_line
from sojourn_config.command_errors import UsageError
from sojourn_contract.barrier import Barrier, awaited_inputs
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topics import ROLES, STANDARD

if TYPE_CHECKING:  # the options need none of its libraries
    from sojourn_config.scenario import LoadedScenario
    from sojourn_stack.stack import StackState

DEFAULT_LOCKSTEP_TIMEOUT_S = 10.0
DEFAULT_START_TIMEOUT_S = 60.0
OF_RESTARTS = ("kept", "restarts")
"""ROS parameters of a node that is started again: where it finds what it was to keep, and how often it was."""


@dataclass(frozen=True)
class RunPlan:
    """One run.

    Args:
        scenario: name or file that every node loads. overrides: KEY=VALUE texts that go over it.
        run_dir: folder of the run; it exists.
        participants: roles that take part, wherever they are started.
        started: those of them that this program starts.
        replacements: command that takes the place of a role's process.
        shadows: command that runs beside a role's node and is compared with it.
        realtime: paced by the wall clock; else lock-step.
        domain, namespace: where the nodes meet; the namespace starts with a slash, or is empty.
        on_network: find nodes on other machines too.
        lockstep_timeout_s: wall time after which a missing answer stops a lock-step run [s].
        start_timeout_s: wall time within which every node must be ready [s].
        loaded: the scenario as it was checked, for a run in this process; None: it is to be read.
        begin: where it goes on from; None for its start.
        checkpoint_every_s: simulation time from one checkpoint to the next [s]; None for none.
        secure: each process in its enclave, see `access`.
    """

    scenario: str
    run_dir: Path
    participants: tuple[str, ...]
    started: tuple[str, ...]
    overrides: tuple[str, ...] = ()
    replacements: Mapping[str, str] = field(default_factory=dict)
    shadows: Mapping[str, str] = field(default_factory=dict)
    realtime: bool = False
    domain: int = 42
    namespace: str = ""
    on_network: bool = False
    lockstep_timeout_s: float = DEFAULT_LOCKSTEP_TIMEOUT_S
    start_timeout_s: float = DEFAULT_START_TIMEOUT_S
    loaded: "LoadedScenario | None" = field(default=None, compare=False, repr=False)
    begin: "StackState | None" = field(default=None, compare=False, repr=False)
    checkpoint_every_s: float | None = None
    secure: bool = False

    @property
    def result_file(self) -> Path:
        """Where the operator writes what became of each step, when it is a process."""
        return self.run_dir / "goals.json"

    @property
    def beginning_file(self) -> Path:
        """Where the recorder of a run that goes on finds what it begins with, when it is a process."""
        return self.run_dir / "beginning"

    def shadow_file(self, role: str) -> Path:
        """Where the shadow of a role writes what it finds."""
        return self.run_dir / f"shadow_{role}.json"

    def in_order_of_stop(self) -> tuple[str, ...]:
        """Roles started here, the plant first and the recorder last."""
        return tuple(row.role for row in PROCESSES if row.role in self.started)

    def bag(self, attempt: int = 0) -> Path:
        """Folder of the bag; a recorder that was started again writes beside what the first has left."""
        return self.run_dir / ("bag" if attempt == 0 else f"bag_{attempt + 1}")

    @property
    def companions(self) -> tuple[str, ...]:
        """Roles whose nodes are our own and start here: as processes in lock-step they hear each other in bundles."""
        if self.realtime:
            return ()
        return tuple(role for role in self.participants if role in self.started and role not in self.replacements)

    def parameters(self, role: str, attempt: int = 0) -> dict[str, object]:
        """ROS parameters of a role's node.

        Args:
            role: row of the process table. attempt: how often it has been started again.
        """
        values: dict[str, object] = {
            "scenario": self.scenario,
            "lockstep": not self.realtime,
            "participants": list(self.participants),
            "lockstep_timeout_s": float(self.lockstep_timeout_s),
        }
        if self.realtime and role not in self.replacements:  # in lock-step nothing is started again
            values |= dict(zip(OF_RESTARTS, (str(self.run_dir / "kept" / f"{role}.json"), attempt), strict=True))
        if self.overrides:
            values["overrides"] = list(self.overrides)
        if role == "recorder":
            values["bag"] = str(self.bag(attempt))
        return values

    def candidate_parameters(self, role: str) -> dict[str, object]:
        """ROS parameters of a node that is compared with that of a role: what is kept is the other's."""
        return {name: value for name, value in self.parameters(role).items() if name not in OF_RESTARTS}

    def ros_arguments(self, role: str, attempt: int = 0) -> list[str]:
        """Command line arguments that give a process its parameters and its namespace."""
        values = self.parameters(role, attempt)
        if role in self.companions:
            values["companions"] = list(self.companions)
        if self.begin is not None:
            resumed = {"beginning": str(self.beginning_file)} if role == "recorder" else {"resumed_at": self.begin.now}
            values |= resumed
        if self.checkpoint_every_s is not None and role != "recorder":
            values["checkpoint_every_s"] = float(self.checkpoint_every_s)
        if role == "operator":
            values["result_file"] = str(self.result_file)
        return [*ros_arguments(values, self.namespace), *self.enclave_arguments(role)]

    def enclave_arguments(self, node: str) -> list[str]:
        """Arguments, behind --ros-args, by which a node finds its keys; none where the run needs none."""
        return ["--enclave", enclave_of(node)] if self.secure else []


def ros_arguments(
    parameters: Mapping[str, object], namespace: str, renamed: Mapping[str, str] | None = None
) -> list[str]:
    """Parameters, namespace and topics of other names as command line arguments.

    ROS reads a value as YAML, and JSON is YAML: so the name "2024" stays text and 10.0 stays a float.
    """
    arguments = ["--ros-args"]
    for name, value in parameters.items():
        arguments += ["-p", f"{name}:={json.dumps(value)}"]
    if namespace:
        arguments += ["-r", f"__ns:={namespace}"]
    for name, other in (renamed or {}).items():
        arguments += ["-r", f"{name}:={other}"]
    return arguments


def replacement_of(text: str, option: str = "--replace") -> tuple[str, str]:
    """`drive=ros2 run my_rover drive`, given to an option, as (role, command). Raises UsageError."""
    role, _, command = text.partition("=")
    try:
        words = shlex.split(command)
    except ValueError as error:
        raise UsageError(f"{option} {text}: the command cannot be read: {error}") from error
    if not words:
        raise UsageError(f"{option} {text}: allowed is NAME=COMMAND")
    return role, command


def check_lockstep(participants: Iterable[str], table: TopicTable = STANDARD) -> None:
    """Raise UsageError if the run would stand still because a role lacks what it acts upon.

    A role acts when its inputs are in; where their publisher does not take part it acts less often than others wait
    for it, or never.
    """
    present = tuple(participants)
    for role in present:
        if role == "plant":
            continue
        inputs = awaited_inputs(role, present, table)
        stride = Barrier(inputs).stride
        for row in table.outputs_of(role, present):
            waiting = [other for other in present if row in _waited_for(other, present, table)]
            if waiting and (not inputs or row.every % stride):
                raise UsageError(
                    f"in lock-step {role} cannot run without {_lacking(role, present, table)}: "
                    f"{waiting[0]} would wait for {row.name} for ever (leave out {role} too, or use --realtime)"
                )


def _waited_for(role: str, present: tuple[str, ...], table: TopicTable) -> list[object]:
    names = {row.name for row in awaited_inputs(role, present, table)}
    return [row for row in table if row.name in names and row.publisher in present and row.is_in(present)]


def _lacking(role: str, present: tuple[str, ...], table: TopicTable) -> str:
    """Roles left out on which this one depends, in words."""
    lacking = [
        other
        for other in ROLES
        if other not in present and any(row.publisher == other for row in awaited_inputs(role, ROLES, table))
    ]
    return " and ".join(lacking) or "the others"


def add_console(parser: argparse.ArgumentParser) -> None:
    """--console: a page beside the run."""
    help_text = "show the run in the browser and command it from there: prints the address of a page on this machine"
    parser.add_argument("--console", action="store_true", help=help_text)


def add_patience(parser: argparse.ArgumentParser) -> None:
    """--lockstep-timeout and --start-timeout: how long a run waits for its nodes."""
    parser.add_argument(
        "--lockstep-timeout",
        type=command_line.positive,
        default=DEFAULT_LOCKSTEP_TIMEOUT_S,
        metavar="S",
        help="wall time after which a node that does not answer stops the run (default: %(default)g s)",
    )
    parser.add_argument(
        "--start-timeout",
        type=command_line.positive,
        default=DEFAULT_START_TIMEOUT_S,
        metavar="S",
        help="wall time within which every node must be ready (default: %(default)g s)",
    )
