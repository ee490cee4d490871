"""Node of the drive, the shell round `app`."""

import sys

from sojourn_contract import process
from sojourn_contract.app_node import AppNode
from sojourn_drive.app import DriveApp


class DriveNode(AppNode):
    """Role drive."""

    app_class = DriveApp


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(DriveNode))


if __name__ == "__main__":
    main()
