"""Node of the plant, the shell round `app`. It owns /clock, see `pacing`."""

import sys

from sojourn_contract import process
from sojourn_plant.app import PlantApp
from sojourn_plant.pacing import PacingNode


class PlantNode(PacingNode):
    """Role plant."""

    app_class = PlantApp


def main() -> None:
    """Run the node as a process."""
    sys.exit(process.run(PlantNode))


if __name__ == "__main__":
    main()
