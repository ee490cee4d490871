"""Node of the arm, the shell round `app`."""

import sys

from sojourn_arm.app import ArmApp
from sojourn_contract import process
from sojourn_contract.app_node import AppNode


class ArmNode(AppNode):
    """Role arm."""

    app_class = ArmApp


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(ArmNode))


if __name__ == "__main__":
    main()
