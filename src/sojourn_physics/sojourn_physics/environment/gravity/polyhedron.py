"""Attraction of a polyhedron of constant density, exact for any closed surface of triangles.

    U  = -G rho/2 [sum_e L_e r_e . E_e r_e - sum_f w_f r_f . F_f r_f]
    g  = -G rho [sum_e L_e E_e r_e - sum_f w_f F_f r_f]
    div g = -G rho sum_f w_f                    (-4 pi G rho inside, 0 outside)

over edges e and facets f, r_e and r_f from the place to any point of each, with

    E_e = n_A n_eA^T + n_B n_eB^T,    F_f = n n^T,    L_e = ln((r_1 + r_2 + l)/(r_1 + r_2 - l)),
    w_f = 2 atan2(r_1 . (r_2 x r_3), r_1 r_2 r_3 + r_1 (r_2 . r_3) + r_2 (r_3 . r_1) + r_3 (r_1 . r_2)),

n the outward normal of a facet, n_e the normal of its edge in its plane, away from it: Werner & Scheeres (1997),
Celestial Mechanics and Dynamical Astronomy 65:313, eq. 10 to 17. G rho is GM over the volume.

Range: everywhere; on an edge itself, where L is infinite and what it multiplies is zero, the edge is left out. Cost
grows with the number of facets.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray, IntArray
from sojourn_physics.environment.gravity.attraction import AttractionParams

if TYPE_CHECKING:
    from sojourn_physics.environment.body import BodyParams

ON_EDGE = 1e-14
"""A place so near to an edge, over its length, is on it [1]."""
CENTRED = 0.01
"""The centre of mass is this near to the origin, over the size of the body [1]."""


class Mesh(NamedTuple):
    """A closed surface of triangles, seen from outside counter-clockwise."""

    vertices: FloatArray
    """(vertices, 3) [m]."""
    facets: IntArray
    """(facets, 3) rows of `vertices`."""

    @property
    def corners(self) -> FloatArray:
        """(facets, 3, 3) [m]: facet, corner, axis."""
        found: FloatArray = self.vertices[self.facets]
        return found

    @property
    def volume(self) -> float:
        """By the theorem of Gauss [m^3]; negative where the facets are seen from inside."""
        first, second, third = np.moveaxis(self.corners, 1, 0)
        return float(np.einsum("ij,ij->", first, np.cross(second, third))) / 6.0

    @property
    def centroid(self) -> FloatArray:
        """Centre of mass, (3,) [m]."""
        first, second, third = np.moveaxis(self.corners, 1, 0)
        volumes = np.einsum("ij,ij->i", first, np.cross(second, third))
        found: FloatArray = volumes @ (first + second + third) / (4.0 * volumes.sum())
        return found


@dataclass(frozen=True, slots=True)
class PolyhedronAttraction:
    """See the head of this module. Built by `polyhedron_attraction`."""

    strength: float
    """G rho [1/s^2]."""
    corners: FloatArray
    """(facets, 3, 3) [m]."""
    facet_dyads: FloatArray
    """F, (facets, 3, 3)."""
    edges: FloatArray
    """(edges, 2, 3) [m]: edge, end, axis."""
    lengths: FloatArray
    """(edges,) [m]"""
    edge_dyads: FloatArray
    """E, (edges, 3, 3)."""

    def acceleration(self, position: FloatArray) -> FloatArray:
        """Shape (3,) [m/s^2]."""
        edge_pulls, facet_pulls = self._pulls(position)
        found: FloatArray = self.strength * (facet_pulls.sum(axis=0) - edge_pulls.sum(axis=0))
        return found

    def potential(self, position: FloatArray) -> float:
        """[J/kg]."""
        edge_pulls, facet_pulls = self._pulls(position)
        edge = np.einsum("ij,ij->", self.edges[:, 0] - position, edge_pulls)
        facet = np.einsum("ij,ij->", self.corners[:, 0] - position, facet_pulls)
        return float(-0.5 * self.strength * (edge - facet))

    def divergence(self, position: FloatArray) -> float:
        """Of the acceleration [1/s^2]: minus 4 pi G times the density there."""
        return float(-self.strength * self._solid_angles(self.corners - position).sum())

    def _pulls(self, position: FloatArray) -> tuple[FloatArray, FloatArray]:
        """L E r of each edge and w F r of each facet, (edges, 3) and (facets, 3) [m]."""
        ends, corners = self.edges - position, self.corners - position
        distances = np.linalg.norm(ends, axis=2).sum(axis=1)
        apart = distances - self.lengths
        on = apart <= ON_EDGE * self.lengths
        logarithms = np.where(on, 0.0, np.log((distances + self.lengths) / np.where(on, 1.0, apart)))
        edge_pulls = logarithms[:, None] * np.einsum("ijk,ik->ij", self.edge_dyads, ends[:, 0])
        angles = self._solid_angles(corners)
        return edge_pulls, angles[:, None] * np.einsum("ijk,ik->ij", self.facet_dyads, corners[:, 0])

    def _solid_angles(self, corners: FloatArray) -> FloatArray:
        """w of each facet, (facets,) [sr], positive seen from inside."""
        first, second, third = np.moveaxis(corners, 1, 0)
        r1, r2, r3 = np.linalg.norm(corners, axis=2).T
        across = np.einsum("ij,ij->i", first, np.cross(second, third))
        along = r1 * r2 * r3 + r1 * _dot(second, third) + r2 * _dot(third, first) + r3 * _dot(first, second)
        found: FloatArray = 2.0 * np.arctan2(across, along)
        return found


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    found: FloatArray = np.einsum("ij,ij->i", a, b)
    return found


def polyhedron_attraction(mesh: Mesh, gravitational_parameter: float) -> PolyhedronAttraction:
    """Of a closed mesh with a GM [m^3/s^2].

    Raises:
        InvalidValueError: a surface that is not closed, or whose facets are seen from inside.
    """
    corners = mesh.corners
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1, keepdims=True)
    if not (areas > 0.0).all():
        raise InvalidValueError("facets", mesh.facets[int(np.argmin(areas))].tolist(), "triangles with an area")
    normals /= areas
    starts, stops = mesh.facets, np.roll(mesh.facets, -1, axis=1)
    sides: dict[tuple[int, int], FloatArray] = {}
    for facet, (begins, ends) in enumerate(zip(starts.tolist(), stops.tolist(), strict=True)):
        for start, stop in zip(begins, ends, strict=True):
            if (start, stop) in sides:
                raise InvalidValueError("facets", (start, stop), "each edge in two facets, once in each direction")
            along = mesh.vertices[stop] - mesh.vertices[start]
            aside = np.cross(along, normals[facet]) / np.linalg.norm(along)
            sides[start, stop] = np.outer(normals[facet], aside)
    for start, stop in sides:
        if (stop, start) not in sides:
            raise InvalidValueError("facets", (start, stop), "a closed surface: this edge is in one facet alone")
    pairs = [pair for pair in sides if pair[0] < pair[1]]
    edges = np.array([(mesh.vertices[start], mesh.vertices[stop]) for start, stop in pairs])
    volume = mesh.volume
    if not volume > 0.0:
        raise InvalidValueError("facets", volume, "a volume above 0: their corners counter-clockwise from outside")
    return PolyhedronAttraction(
        strength=gravitational_parameter / volume,
        corners=corners,
        facet_dyads=np.einsum("ij,ik->ijk", normals, normals),
        edges=edges,
        lengths=np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1),
        edge_dyads=np.array([sides[pair] + sides[pair[::-1]] for pair in pairs]),
    )


class PolyhedronParams(AttractionParams):
    """A body as a closed surface of triangles, filled evenly."""

    kind: Literal["polyhedron"] = Field(default="polyhedron", description="this kind")
    vertices: tuple[tuple[float, float, float], ...] = Field(min_length=4, description="in the body's frame [m]")
    facets: tuple[tuple[int, int, int], ...] = Field(
        min_length=4, description="three vertices each, counted from 0, counter-clockwise from outside"
    )

    @model_validator(mode="after")
    def _is_a_body(self) -> Self:
        highest = max(max(facet) for facet in self.facets)
        if highest >= len(self.vertices) or min(min(facet) for facet in self.facets) < 0:
            raise InvalidValueError("facets", highest, f"0 to {len(self.vertices) - 1}, the vertices that there are")
        mesh = self.mesh
        polyhedron_attraction(mesh, 1.0)
        size, off = float(np.ptp(mesh.vertices, axis=0).max()), float(np.linalg.norm(mesh.centroid))
        if off > CENTRED * size:
            allowed = f"a centre of mass within {CENTRED * size:.3g} m of 0"
            raise InvalidValueError("vertices", mesh.centroid.tolist(), allowed)
        return self

    @property
    def mesh(self) -> Mesh:
        """Of these vertices and facets."""
        return Mesh(np.array(self.vertices, dtype=float), np.array(self.facets, dtype=np.int64))

    def build(self, body: "BodyParams") -> PolyhedronAttraction:
        """Of a body of this shape."""
        return polyhedron_attraction(self.mesh, body.gravitational_parameter)
