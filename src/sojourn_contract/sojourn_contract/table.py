"""Prints the topic table as Markdown, for the manual: `python -m sojourn_contract.table`.

With `--into src/sojourn_contract/README.md` it renews the table between its two markers in that file instead.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from sojourn_contract.errors import ContractError
from sojourn_contract.stamps import CONTROL_PERIOD_S
from sojourn_contract.topic_types import FieldRule, Topic
from sojourn_contract.topics import TOPICS

BEGIN = "<!-- topics: begin (python -m sojourn_contract.table --into src/sojourn_contract/README.md) -->"
END = "<!-- topics: end -->"
HEAD = (
    "| topic | type | from → to | rate | age at most | what it holds |",
    "|---|---|---|---|---|---|",
)


class MarkersError(ContractError):
    """A text without the two markers, each once and in their order."""

    def __init__(self) -> None:
        super().__init__(f"the text must hold {BEGIN!r} and after it {END!r}, each once")


def markdown_table(topics: Sequence[Topic] = TOPICS) -> str:
    """The table as Markdown, one line a topic, in the order of the table."""
    return "\n".join((*HEAD, *(_line(row) for row in topics)))


def with_table(text: str) -> str:
    """The text with the table between its markers. Raises MarkersError."""
    if text.count(BEGIN) != 1 or text.count(END) != 1 or text.index(END) < text.index(BEGIN):
        raise MarkersError
    before, _, rest = text.partition(BEGIN)
    return f"{before}{BEGIN}\n{markdown_table()}\n{END}{rest.partition(END)[2]}"


def _line(row: Topic) -> str:
    cells = (
        f"`{row.name}`",
        row.type,
        f"{row.publisher} → {', '.join(row.subscribers) or 'bag, people'}",
        _rate(row),
        "" if row.max_age_s == float("inf") else f"{row.max_age_s:g} s",
        row.meaning + _each(row) + _units(row.fields) + ("" if row.logged else " (not in the bag)"),
    )
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _each(row: Topic) -> str:
    return f"; a further {row.each}: `{row.name}/NAME`" if row.each else ""


def _rate(row: Topic) -> str:
    return "event" if row.is_event else f"{1.0 / (row.every * CONTROL_PERIOD_S):g} Hz"


def _units(fields: Sequence[FieldRule]) -> str:
    """Unit and frame of each field, in brackets; neighbours with the same ones are told together."""
    told: list[tuple[str, list[str]]] = []
    for rule in fields:
        words = " ".join(part for part in (rule.unit, f"in {rule.frame}" if rule.frame else "") if part and part != "1")
        if not words:
            continue
        if told and told[-1][0] == words:
            told[-1][1].append(f"`{rule.path}`")
        else:
            told.append((words, [f"`{rule.path}`"]))
    texts = [f"{', '.join(paths)}: {words}" for words, paths in told]
    return f" ({'; '.join(texts)})" if texts else ""


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table, or renew it in a file. Returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m sojourn_contract.table", description=__doc__)
    parser.add_argument("--into", type=Path, metavar="FILE", help="renew the table between its markers in this file")
    file: Path | None = parser.parse_args(arguments).into
    if file is None:
        print(markdown_table())
        return 0
    try:
        file.write_text(with_table(file.read_text(encoding="utf-8")), encoding="utf-8")
    except (OSError, MarkersError) as error:
        print(f"{file}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
