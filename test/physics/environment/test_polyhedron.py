"""Attraction of polyhedra: a cube's potential, the potential's slopes, Poisson's equation, an ellipsoid."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sojourn_config.load import load_params
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.environment.gravity.ellipsoid import EllipsoidAttraction
from sojourn_physics.environment.gravity.polyhedron import Mesh, PolyhedronAttraction, polyhedron_attraction
from sojourn_physics.environment.site import SiteParams

PLACES = st.tuples(*(st.floats(-3.0, 3.0),) * 3).map(np.array)


def cube(side: float = 1.0) -> Mesh:
    """Round the origin, two triangles a face."""
    corners = 0.5 * side * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    facets = [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]
    return Mesh(corners, np.array(facets))


def ball(rounds: int, semi_axes: tuple[float, float, float]) -> Mesh:
    """An octahedron whose facets are cut in four so many times, its corners put on an ellipsoid."""
    vertices = [tuple(row) for row in np.vstack((np.eye(3), -np.eye(3))).tolist()]
    facets = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]
    for _ in range(rounds):
        middles: dict[tuple[int, int], int] = {}
        finer = []
        for facet in facets:
            between = []
            for i in range(3):
                pair = (min(facet[i], facet[i - 2]), max(facet[i], facet[i - 2]))
                if pair not in middles:
                    point = np.array(vertices[pair[0]]) + np.array(vertices[pair[1]])
                    middles[pair] = len(vertices)
                    vertices.append(tuple((point / np.linalg.norm(point)).tolist()))
                between.append(middles[pair])
            (a, b, c), (ab, bc, ca) = facet, between
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        facets = finer
    return Mesh(np.array(vertices) * semi_axes, np.array(facets))


def of_density_one(mesh: Mesh) -> PolyhedronAttraction:
    """Such that G rho is 1."""
    return polyhedron_attraction(mesh, mesh.volume)


def tetrahedron(points: FloatArray) -> Mesh:
    mesh = Mesh(points, np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]))
    return mesh if mesh.volume > 0.0 else mesh._replace(facets=mesh.facets[:, ::-1])


@pytest.mark.published
def test_potential_at_the_centre_of_a_unit_cube_is_the_published_one() -> None:
    """2.380077 G rho; in closed form 3 ln(2 + sqrt 3) - pi/2 (Waldvogel 1976, Z. angew. Math. Phys. 27:867)."""
    found = -of_density_one(cube()).potential(np.zeros(3))
    assert found == pytest.approx(2.380077, abs=1e-6)
    assert found == pytest.approx(3.0 * math.log(2.0 + math.sqrt(3.0)) - 0.5 * math.pi, rel=1e-12)
    np.testing.assert_allclose(of_density_one(cube()).acceleration(np.zeros(3)), 0.0, atol=1e-12)


def test_at_a_corner_of_a_cube_the_potential_is_half_that_of_its_centre() -> None:
    """Eight cubes round a corner are one twice as large, whose potential at its centre is four times."""
    one = of_density_one(cube())
    assert one.potential(np.full(3, 0.5)) == pytest.approx(0.5 * one.potential(np.zeros(3)), rel=1e-9)


@given(PLACES)
def test_the_acceleration_is_the_fall_of_the_potential(place: FloatArray) -> None:
    attraction = of_density_one(cube())
    near = np.abs(np.abs(place) - 0.5).min()
    assume(near > 1e-2)  # the potential of a face has a kink in its second slope
    step = 1e-3
    fall = [attraction.potential(place - s) - attraction.potential(place + s) for s in step * np.eye(3)]
    np.testing.assert_allclose(attraction.acceleration(place), np.array(fall) / (2.0 * step), atol=2e-4)


@given(PLACES)
def test_poisson_s_equation_holds_inside_and_outside(place: FloatArray) -> None:
    assume(np.abs(np.abs(place) - 0.5).min() > 1e-6)
    inside = bool(np.abs(place).max() < 0.5)
    expected = -4.0 * math.pi if inside else 0.0
    assert of_density_one(cube()).divergence(place) == pytest.approx(expected, abs=1e-8)


@given(st.lists(PLACES, min_size=4, max_size=4).map(np.array), PLACES)
def test_any_tetrahedron_is_a_point_from_afar_and_obeys_gauss(points: FloatArray, direction: FloatArray) -> None:
    mesh = tetrahedron(points)
    assume(mesh.volume > 0.1 and np.linalg.norm(direction) > 0.1)
    attraction = polyhedron_attraction(mesh, 1.0)
    far = mesh.centroid + 300.0 * direction / np.linalg.norm(direction)
    np.testing.assert_allclose(attraction.acceleration(far), (mesh.centroid - far) / 300.0**3, atol=2e-3 / 300.0**2)
    assert attraction.divergence(mesh.centroid) == pytest.approx(-4.0 * math.pi / mesh.volume, rel=1e-6)
    assert attraction.divergence(far) == pytest.approx(0.0, abs=1e-6 / mesh.volume)


@given(PLACES)
@settings(max_examples=30)
def test_many_facets_on_an_ellipsoid_draw_as_it_does(direction: FloatArray) -> None:
    assume(np.linalg.norm(direction) > 0.1)
    axes = (3.0, 2.0, 1.0)
    place = 1.3 * np.array(axes) * direction / np.linalg.norm(direction)
    fine = polyhedron_attraction(ball(4, axes), 1.0)
    exact = EllipsoidAttraction(1.0, axes)
    found, expected = fine.acceleration(place), exact.acceleration(place)
    assert np.linalg.norm(found - expected) < 5e-3 * np.linalg.norm(expected)
    assert fine.potential(place) == pytest.approx(exact.potential(place), rel=3e-3)


def test_facets_seen_from_inside_and_open_surfaces_are_refused() -> None:
    mesh = cube()
    with pytest.raises(InvalidValueError, match="counter-clockwise"):
        polyhedron_attraction(mesh._replace(facets=mesh.facets[:, ::-1]), 1.0)
    with pytest.raises(InvalidValueError, match="closed surface"):
        polyhedron_attraction(mesh._replace(facets=mesh.facets[:-1]), 1.0)
    with pytest.raises(InvalidValueError, match="once in each direction"):
        polyhedron_attraction(mesh._replace(facets=np.vstack((mesh.facets, mesh.facets[:1]))), 1.0)
    with pytest.raises(InvalidValueError, match="with an area"):
        polyhedron_attraction(mesh._replace(facets=np.array([*mesh.facets.tolist(), [0, 0, 1]])), 1.0)


def table(mesh: Mesh) -> dict[str, Any]:
    return {"kind": "polyhedron", "vertices": mesh.vertices.tolist(), "facets": mesh.facets.tolist()}


def test_a_body_s_file_may_hold_a_polyhedron() -> None:
    known = load_params("bodies", "itokawa", BodyParams).model_dump(exclude_none=True)
    mesh = ball(3, (267.5, 147.0, 104.5))
    as_mesh = BodyParams.model_validate({**known, "attraction": table(mesh)})
    as_ellipsoid = BodyParams.model_validate(known)
    site = SiteParams(latitude_deg=40.0, longitude_deg=110.0, altitude_m=5.0)
    found, expected = (body.gravity_over(site).acceleration(np.zeros(3)) for body in (as_mesh, as_ellipsoid))
    np.testing.assert_allclose(found, expected, atol=0.02 * float(np.linalg.norm(expected)))
    with pytest.raises(ValueError, match="0 to 65, the vertices"):
        BodyParams.model_validate(
            {**known, "attraction": table(ball(2, (1.0, 1.0, 1.0))) | {"facets": [(0, 1, 99)] * 4}}
        )
    with pytest.raises(ValueError, match="centre of mass"):
        BodyParams.model_validate({**known, "attraction": table(mesh._replace(vertices=mesh.vertices + 30.0))})


def potato(rounds: int) -> Mesh:
    """A body with a hollow and a nose, off its middle; it is seen whole from the origin."""
    round_one = ball(rounds, (1.0, 1.0, 1.0))
    x, y, z = round_one.vertices.T
    reach = 1.0 + 0.5 * x**3 - 0.45 * np.exp(-4.0 * ((y - 1.0) ** 2 + z**2)) + 0.2 * np.sin(3.0 * z)
    return round_one._replace(vertices=round_one.vertices * reach[:, None])


def as_points(mesh: Mesh) -> tuple[FloatArray, FloatArray]:
    """Points of mass that fill it, (n, 3), and their masses for a density of 1, (n,).

    Each facet makes a tetrahedron with the origin: 16 equal triangles of it by Gauss's points of the radius.
    """
    at, weight = np.polynomial.legendre.leggauss(12)
    at, weight = 0.5 * (at + 1.0), 0.5 * weight
    thirds = [(3 * i + 1, 3 * j + 1) for i in range(4) for j in range(4 - i)]
    thirds += [(3 * i + 2, 3 * j + 2) for i in range(3) for j in range(3 - i)]
    shares = np.array([(u, v, 12 - u - v) for u, v in thirds]) / 12.0
    on_facets = np.einsum("pc,fcx->fpx", shares, mesh.corners)
    first, second, third = np.moveaxis(mesh.corners, 1, 0)
    volumes = np.einsum("ij,ij->i", first, np.cross(second, third)) / 6.0
    points = np.einsum("fpx,r->fprx", on_facets, at)
    masses = np.einsum("f,r->fr", volumes, 3.0 * weight * at**2)[:, None, :] / 16.0
    return points.reshape(-1, 3), np.broadcast_to(masses, points.shape[:3]).reshape(-1)


@pytest.mark.parametrize("place", [(0.0, 1.1, 0.0), (2.0, 0.1, -0.3), (-0.7, -0.9, 1.0), (0.4, 0.3, -1.4)])
def test_an_irregular_body_draws_as_the_points_that_fill_it(place: tuple[float, float, float]) -> None:
    """One place is in the mouth of the hollow."""
    mesh = potato(3)
    points, masses = as_points(mesh)
    assert masses.sum() == pytest.approx(mesh.volume, rel=1e-9)
    away = points - np.array(place)
    distances = np.linalg.norm(away, axis=1)
    assert distances.min() > 0.2
    attraction = of_density_one(mesh)
    expected = (masses / distances**3) @ away
    assert np.linalg.norm(attraction.acceleration(np.array(place)) - expected) < 1e-3 * np.linalg.norm(expected)
    assert attraction.potential(np.array(place)) == pytest.approx(-float((masses / distances).sum()), rel=3e-4)
