"""The mass matrix's factors: against the matrix they come from, and against Pinocchio's."""

from functools import cache

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.scenario import load_scenario
from sojourn_physics.plant.inertia import factorise, solve
from sojourn_physics.plant.model import PlantModel
from sojourn_plant.start import build_plant

SCENARIOS = ("flat_drive", "lrv_course", "puma560_course")


@cache
def machine(scenario: str) -> PlantModel:
    return build_plant(load_scenario(scenario))[0]


@pytest.mark.parametrize("scenario", SCENARIOS)
@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_factors_are_those_of_the_mass_matrix(scenario: str, seed: int) -> None:
    """In any posture, with any inertia of the joints' own on the diagonal."""
    model = machine(scenario)
    multibody, data, factors = model.multibody, model.data, model.work.tables.multibody.factors
    generator = np.random.default_rng(seed)
    posture = pin.integrate(multibody, pin.neutral(multibody), generator.uniform(-1.0, 1.0, multibody.nv))
    pin.crba(multibody, data, posture, pin.Convention.WORLD)
    diagonal = np.arange(multibody.nv)
    data.M[diagonal, diagonal] += generator.uniform(0.0, 2.0, multibody.nv)
    matrix = np.triu(data.M) + np.triu(data.M, 1).T
    factorise(data.M, factors)
    np.testing.assert_allclose(
        factors.upper @ np.diag(factors.diagonal) @ factors.upper.T, matrix, atol=1e-12 * np.abs(matrix).max()
    )
    wanted = generator.uniform(-1.0, 1.0, multibody.nv)
    found = matrix @ wanted
    solve(factors, found)
    np.testing.assert_allclose(found, wanted, atol=1e-14 * np.linalg.cond(matrix))
    pin.cholesky.decompose(multibody, data)
    theirs = pin.cholesky.solve(multibody, data, matrix @ wanted)
    np.testing.assert_allclose(found, theirs, rtol=1e-10, atol=1e-10 * np.abs(theirs).max())


def test_factors_are_as_sparse_as_the_tree() -> None:
    """What belongs to another branch stays out: the work grows with the depth of the tree, not with its size."""
    model = machine("flat_drive")
    multibody, factors = model.multibody, model.work.tables.multibody.factors
    pin.crba(multibody, model.data, pin.neutral(multibody), pin.Convention.WORLD)
    factorise(model.data.M, factors)
    for row in range(multibody.nv):
        outside = np.ones(multibody.nv, dtype=bool)
        outside[: row + factors.sizes[row]] = False
        assert not factors.upper[row, outside].any()
        assert not factors.upper[row, :row].any()
