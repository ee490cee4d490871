"""What tests compare with published figures, told as a table: the plugin of pytest that `scripts/validation` loads.

A test marked `published` holds figures of a source, named by the mark or by the test's own words. Each comparison in
it with a `pytest.approx` is told, but for those that allow a millionth or less of the figure: they are of formulas.
Errors that are held below a bound tell themselves, by pytest's `record_property`.
"""

import ast
import csv
import functools
import math
import os
import sys
import textwrap
from collections.abc import Iterator
from dataclasses import astuple, dataclass, fields
from itertools import groupby
from pathlib import Path
from types import FrameType

import pytest

SHOWN = 6
"""Lines of one test at most, the worst of them, unless all are asked for."""
WIDTH = 62
"""Of what is compared [characters]."""
FIGURE = "published figure"
"""Name of our property among those of a test's report."""
OF_FORMULAS = 1e-6
"""What a comparison with a formula allows, as a share of the value, at most; pytest's own too."""


@dataclass(frozen=True)
class Figure:
    """One comparison with a published figure."""

    chapter: str
    """Folder of the test below `test`."""
    test: str
    """The test's name in words."""
    source: str
    """Whose figure it is, or what the test says of it."""
    quantity: str
    """What is compared, in which of the test's cases and as the test writes it."""
    published: float
    ours: float
    allowed: float
    """How far off it may be, in the unit of the figure."""

    @property
    def share(self) -> float:
        """How much of what is allowed it is off."""
        return abs(self.ours - self.published) / self.allowed if self.allowed else 0.0

    def line(self) -> str:
        """Differences in per cent of the published figure, where that is not zero."""
        scale, unit = (100.0 / abs(self.published), " %") if self.published else (1.0, "")
        off, allowed = f"{scale * (self.ours - self.published):+.2g}{unit}", f"{scale * self.allowed:.2g}{unit}"
        what = self.quantity if len(self.quantity) <= WIDTH else f"{self.quantity[: WIDTH - 3]}..."
        # as many digits as tell what is allowed, and one more
        fine = math.ceil(math.log10(abs(self.published) / self.allowed)) if self.published and self.allowed else 0
        digits = min(max(fine + 2, 5), 12)
        return f"  {what:{WIDTH}} {self.published:>13.{digits}g} {self.ours:>13.{digits}g} {off:>11} {allowed:>11}"


class PublishedFigures:
    """Listens to the comparisons of marked tests while they run, and tells them at the end."""

    def __init__(self, every: bool, csv_file: Path | None) -> None:
        self.every = every
        self.csv_file = csv_file
        self.running: pytest.Item | None = None
        self.figures: list[Figure] = []
        self.errors: list[tuple[str, object]] = []

    def listen(self) -> None:
        """To every comparison of two numbers, in which one with an array ends too."""
        scalar = type(pytest.approx(0.0))
        compared = scalar.__eq__

        def heard(expected, actual) -> bool:
            equal = compared(expected, actual)
            of_a_formula = (expected.rel is None or expected.rel <= OF_FORMULAS) and expected.abs is None
            if self.running is not None and not of_a_formula and not getattr(actual, "shape", ()):
                figure = figure_of(self.running, written_at(sys._getframe(1)), expected, actual)
                # with its report, from whichever process runs the test
                self.running.user_properties.append((FIGURE, astuple(figure)))
            return equal

        scalar.__eq__ = heard

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Iterator[None]:
        """Only marked tests are listened to."""
        self.running = item if item.get_closest_marker("published") else None
        try:
            return (yield)
        finally:
            self.running = None

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Once for each test, in the process that reports."""
        if report.when != "call":
            return
        for name, value in report.user_properties:
            if name == FIGURE:
                self.figures.append(Figure(*value))
            else:
                self.errors.append((name, value))

    def pytest_terminal_summary(self, terminalreporter) -> None:
        """The table, by chapters and tests."""
        write = terminalreporter.write_line
        figures = sorted(self.figures, key=lambda figure: figure.chapter)
        for chapter, of_chapter in groupby(figures, lambda figure: figure.chapter):
            terminalreporter.section(chapter)
            write(f"  {'what is compared':{WIDTH}} {'published':>13} {'Sojourn':>13} {'off':>11} {'allowed':>11}")
            for (test, source), of_test in groupby(of_chapter, lambda figure: (figure.test, figure.source)):
                write(f"\n{test}", bold=True)
                write(textwrap.indent(textwrap.fill(source, 110), "  "))
                self._write_test(write, list(of_test))
        if self.errors:
            terminalreporter.section("errors against measured trials")
            for name, value in self.errors:
                write(f"  {name}: {value}")
        beyond = sum(figure.share > 1.0 for figure in figures)
        write(f"\n{len(figures)} published figures, {beyond} farther off than allowed.")
        if self.csv_file is not None:
            with self.csv_file.open("w", newline="", encoding="utf-8") as file:
                rows = csv.writer(file)
                rows.writerow(field.name for field in fields(Figure))
                rows.writerows(astuple(figure) for figure in figures)

    def _write_test(self, write, figures: list[Figure]) -> None:
        shown = figures if self.every else sorted(figures, key=lambda figure: -figure.share)[:SHOWN]
        for figure in shown:
            write(figure.line(), red=figure.share > 1.0)
        if len(shown) < len(figures):
            write(f"  and {len(figures) - len(shown)} that are nearer")


def figure_of(item: pytest.Item, written: str, expected, actual) -> Figure:
    """A comparison, with what the test says of it."""
    mark = item.get_closest_marker("published")
    words = " ".join((item.function.__doc__ or "").split())
    _, _, case = item.name.partition("[")
    return Figure(
        chapter=item.nodeid.partition("::")[0].rpartition("/")[0].removeprefix("test/"),
        test=item.originalname.removeprefix("test_").replace("_", " "),
        source=". ".join(filter(None, (*mark.args, words))),
        quantity=f"[{case} {written}" if case else written,
        published=float(expected.expected),
        ours=float(actual),
        allowed=float(expected.tolerance),
    )


@functools.cache
def comparisons(path: str) -> list[ast.Compare]:
    """Of a file of tests, those with `approx`."""
    tree = ast.parse(Path(path).read_text(encoding="utf-8"))
    return [node for node in ast.walk(tree) if isinstance(node, ast.Compare) and "approx(" in ast.unparse(node)]


def written_at(frame: FrameType | None) -> str:
    """The left side of the comparison that is being made, from the text of the test."""
    own = ("_pytest", __name__)
    while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] in own:
        frame = frame.f_back
    if frame is None:
        return ""
    for node in comparisons(frame.f_code.co_filename):
        if node.lineno <= frame.f_lineno <= (node.end_lineno or node.lineno):
            return ast.unparse(node.left)
    return frame.f_code.co_name


def pytest_addoption(parser: pytest.Parser) -> None:
    """What `scripts/validation` takes beside pytest's own options."""
    parser.addoption("--every", action="store_true", help=f"tell every figure, not the {SHOWN} worst of each test")
    parser.addoption("--csv", type=Path, metavar="FILE", help="write every figure to a file too")


def pytest_configure(config: pytest.Config) -> None:
    """Listen from now on. A file is named from where the script was called."""
    csv_file = config.getoption("csv")
    if csv_file is not None:
        csv_file = Path(os.environ.get("SOJOURN_CALLED_FROM", "")) / csv_file
    plugin = PublishedFigures(config.getoption("every"), csv_file)
    plugin.listen()
    config.pluginmanager.register(plugin)
