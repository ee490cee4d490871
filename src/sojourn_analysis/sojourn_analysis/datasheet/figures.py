"""What a data sheet is made of: figures with units, curves, sections. Plain values, drawn and printed elsewhere."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from sojourn_machine.params import FloatArray


class Figure(NamedTuple):
    """One number (or word). `key` is its name for programmes; a value of None means that it does not apply."""

    key: str
    label: str
    value: float | str | None
    unit: str = ""
    note: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """Lines over one abscissa. A line is y over x, shapes (n,); `points` are single marks (x, y) with a name."""

    title: str
    x_label: str
    y_label: str
    lines: Mapping[str, tuple[FloatArray, FloatArray]]
    points: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    logarithmic: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Section:
    """Figures and curves of one subject; `text` says what was assumed."""

    title: str
    figures: tuple[Figure, ...]
    curves: tuple[Curve, ...] = ()
    text: str = ""
