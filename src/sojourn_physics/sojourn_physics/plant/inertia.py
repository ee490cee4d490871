"""Factors of a tree's mass matrix, and solutions with them, in the joints' own order:  M = U D Uᵀ.

U has ones on its diagonal and, above it, a number only where the column's rate moves what the row's rate carries. Found
from the last rate to the first, no number turns up where the matrix has none (Featherstone 2008, Rigid Body Dynamics
Algorithms, sec. 6.3-6.5; the order of the sums is that of Pinocchio's `cholesky`, Carpentier et al. 2019, which the
tests hold this to).

Here, and not asked of Pinocchio, since the matrix is completed, factorised and used between two kernels: each call over
the border of Python would cost as much as the factorisation.
"""

from typing import NamedTuple

from sojourn_machine.kernels import kernel
from sojourn_machine.params import FloatArray, IntArray


class Factors(NamedTuple):
    """Of a mass matrix, with the tree that it belongs to."""

    parents: IntArray
    """(nv,): the rate before each on its way to the root; -1 for the first."""
    sizes: IntArray
    """(nv,): rates from each on to the end of what it carries, itself included."""
    upper: FloatArray
    """U, (nv, nv)."""
    diagonal: FloatArray
    """D, (nv,)."""
    scaled: FloatArray
    """(nv,): of a row, times D."""


@kernel
def factorise(matrix: FloatArray, factors: Factors) -> None:
    """Write U and D of M, (nv, nv), of which the upper triangle counts."""
    upper, diagonal, scaled = factors.upper, factors.diagonal, factors.scaled
    for j in range(diagonal.shape[0] - 1, -1, -1):
        end = j + factors.sizes[j]
        taken = 0.0
        for k in range(j + 1, end):
            scaled[k] = upper[j, k] * diagonal[k]
            taken += upper[j, k] * scaled[k]
        diagonal[j] = matrix[j, j] - taken
        inverse = 1.0 / diagonal[j]
        i = factors.parents[j]
        while i >= 0:
            taken = 0.0
            for k in range(j + 1, end):
                taken += upper[i, k] * scaled[k]
            upper[i, j] = (matrix[i, j] - taken) * inverse
            i = factors.parents[i]


@kernel
def solve(factors: Factors, vector: FloatArray) -> None:
    """Put M⁻¹ v in the place of v, (nv,)."""
    upper, diagonal, sizes = factors.upper, factors.diagonal, factors.sizes
    count = diagonal.shape[0]
    for i in range(count - 2, -1, -1):
        taken = 0.0
        for k in range(i + 1, i + sizes[i]):
            taken += upper[i, k] * vector[k]
        vector[i] -= taken
    for i in range(count):
        vector[i] *= 1.0 / diagonal[i]
    for i in range(count - 1):
        for k in range(i + 1, i + sizes[i]):
            vector[k] -= upper[i, k] * vector[i]
