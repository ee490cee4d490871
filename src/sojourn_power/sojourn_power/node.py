"""Node of the power and battery manager, the shell round `app`."""

import sys

from sojourn_contract import process
from sojourn_contract.app_node import AppNode
from sojourn_power.app import PowerApp


class PowerNode(AppNode):
    """Role power."""

    app_class = PowerApp


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(PowerNode))


if __name__ == "__main__":
    main()
