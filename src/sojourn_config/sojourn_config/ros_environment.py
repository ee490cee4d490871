"""Environment variables of the processes: how they find each other, and what a foreign program must not inherit."""

import os
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path

from sojourn_config.paths import config_folder
from sojourn_machine import arithmetic

DEFAULT_DOMAIN = 42
HIGHEST_DOMAIN = 232
"""UDP ports of a domain are computed from its number; above this they do not fit."""

_OURS_ONLY = ("_ROS_WHEELS_BOOTSTRAP_COMPLETE", "VIRTUAL_ENV", "PYTHONHOME")
_SEARCH_PATHS = ("LD_LIBRARY_PATH", "PATH", "PYTHONPATH", "AMENT_PREFIX_PATH")


def ros_variables(domain: int, on_network: bool = False) -> dict[str, str]:
    """Variables by which nodes find each other.

    Args:
        domain: ROS domain. on_network: also nodes on other machines; else on this one only, over 127.0.0.1.
    """
    profile = "fastdds_network.xml" if on_network else "fastdds.xml"
    return {
        "ROS_DOMAIN_ID": str(domain),
        # the profile says it all: LOCALHOST would make the middleware add a shared-memory transport to it
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",
        "FASTRTPS_DEFAULT_PROFILES_FILE": str(config_folder() / "nodes" / profile),
    }


def what_the_network_opens(domain: int) -> str:
    """What a run on the network lets in, in words (ports: DDSI-RTPS 2.3, section 9.6.1)."""
    first = 7400 + 250 * domain
    return (
        f"--network: every node listens on all interfaces of this machine, UDP ports {first} to {first + 249}, and "
        "asks for others at 239.255.0.1. Nothing is encrypted and nobody is asked who he is: whoever reaches these "
        "ports hears the machine and can command it. Keep them behind a firewall, or use --secure"
    )


def own_environment(base: Mapping[str, str], ros: Mapping[str, str]) -> dict[str, str]:
    """Environment of our own nodes: each computes as all do, and what it prints is in its log at once."""
    environment = {**base, **ros, "PYTHONUNBUFFERED": "1"}
    arithmetic.pin(environment)
    return environment


def foreign_environment(base: Mapping[str, str], ros: Mapping[str, str], prefix: str = sys.prefix) -> dict[str, str]:
    """Environment of a program that is not ours: as it was before our scripts, and our arithmetic, changed it.

    scripts/lib/environment.sh keeps the outer values in SOJOURN_OUTER_<name>. Without it, everything that points into
    our virtual environment (`prefix`) is taken out.
    """
    environment = arithmetic.outer(base)
    outer = environment.pop("SOJOURN_OUTER", None)
    if outer is not None:
        for name in outer.split():
            environment.pop(name, None)
            value = environment.pop(f"SOJOURN_OUTER_{name}", None)
            if value is not None:
                environment[name] = value
    for name in _OURS_ONLY:
        environment.pop(name, None)
    for name in _SEARCH_PATHS:
        if name in environment:
            kept = [part for part in environment[name].split(os.pathsep) if not _is_inside(part, prefix)]
            environment[name] = os.pathsep.join(kept)
            if not environment[name]:
                del environment[name]
    return {**environment, **ros}


def is_ours(program: str, prefix: str = sys.prefix) -> bool:
    """Whether a program is one of our virtual environment."""
    found = shutil.which(program)
    return found is not None and _is_inside(os.path.abspath(found), prefix)


def default_domain() -> int | str:
    """ROS_DOMAIN_ID where it is set (as text, to be checked), else the project's own."""
    return os.environ.get("ROS_DOMAIN_ID") or DEFAULT_DOMAIN


def _is_inside(path: str, prefix: str) -> bool:
    return bool(path) and Path(os.path.abspath(path)).is_relative_to(os.path.abspath(prefix))
