"""Node of the sensors, the shell round `app`."""

import sys

from sojourn_contract import process
from sojourn_contract.app_node import AppNode
from sojourn_sensors.app import SensorsApp


class SensorsNode(AppNode):
    """Role sensors."""

    app_class = SensorsApp


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(SensorsNode))


if __name__ == "__main__":
    main()
