"""The operator's console: scripts/console beside a running stack, or over a bag. It serves a page on this machine."""

from collections.abc import Sequence
from pathlib import Path

from sojourn_config import command_line

LATEST = Path("runs/latest")
FIRST_PORT = 8680


def parser() -> command_line.Parser:
    """Options of scripts/console."""
    result = command_line.Parser(
        prog="console",
        description="See a run in the browser and command it: a page on this machine, whose address has a token.",
    )
    result.add_argument(
        "scenario",
        nargs="?",
        help=f"that the stack runs: name in config/scenarios, or a YAML file (default: as the bag of {LATEST} has it)",
    )
    result.add_argument(
        "--bag", type=Path, metavar="RUN", help="play this bag: folder of a run, folder of a bag, or an .mcap file"
    )
    result.add_argument("--run-dir", type=Path, metavar="DIR", help="folder of the run whose bag says what is run")
    command_line.add_changes(result, "as the run was started with")
    result.add_argument("--limits", type=Path, metavar="FILE", help="alarms over those of the machine (YAML)")
    result.add_argument("--who", metavar="NAME", help="who commands and acknowledges (default: the login name)")
    command_line.add_place(result)
    result.add_argument(
        "--port",
        type=command_line.count,
        default=FIRST_PORT,
        metavar="N",
        help="first that is tried; the next free one is taken (default: %(default)s)",
    )
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Serve the page until Ctrl-C; 0, or 2 where what is asked for cannot be."""
    options = parser()
    given = options.parse_args(arguments)
    if given.bag is not None and (given.scenario is not None or given.run_dir is not None or given.set):
        options.error("--bag RUN knows its own scenario: it does not go with SCENARIO, --run-dir or --set")
    if given.port > 65_000:
        options.error(f"--port {given.port}: allowed is a whole number from 1 to 65000")
    from sojourn_console.console_run import run  # not above: --help needs none of it

    return run(given)


if __name__ == "__main__":
    command_line.run_script(main)
