"""`python -m sojourn_bags.standby CONFIGURATION --ros-args ...`: a recorder that has read all it needs, and waits.

What is said between the death of a recorder and the first word that its successor hears is lost; most of that time a
process would spend on libraries and on the scenario. This one has done so when it is wanted: it begins with the first
line on its standard input, and ends where that ends. Until then it is no node, and nobody sees it.

CONFIGURATION: JSON with `scenario` and `overrides`, as among the ROS parameters.
"""

import json
import signal
import sys

from sojourn_bags.errors import BagsError
from sojourn_bags.recorder_node import RecorderNode
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract import process
from sojourn_contract.state_tree import CheckpointError


def main() -> None:
    """Wait, then run the recorder."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # as long as it waits there is nothing to finish
    given = json.loads(sys.argv[1])
    try:
        loaded = load_scenario(given["scenario"], given["overrides"])
        if not sys.stdin.readline():
            return
        sys.exit(process.run(lambda: RecorderNode(loaded=loaded)))
    except (BagsError, ConfigError, CheckpointError, OSError) as error:
        print(f"recorder: {error}", file=sys.stderr)
        sys.exit(1)


if __name__ == "__main__":
    main()
