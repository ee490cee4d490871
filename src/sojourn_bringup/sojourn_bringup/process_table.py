"""The process table: every role of a run, the module that runs it, and what may be done with it.

Rows stand in the order in which a run is stopped: the plant first, so that simulation time stands still while the
others say farewell, and the recorder last, so that it hears them all.
"""

import argparse
import importlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from sojourn_config.command_errors import UsageError


@dataclass(frozen=True)
class ProcessRow:
    """One role.

    Args:
        role: name in the contract; also the node's name.
        module: run as `python -m MODULE` when it is a process of its own.
        node_class: "module:Class" of its node, for a composed run.
        restartable: whether a process that died is started again in real time. Not the plant: with it the simulated
            world is gone.
        can_be_shadowed: whether a candidate can run beside it: what a run has one of cannot.
    """

    role: str
    module: str
    node_class: str
    restartable: bool = True
    can_be_shadowed: bool = True

    def load_class(self) -> Any:
        """The class of the node. Raises ImportError if its package is not installed."""
        module, _, name = self.node_class.partition(":")
        return getattr(importlib.import_module(module), name)


PROCESSES: tuple[ProcessRow, ...] = (
    ProcessRow("plant", "sojourn_plant", "sojourn_plant.node:PlantNode", restartable=False, can_be_shadowed=False),
    ProcessRow("operator", "sojourn_operator.node", "sojourn_operator.node:OperatorNode", can_be_shadowed=False),
    ProcessRow("sensors", "sojourn_sensors", "sojourn_sensors.node:SensorsNode"),
    ProcessRow("drive", "sojourn_drive", "sojourn_drive.node:DriveNode"),
    ProcessRow("arm", "sojourn_arm", "sojourn_arm.node:ArmNode"),
    ProcessRow("power", "sojourn_power", "sojourn_power.node:PowerNode"),
    ProcessRow("recorder", "sojourn_bags", "sojourn_bags.recorder_node:RecorderNode", can_be_shadowed=False),
)

ROLE_NAMES: tuple[str, ...] = tuple(row.role for row in PROCESSES)

_BY_ROLE = {row.role: row for row in PROCESSES}


def process(role: str) -> ProcessRow:
    """Row of a role. Raises UsageError, with the valid names, for a role that does not exist."""
    check_roles((role,), "role")
    return _BY_ROLE[role]


def check_roles(roles: Iterable[str], option: str) -> tuple[str, ...]:
    """The roles as a tuple. Raises UsageError, with the valid names, if one does not exist."""
    found = tuple(roles)
    for role in found:
        if role not in _BY_ROLE:
            raise UsageError(f"{option}: role {role!r} is unknown, allowed is one of {', '.join(ROLE_NAMES)}")
    return found


def role_list(option: str) -> Callable[[str], tuple[str, ...]]:
    """Reader of a list of roles with commas."""

    def read(text: str) -> tuple[str, ...]:
        try:
            return check_roles([name.strip() for name in text.split(",") if name.strip()], option)
        except UsageError as error:
            raise argparse.ArgumentTypeError(str(error)) from error

    return read
