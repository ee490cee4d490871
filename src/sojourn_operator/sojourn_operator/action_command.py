"""Serves the actions by which the front ends of Nav2 and MoveIt send goals, beside a running stack: scripts/actions."""

import argparse
from collections.abc import Sequence

from sojourn_config import command_line


def parser() -> argparse.ArgumentParser:
    """Options of scripts/actions."""
    result = command_line.Parser(
        prog="actions",
        description="Take goals of nav2_msgs/NavigateToPose for the drive and of control_msgs/FollowJointTrajectory "
        "for the arm, where these packages are installed, and send them to a running stack. Ctrl-C ends it.",
    )
    result.add_argument(
        "--navigate", metavar="NAME", default="navigate_to_pose", help="of the drive's action (default: %(default)s)"
    )
    result.add_argument(
        "--arm", metavar="NAME", default="arm_controller/follow_joint_trajectory",
        help="of the arm's action (default: %(default)s)",
    )  # fmt: skip
    command_line.add_place(result)
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """0 when it is stopped; 2 where no action is installed."""
    given = parser().parse_args(arguments)
    from sojourn_operator.actions.adapter import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
