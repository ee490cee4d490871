"""Draws fields of a bag over time: scripts/plot BAG TOPIC.FIELD ... writes a picture and prints min, mean, max."""

from argparse import RawDescriptionHelpFormatter
from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line

EXAMPLES = """examples:
  plot runs/latest /odom.pose.pose.position
  plot runs/latest "/joint_states.position[wheel_front_left_joint]" /truth/contacts.sinkage
  plot runs/latest /power/status.soc /battery_state.voltage --csv power.csv
"""


def parser() -> command_line.Parser:
    """Options of scripts/plot."""
    result = command_line.Parser(
        prog="plot",
        description="Draw fields of a bag over stamp time: one panel for each unit.",
        epilog=EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
    )
    result.add_argument("bag", type=Path, metavar="BAG", help="folder of a run, folder of a bag, or an .mcap file")
    result.add_argument(
        "fields", nargs="+", metavar="TOPIC.FIELD", help="with [INDEX] or [NAME] for one number of an array"
    )
    result.add_argument("--out", type=Path, metavar="FILE.png", help="picture (default: plot.png here)")
    result.add_argument("--csv", type=Path, metavar="FILE.csv", help="the numbers as a table")
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw fields of a bag."""
    given = parser().parse_args(arguments)
    from sojourn_bags.plot_fields import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
