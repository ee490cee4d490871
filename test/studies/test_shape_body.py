"""A body of a shape file: an ellipsoid in triangles draws as the ellipsoid does, whichever format it is read from."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from sojourn_config.command_errors import UsageError
from sojourn_config.load import load_params
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.gravity.polyhedron import Mesh
from sojourn_studies import shape_body

AXES = np.array((267.5, 147.0, 104.5))
"""Of Itokawa's ellipsoid [m]."""


def ellipsoid(points: int = 400) -> Mesh:
    """A triangulation of it: points of a Fibonacci spiral on a sphere, their hull, stretched."""
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(points)
    z = 1.0 - (2.0 * np.arange(points) + 1.0) / points
    ring = np.sqrt(1.0 - z * z)
    sphere = np.column_stack((ring * np.cos(turn), ring * np.sin(turn), z))
    hull = ConvexHull(sphere)
    facets = hull.simplices.copy()
    inward = np.einsum("ij,ij->i", np.cross(*np.moveaxis(np.diff(sphere[facets], axis=1), 1, 0)), hull.equations[:, :3])
    facets[inward < 0.0] = facets[inward < 0.0][:, ::-1]
    return Mesh(sphere * AXES, facets)


def obj(mesh: Mesh) -> str:
    lines = ["# an ellipsoid", *(f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in mesh.vertices)]
    return "\n".join([*lines, *(f"f {a}/1/1 {b}/1/1 {c}/1/1" for a, b, c in mesh.facets + 1)])


def plates(mesh: Mesh) -> str:
    vertices = [f"{number} {x:.9f} {y:.9f} {z:.9f}" for number, (x, y, z) in enumerate(mesh.vertices, 1)]
    facets = [f"{number} {a} {b} {c}" for number, (a, b, c) in enumerate(mesh.facets + 1, 1)]
    return "\n".join([str(len(vertices)), *vertices, str(len(facets)), *facets])


def worst_error(points: int, form: Callable[[Mesh], str], folder: Path) -> float:
    """Of the pull of a body of a shape file, against the smooth ellipsoid's, near its surface [1]."""
    mesh = ellipsoid(points)
    shape, out = folder / f"shape_{points}.txt", folder / f"itokawa_{points}.yaml"
    aside = np.array((30.0, -20.0, 10.0))
    shape.write_text(form(Mesh((mesh.vertices + aside) / 1000.0, mesh.facets)), "utf-8")
    assert shape_body.main([str(shape), "itokawa", "--unit", "1000", "--out", str(out)]) == 0
    body, known = load_params("bodies", str(out), BodyParams), load_params("bodies", "itokawa", BodyParams)
    assert body.rotation == known.rotation and body.semi_axes == pytest.approx(tuple(AXES), rel=0.01)
    assert body.attraction is not None and known.attraction is not None and body.attraction.kind == "polyhedron"
    polyhedron, smooth = body.attraction.build(body), known.attraction.build(known)
    errors = []
    for direction in np.vstack((np.eye(3), -np.eye(3), np.ones((1, 3)) / np.sqrt(3.0))):
        place = 1.05 * AXES * direction
        wanted = smooth.acceleration(place)
        errors.append(float(np.linalg.norm(polyhedron.acceleration(place) - wanted) / np.linalg.norm(wanted)))
        assert polyhedron.potential(place) == pytest.approx(smooth.potential(place), rel=0.01)
    return max(errors)


@pytest.mark.parametrize("form", [obj, plates])
def test_an_ellipsoid_in_triangles_draws_as_an_ellipsoid(form: Callable[[Mesh], str], tmp_path: Path) -> None:
    """The better, the finer: what the facets cut off goes with the square of their size."""
    coarse, fine = (worst_error(points, form, tmp_path) for points in (200, 800))
    assert coarse < 0.04 and fine < 0.35 * coarse


def test_faces_with_more_corners_are_cut(tmp_path: Path) -> None:
    """A cube of two metres by six squares."""
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    squares = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    cube = tmp_path / "cube.obj"
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + ["f " + " ".join(map(str, square)) for square in squares]
    cube.write_text("\n".join(lines), "utf-8")
    mesh = shape_body.read_shape(cube)
    assert len(mesh.facets) == 12 and mesh.volume == pytest.approx(8.0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "holds no vertices"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 nan\nf 1 2 3", r":3: 0 1 nan: allowed are 3 or more finite numbers"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9", "beyond 1 to 3"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2", r":4: 1 2: allowed are 3 or more"),
        ("2\n1 0 0 0", "nothing: allowed are 3 or more"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3", "volume 0|closed surface"),
        ("v 1 1 1\nv 2 1 1\nv 1 2 1\nv 1 1 2\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3", "counter-clockwise"),
    ],
)
def test_what_is_no_shape_is_refused_with_its_line(text: str, words: str, tmp_path: Path) -> None:
    shape = tmp_path / "shape.obj"
    shape.write_text(text, "utf-8")
    with pytest.raises(UsageError, match=words):
        shape_body.main([str(shape), "eros", "--out", str(tmp_path / "eros_shape.yaml")])
    assert not (tmp_path / "eros_shape.yaml").exists()
