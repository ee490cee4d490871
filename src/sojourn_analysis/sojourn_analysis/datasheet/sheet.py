"""The whole data sheet, and the published figures beside its own."""

from collections.abc import Callable
from typing import NamedTuple

from sojourn_analysis.datasheet.cornering import cornering
from sojourn_analysis.datasheet.driving import energy, performance, ruts, traction, traverses
from sojourn_analysis.datasheet.figures import Section
from sojourn_analysis.datasheet.ground import footing
from sojourn_analysis.datasheet.motors import motors
from sojourn_analysis.datasheet.riding import riding
from sojourn_analysis.datasheet.shock import shock
from sojourn_analysis.datasheet.standing import general, standing, steps
from sojourn_analysis.datasheet.stopping import stopping
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.datasheet.suspending import differential, suspension
from sojourn_analysis.datasheet.turning import handling, steering
from sojourn_analysis.datasheet.unusual_steering import slip_steering
from sojourn_analysis.vehicle.params import PublishedFigure
from sojourn_machine.errors import InvalidValueError


class FigureComparison(NamedTuple):
    """A published figure and our own."""

    label: str
    unit: str
    published: tuple[float, float]
    own: float | None
    inside: bool
    source: str


class Datasheet(NamedTuple):
    """Sections and comparisons; none of these where the published figures are for another ground."""

    sections: tuple[Section, ...]
    comparisons: tuple[FigureComparison, ...]


NEAR = 0.05
"""A figure of its own counts as agreeing with a published one within this part of it."""


MAKERS: tuple[Callable[[Subject], Section | None], ...] = (
    general,
    standing,
    steps,
    footing,
    traction,
    performance,
    stopping,
    motors,
    energy,
    traverses,
    ruts,
    steering,
    slip_steering,
    handling,
    cornering,
    suspension,
    differential,
    riding,
    shock,
)
"""In the order of the page; None from one that does not apply."""


def datasheet(subject: Subject) -> Datasheet:
    """Compute it.

    Raises:
        InvalidValueError: a published figure that the sheet does not have, or numbers that no model takes.
    """
    sections = tuple(section for make in MAKERS if (section := make(subject)) is not None)
    vehicle = subject.vehicle
    elsewhere = vehicle.published_on is not None and vehicle.published_on != (subject.body.name, subject.soil.name)
    return Datasheet(sections, () if elsewhere else compare(vehicle.published, sections))


def compare(published: tuple[PublishedFigure, ...], sections: tuple[Section, ...]) -> tuple[FigureComparison, ...]:
    """The published figures with those of the sections.

    Raises:
        InvalidValueError: a published figure that the sections do not have.
    """
    figures = {figure.key: figure for section in sections for figure in section.figures}
    compared = []
    for item in published:
        if item.figure not in figures:
            raise InvalidValueError("published.figure", item.figure, "one of " + ", ".join(sorted(figures)))
        figure = figures[item.figure]
        own = figure.value if isinstance(figure.value, float) else None
        inside = own is not None and item.low * (1.0 - NEAR) <= own <= item.high * (1.0 + NEAR)
        compared.append(FigureComparison(figure.label, figure.unit, (item.low, item.high), own, inside, item.source))
    return tuple(compared)
