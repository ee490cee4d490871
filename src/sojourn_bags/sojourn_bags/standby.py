"""`python -m sojourn_bags.standby CONFIGURATION --ros-args ...`: a recorder that has read all it needs, and waits.

What is said between the death of a recorder and the first word that its successor hears is lost; most of that time a
process would spend on libraries and on the scenario. This one has done so when it is wanted: it begins with the first
line on its standard input, and ends where that ends. Until then it is no node, and nobody sees it.

CONFIGURATION: JSON with `scenario` and `overrides`, as among the ROS parameters.
"""

import json
import signal
import sys

from rclpy.type_support import check_for_type_support

from sojourn_bags.definitions import definition, full_type, type_hash
from sojourn_bags.errors import BagsError
from sojourn_bags.recorder_node import RecorderNode
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_contract import process
from sojourn_contract.run_table import table_of
from sojourn_contract.state_tree import CheckpointError
from sojourn_contract.types import message_class


def main() -> None:
    """Wait, then run the recorder."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # as long as it waits there is nothing to finish
    given = json.loads(sys.argv[1])
    try:
        loaded = load_scenario(given["scenario"], given["overrides"])
        read_ahead(loaded)
        if not sys.stdin.readline():
            return
        sys.exit(process.run(lambda: RecorderNode(loaded=loaded)))
    except (BagsError, ConfigError, CheckpointError, OSError) as error:
        print(f"recorder: {error}", file=sys.stderr)
        sys.exit(1)


def read_ahead(loaded: LoadedScenario) -> None:
    """What a recorder reads when it is made, four fifths of that time: how the messages of its run look."""
    for row in table_of(loaded).inputs_of("recorder"):
        check_for_type_support(message_class(row.type))
        definition(full_type(row.type))
        type_hash(full_type(row.type))


if __name__ == "__main__":
    main()
