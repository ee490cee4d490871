"""Soil cut and heaped: nothing is lost, walls stand, heaps lie at their angle of repose."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_physics.terrain.earthwork import cut, heap
from sojourn_physics.terrain.height_field import HeightField
from sojourn_physics.terrain.memory import GroundMemory, MemoryBoard
from sojourn_physics.terrain.memory_access import read_lowered
from sojourn_physics.terrain.memory_tiles import DUG

CELL = 0.01
SLOPE = math.tan(math.radians(35.0))
places = st.floats(-0.4, 0.4)
depths = st.floats(0.001, 0.08)
turns = st.floats(-math.pi, math.pi)


def ground(gradient: tuple[float, float] = (0.0, 0.0)) -> HeightField:
    x, y = np.meshgrid(np.linspace(-2.0, 2.0, 41), np.linspace(-2.0, 2.0, 41))
    heights = gradient[0] * x + gradient[1] * y
    return HeightField(heights, np.zeros(heights.shape, np.uint8), 0.1, -2.0, -2.0, ("soil",))


def board_of(cell: float = CELL) -> MemoryBoard:
    return MemoryBoard(GroundMemory(cell, -2.0, -2.0))


def removed(board: MemoryBoard) -> float:
    """Volume that lacks on the whole board [m3], counted in double precision from what is stored."""
    memory = board.store()
    return math.fsum(float(tile[..., DUG].astype(np.float64).sum()) for tile in memory.tiles.values()) * memory.cell**2


@settings(max_examples=60, deadline=None)
@given(places, places, turns, depths, st.floats(0.02, 0.15), st.floats(0.02, 0.3))
def test_what_a_cut_takes_lacks_on_the_ground(
    x: float, y: float, heading: float, d: float, w: float, length: float
) -> None:
    terrain, board = ground((0.2 * math.cos(heading), 0.2 * math.sin(heading))), board_of()
    begin = np.array([x, y, terrain.height(x, y) - d])
    end = begin + np.array([length * math.cos(heading), length * math.sin(heading), 0.0])
    end[2] = terrain.height(end[0], end[1]) - d
    volume = cut(board, terrain, terrain.grid, begin, end, w)
    assert volume == pytest.approx(removed(board), rel=1e-12, abs=1e-18)
    # against the body that the blade sweeps on a plane: no further off than half a cell at each of its edges
    assert volume == pytest.approx(length * w * d, abs=d * (CELL * (length + w) + CELL**2) + 1e-9)
    # its edge is where the blade went
    middle = 0.5 * (begin + end)
    inside = min(length, w) > 4.0 * CELL
    if inside:
        lowered = read_lowered(board.tables, middle[0], middle[1])
        assert terrain.height(middle[0], middle[1]) - lowered == pytest.approx(middle[2], abs=1e-6)
    assert cut(board, terrain, terrain.grid, begin, end, w) == pytest.approx(0.0, abs=1e-12), "there is nothing left"


def test_a_furrow_along_the_grid_is_exact_and_pieces_make_the_whole() -> None:
    terrain, whole, pieces = ground(), board_of(), board_of()
    begin, end = np.array([0.003, 0.002, -0.02]), np.array([0.203, 0.002, -0.02])
    volume = cut(whole, terrain, terrain.grid, begin, end, 0.06)
    assert volume == pytest.approx(0.2 * 0.06 * 0.02, rel=1e-6)
    way = np.linspace(begin, end, 788)
    parts = [cut(pieces, terrain, terrain.grid, a, b, 0.06) for a, b in itertools.pairwise(way)]
    assert math.fsum(parts) == pytest.approx(volume, rel=1e-9)


@settings(max_examples=60, deadline=None)
@given(places, places, st.floats(1e-7, 3e-3), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_a_heap_holds_what_fell(x: float, y: float, volume: float, gx: float, gy: float) -> None:
    terrain, board = ground((gx, gy)), board_of()
    put = heap(board, terrain, terrain.grid, x, y, volume, SLOPE)
    assert put == pytest.approx(-removed(board), rel=1e-12)
    assert 0.0 <= volume - put <= 1e-9 * volume + 1e-11  # the rest is the rounding of its nodes
    # nowhere steeper than it may be: along the grid and across it
    places = CELL * np.arange(-60, 61)
    dug = board.store().grid(places, places)[..., DUG]
    nodes = gx * places[np.newaxis, :] + gy * places[:, np.newaxis] - dug
    added = dug < 0.0
    for axis in (0, 1):
        both = np.logical_and(added.take(range(120), axis), added.take(range(1, 121), axis))
        steps = np.abs(np.diff(nodes, axis=axis))[both]
        assert (steps <= SLOPE * CELL * (1.0 + 1e-5) + 1e-6).all()


def test_a_heap_on_level_ground_is_the_cone_of_its_volume() -> None:
    terrain, board = ground(), board_of(0.005)
    volume = 1e-3
    heap(board, terrain, terrain.grid, 0.0, 0.0, volume, SLOPE)
    radius = (3.0 * volume / (math.pi * SLOPE)) ** (1.0 / 3.0)
    assert -read_lowered(board.tables, 0.0, 0.0) == pytest.approx(radius * SLOPE, rel=0.01)
    assert -read_lowered(board.tables, 0.5 * radius, 0.0) == pytest.approx(0.5 * radius * SLOPE, rel=0.03)


def test_soil_that_falls_back_fills_the_trench_first() -> None:
    terrain, board = ground(), board_of()
    volume = cut(board, terrain, terrain.grid, np.array([0.0, 0.0, -0.03]), np.array([0.1, 0.0, -0.03]), 0.06)
    put = heap(board, terrain, terrain.grid, 0.05, 0.0, 0.5 * volume, SLOPE)
    assert removed(board) == pytest.approx(volume - put, rel=1e-12)
    memory = board.store()
    assert all(tile[..., DUG].min() >= -0.03 for tile in memory.tiles.values())
    assert memory.lowered(0.05, 0.0) < 0.03


def test_ground_that_remembers_nothing_is_not_changed() -> None:
    terrain, board = ground(), board_of(0.0)
    assert cut(board, terrain, terrain.grid, np.array([0.0, 0.0, -0.1]), np.array([0.1, 0.0, -0.1]), 0.1) == 0.0
    assert heap(board, terrain, terrain.grid, 0.0, 0.0, 1e-3, SLOPE) == 0.0


def test_nothing_is_lost_in_ground_that_is_dug_again_and_again() -> None:
    """What is put down where soil was taken counts as it is stored: in double precision, although that is single."""
    terrain, board = ground(), board_of()
    generator, balance = np.random.default_rng(1), 0.0
    for _ in range(40):
        begin = np.array([*generator.uniform(-0.2, 0.2, 2), -generator.uniform(0.005, 0.03)])
        end = begin + np.array([*generator.uniform(-0.1, 0.1, 2), 0.0])
        volume = cut(board, terrain, terrain.grid, begin, end, 0.06)
        put = heap(board, terrain, terrain.grid, *generator.uniform(-0.2, 0.2, 2), 0.7 * volume, SLOPE)
        assert 0.0 <= 0.7 * volume - put < 1e-11
        balance += volume - put
        assert removed(board) == pytest.approx(balance, abs=1e-17)
