"""Makes a body of a shape model: its gravity is that of the polyhedron, filled evenly.

    scripts/lib/python -m sojourn_studies.shape_body eros.obj eros --unit 1000 --out eros_shape.yaml
    scripts/site eros_shape.yaml --lat 10

Read are lines `v X Y Z` and `f A B C`, as Wavefront OBJ has them (facets count from 1, of `A/T/N` the first number
counts, those with more corners are cut into triangles), and tables of plates: a line with the number of vertices, so
many lines `N X Y Z`, a line with the number of plates, so many lines `N A B C`. The file that is written extends the
body that is named; its vertices are in metres about their centre of mass, its reference ellipsoid has the extents of
the shape. A place of the sheet is on that ellipsoid: `--altitude` brings it to the shape.
"""

import argparse
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from sojourn_config import command_line
from sojourn_config.command_errors import UsageError
from sojourn_config.load import load_params
from sojourn_machine.errors import MachineError
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.gravity.polyhedron import Mesh, PolyhedronParams

MOST_FACETS = 100_000


def read_shape(path: Path) -> Mesh:
    """A shape model in the unit of its file. Raises UsageError: it is none, with the line."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError(f"shape_body: {path}: {error}") from error
    rows = [(number, line.split()) for number, line in enumerate(lines, 1) if line.split("#")[0].strip()]
    if not rows:
        raise UsageError(f"shape_body: {path}: holds no vertices")
    wavefront = any(words[0] == "v" for _, words in rows)
    vertices, facets = _wavefront(path, rows) if wavefront else _plates(path, rows)
    if not vertices or not facets or len(facets) > MOST_FACETS:
        allowed = f"some vertices, and 1 to {MOST_FACETS} facets"
        raise UsageError(f"shape_body: {path}: {len(vertices)} vertices, {len(facets)} facets: allowed are {allowed}")
    corners: IntArray = np.array(facets, dtype=np.int64) - 1
    places: FloatArray = np.array(vertices, dtype=np.float64)
    if corners.min() < 0 or corners.max() >= len(places):
        raise UsageError(f"shape_body: {path}: a facet names a vertex beyond 1 to {len(places)}")
    return Mesh(places, corners)


Row = tuple[int, list[str]]


def _wavefront(path: Path, rows: Sequence[Row]) -> tuple[list[list[float]], list[list[int]]]:
    vertices: list[list[float]] = []
    facets: list[list[int]] = []
    for number, words in rows:
        if words[0] == "v":
            vertices.append(_numbers(path, number, words[1:4]))
        elif words[0] == "f":
            corners = [int(one) for one in _numbers(path, number, [word.split("/")[0] for word in words[1:]])]
            facets += [[corners[0], *pair] for pair in pairwise(corners[1:])]
    return vertices, facets


def _plates(path: Path, rows: Sequence[Row]) -> tuple[list[list[float]], list[list[int]]]:
    left = iter(rows)
    vertices = list(_table(path, left))
    return vertices, [[int(one) for one in row] for row in _table(path, left)]


def _table(path: Path, rows: Iterator[Row]) -> Iterator[list[float]]:
    """Rows of a table that says first how many they are, without their own numbers."""
    number, words = next(rows, (0, ["0"]))
    for _ in range(int(_numbers(path, number, words[:1], 1)[0])):
        number, words = next(rows, (number, []))
        yield _numbers(path, number, words[1:4])


def _numbers(path: Path, number: int, words: Sequence[str], least: int = 3) -> list[float]:
    try:
        found = [float(word) for word in words]
    except ValueError:
        found = []
    if len(found) < least or not np.isfinite(found).all():
        given = " ".join(words) or "nothing"
        raise UsageError(f"shape_body: {path}:{number}: {given}: allowed are {least} or more finite numbers")
    return found


def centred(mesh: Mesh, unit: float) -> Mesh:
    """The same in metres about its centre of mass; unit: of its lengths [m]."""
    scaled = Mesh(unit * mesh.vertices, mesh.facets)
    return Mesh(scaled.vertices - scaled.centroid, mesh.facets)


def body_text(base: str, name: str, mesh: Mesh) -> str:
    """A file of a body of this shape [m]. Raises MachineError: a surface that is not closed."""
    vertices = [[round(float(value), 6) for value in vertex] for vertex in mesh.vertices]
    PolyhedronParams.model_validate({"vertices": vertices, "facets": mesh.facets.tolist()})
    axes = sorted((0.5 * np.ptp(mesh.vertices, axis=0)).tolist(), reverse=True)
    return "\n".join(
        [
            f"# {base} by a shape of {len(vertices)} vertices and {len(mesh.facets)} facets, {mesh.volume:.6g} m3.",
            f"extends: {base}",
            f"name: {name}",
            f"shape: {{semi_axes: {[round(axis, 3) for axis in axes]}}}",
            "attraction:",
            "  kind: polyhedron",
            f"  vertices: {vertices}",
            f"  facets: {mesh.facets.tolist()}",
            "",
        ]
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Read, check and write."""
    parser = command_line.Parser(prog="shape_body", description="Make a body of a shape model.")
    parser.add_argument("shape", type=Path, help="OBJ, or table of vertices and plates")
    parser.add_argument("body", help="of config/bodies: whose mass and rotation it has")
    parser.add_argument("--unit", type=command_line.number, default=1.0, metavar="M", help="of the file (%(default)s)")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="body to write, NAME.yaml")
    return run(parser.parse_args(arguments))


def run(given: argparse.Namespace) -> int:
    """Write the body. Raises UsageError, ConfigError."""
    load_params("bodies", given.body, BodyParams)
    if not given.unit > 0.0:
        raise UsageError(f"shape_body: --unit {given.unit:g}: allowed is more than 0 m")
    mesh = read_shape(given.shape)
    if not mesh.volume > 0.0:
        allowed = "more than 0: a closed surface whose facets go round counter-clockwise, seen from outside"
        raise UsageError(f"shape_body: {given.shape}: volume {mesh.volume:g}: allowed is {allowed}")
    try:
        text = body_text(given.body, given.out.stem, centred(mesh, given.unit))
    except (MachineError, ValueError) as error:
        raise UsageError(f"shape_body: {given.shape}: {error}") from error
    try:
        given.out.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UsageError(f"--out {given.out}: {error}") from error
    print(f"{given.out}: {len(mesh.vertices)} vertices, {len(mesh.facets)} facets")
    return 0


if __name__ == "__main__":
    command_line.run_script(main)
