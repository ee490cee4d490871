"""DDS security of a run (start.py --secure): keys and permissions of every role, made for this run and no other.

The ROS library is told to enforce it: where it was built without security it starts no node, so that a run is never
open in silence.
"""

import importlib.util
import os
import shutil
import subprocess
from pathlib import Path

from sojourn_bringup.access import access_policy
from sojourn_bringup.plan import RunPlan
from sojourn_config.command_errors import CommandError, UsageError
from sojourn_contract.topic_table import TopicTable

KEYSTORE, POLICY = "keystore", "policy.xml"


def has_sros2() -> bool:
    """Whether `ros2 security` can be asked here."""
    return importlib.util.find_spec("sros2") is not None and shutil.which("ros2") is not None


def check_secure() -> None:
    """Raise UsageError where this machine has no SROS 2."""
    if not has_sros2():
        raise UsageError(
            "--secure needs SROS 2 (ros2 security), which the ROS wheels of .venv do not have, nor a Fast DDS with "
            "security: source a ROS 2 Jazzy that has them; without --secure the nodes meet on 127.0.0.1 only"
        )


def make_keystore(plan: RunPlan, table: TopicTable) -> dict[str, str]:
    """Make policy, keys and permissions in the folder of a run.

    Returns:
        variables by which its processes use them.

    Raises:
        CommandError: `ros2 security` fails; with what it said.
    """
    keystore, policy = plan.run_dir / KEYSTORE, plan.run_dir / POLICY
    policy.write_text(access_policy(table, plan.participants, plan.namespace, plan.companions), encoding="utf-8")
    command = ["ros2", "security", "generate_artifacts", "-k", str(keystore), "-p", str(policy)]
    there = {**os.environ, "ROS_DOMAIN_ID": str(plan.domain)}  # for whose domain the keys are, it takes from there
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=there)
    if done.returncode != 0:
        said = (done.stderr or done.stdout).strip().splitlines()
        raise CommandError(f"{' '.join(command)}: {said[-1] if said else f'ended with status {done.returncode}'}")
    return security_variables(keystore)


def security_variables(keystore: Path) -> dict[str, str]:
    """By these the ROS library finds the keys, and refuses to do without."""
    return {
        "ROS_SECURITY_ENABLE": "true",
        "ROS_SECURITY_STRATEGY": "Enforce",
        "ROS_SECURITY_KEYSTORE": os.fspath(keystore),
    }
