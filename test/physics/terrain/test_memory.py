"""The ground's memory: what is written is read back, values stay values, tiles join without a seam."""

import copy
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_physics.terrain.memory import GroundMemory, MemoryBoard, MemoryFullError
from sojourn_physics.terrain.memory_access import Patch, Trace, read_ground, write_ground
from sojourn_physics.terrain.memory_tiles import DUG, RUT, SPARE_PAGES, TILE

CELL = 0.025
EMPTY = GroundMemory(CELL, -10.0, -10.0)
inside = st.floats(-8.0, 8.0)
turns = st.floats(-np.pi, np.pi)


def write(
    board: MemoryBoard, x: float, y: float, heading: float, width: float, depth: float, beside: float = 0.0
) -> None:
    line = Patch(x, y, np.cos(heading), np.sin(heading), 0.0, width)
    write_ground(board.tables, line, Trace(depth, 0.9 * depth, 0.5 * depth, beside))


def read(board: MemoryBoard, x: float, y: float, heading: float, length: float, width: float) -> np.ndarray:
    """Over the rectangle about (x, y)."""
    return np.array(read_ground(board.tables, Patch(x, y, np.cos(heading), np.sin(heading), length, width)))


def roll(board: MemoryBoard, x: float, y: float, heading: float, length: float, width: float, depth: float) -> None:
    for s in np.arange(0.0, length, 0.2 * CELL):
        write(board, x + s * np.cos(heading), y + s * np.sin(heading), heading, width, depth)


@settings(max_examples=40, deadline=None)
@given(inside, inside, turns)
def test_a_wheel_that_follows_meets_the_whole_rut(x: float, y: float, heading: float) -> None:
    """Also across the seams of tiles, in any direction."""
    board = MemoryBoard(EMPTY)
    roll(board, x, y, heading, 1.5, 0.2, 0.01)
    middle = x + 0.7 * np.cos(heading), y + 0.7 * np.sin(heading)
    # a narrower wheel, wholly inside what was written
    sinkage, rut, dug, slope_x, slope_y = read(board, *middle, heading, 0.1, 0.2 - 3.0 * CELL)
    assert sinkage == pytest.approx(0.01, rel=1e-6) and rut == pytest.approx(0.009, rel=1e-6)
    assert dug == 0.0
    assert slope_x == pytest.approx(0.0, abs=1e-6) and slope_y == pytest.approx(0.0, abs=1e-6)
    aside = middle[0] - 0.5 * np.sin(heading), middle[1] + 0.5 * np.cos(heading)
    assert not read(board, *aside, heading, 0.1, 0.2).any()


@settings(max_examples=40, deadline=None)
@given(inside, inside, turns)
def test_slope_is_the_derivative_of_the_rut(x: float, y: float, heading: float) -> None:
    board = MemoryBoard(EMPTY)
    roll(board, 0.0, 0.0, 0.4, 2.0, 0.15, 0.02)
    x, y = 0.2 * x, 0.2 * y
    step = 1e-7
    _, _, _, slope_x, slope_y = read(board, x, y, heading, 0.12, 0.15)
    by_x = (read(board, x + step, y, heading, 0.12, 0.15) - read(board, x - step, y, heading, 0.12, 0.15))[1]
    by_y = (read(board, x, y + step, heading, 0.12, 0.15) - read(board, x, y - step, heading, 0.12, 0.15))[1]
    assert by_x / (2 * step) == pytest.approx(slope_x, abs=1e-6)
    assert by_y / (2 * step) == pytest.approx(slope_y, abs=1e-6)


@settings(max_examples=40, deadline=None)
@given(st.floats(-0.5, 2.0), st.floats(-0.3, 1.0), turns)
def test_slope_is_continuous(x: float, y: float, heading: float) -> None:
    board = MemoryBoard(EMPTY)
    roll(board, 0.0, 0.0, 0.4, 2.0, 0.15, 0.02)
    here = read(board, x, y, heading, 0.12, 0.15)
    for dx, dy, turn in ((1e-6, 0.0, 0.0), (0.0, 1e-6, 0.0), (0.0, 0.0, 1e-6)):
        there = read(board, x + dx, y + dy, heading + turn, 0.12 + 1e-6, 0.15)
        assert here == pytest.approx(there, abs=1e-4)


def test_only_the_greatest_counts_whatever_the_order() -> None:
    boards = [MemoryBoard(EMPTY) for _ in range(2)]
    for board, depths in zip(boards, ([0.02, 0.01], [0.01, 0.02]), strict=True):
        for depth in depths:
            roll(board, 0.0, 0.0, 0.0, 0.5, 0.15, depth)
    first, second = (board.store() for board in boards)
    assert first.sample(0.2, 0.0) == second.sample(0.2, 0.0)
    assert first.sample(0.2, 0.0) == pytest.approx((0.02, 0.018, 0.01), rel=1e-6)


def test_the_mean_over_a_wheel_half_in_a_rut() -> None:
    board = MemoryBoard(EMPTY)
    roll(board, 0.0, 0.0, 0.0, 1.0, 0.4, 0.01)
    half_in = read(board, 0.5, 0.2, 0.0, 0.1, 0.4)
    assert half_in[0] == pytest.approx(0.005, rel=0.15)
    assert half_in[3] < 0.0  # the rut is deeper to the right


def test_a_memory_is_a_value() -> None:
    board = MemoryBoard(EMPTY)
    roll(board, 0.0, 0.0, 0.0, 0.5, 0.15, 0.01)
    first = board.store()
    kept = {key: tile.copy() for key, tile in first.tiles.items()}
    assert board.store() is first  # nothing has changed since
    roll(board, 0.0, 0.0, 0.0, 0.5, 0.15, 0.03)
    roll(board, 5.0, 5.0, 0.0, 0.5, 0.15, 0.01)
    second = board.store()
    assert all(np.array_equal(first.tiles[key], kept[key]) for key in kept)
    assert first.sample(0.2, 0.0)[0] == pytest.approx(0.01) and second.sample(0.2, 0.0)[0] == pytest.approx(0.03)
    with pytest.raises(ValueError):
        next(iter(second.tiles.values()))[0, 0, 0] = 1.0
    for twin in (copy.deepcopy(second), pickle.loads(pickle.dumps(second))):
        assert twin.sample(5.2, 5.0) == second.sample(5.2, 5.0)


def test_a_step_copies_only_what_it_changes() -> None:
    board = MemoryBoard(EMPTY)
    for y in np.arange(-8.0, 8.0, 1.0):
        roll(board, 0.0, y, 0.0, 0.5, 0.15, 0.01)
    first = board.store()
    write(board, 0.2, 3.0, 0.0, 0.15, 0.02)
    second = board.store()
    changed = [key for key in second.tiles if second.tiles[key] is not first.tiles.get(key)]
    assert len(first.tiles) >= 16 and 1 <= len(changed) <= 2


def test_going_back_to_an_older_memory() -> None:
    board = MemoryBoard(EMPTY)
    roll(board, 0.0, 0.0, 0.0, 0.5, 0.15, 0.01)
    old = board.store()
    roll(board, 0.0, 0.0, 0.0, 0.5, 0.15, 0.05)
    board.store()
    board.load(old)
    assert read(board, 0.2, 0.0, 0.0, 0.05, 0.05)[0] == pytest.approx(0.01)
    board.load(EMPTY)
    assert not read(board, 0.2, 0.0, 0.0, 0.05, 0.05).any()


def test_what_an_abandoned_step_has_written_is_gone() -> None:
    """A step that raises an error never stores; the state before it is as good as before."""
    board = MemoryBoard(EMPTY)
    roll(board, 0.0, 0.0, 0.0, 0.5, 0.15, 0.01)
    before = board.store()
    roll(board, 0.0, 0.0, 0.0, 0.5, 0.15, 0.05)
    board.load(before)
    assert read(board, 0.2, 0.0, 0.0, 0.05, 0.05)[0] == pytest.approx(0.01)
    assert board.store() is before


def test_room_grows_with_the_drive_and_nothing_is_lost() -> None:
    board = MemoryBoard(EMPTY)
    memory = EMPTY
    for column in range(2 * SPARE_PAGES):  # far more tiles than a board has room for at first
        board.load(memory)
        write(board, -9.9 + 0.05 * column, -9.0 + TILE * CELL * (column % 20), 0.0, 0.1, 0.01)
        memory = board.store()
    assert len(memory.tiles) > 2 * SPARE_PAGES // 2
    last = 2 * SPARE_PAGES - 1
    assert memory.sample(-9.92 + 0.05 * last, -9.0 + TILE * CELL * (last % 20))[0] > 0.0
    assert memory.sample(-9.92, -9.0)[0] > 0.0


def test_a_period_that_touches_too_much_is_told_and_leaves_the_memory_as_it_was() -> None:
    wide = GroundMemory(CELL, 0.0, 0.0)
    board = MemoryBoard(wide)
    for column in range(4 * SPARE_PAGES):
        write(board, 1.0 + column, 1.0, 0.0, 0.1, 0.01)
    with pytest.raises(MemoryFullError, match="128 new tiles"):
        board.store()
    assert board.store() is wide and not read(board, 1.0, 1.0, 0.0, 0.05, 0.05).any()


@pytest.mark.parametrize("x", [float("nan"), float("inf"), -float("inf"), 1e300, -50.0])
def test_points_off_the_map_have_no_memory(x: float) -> None:
    board = MemoryBoard(EMPTY)
    write(board, x, 0.0, 0.0, 0.1, 0.01)
    assert not read(board, x, 0.0, 0.0, 0.1, 0.1).any()
    assert not board.store().tiles


def test_grid_reads_what_sample_reads() -> None:
    board = MemoryBoard(EMPTY)
    roll(board, -0.3, -0.2, 0.7, 2.0, 0.15, 0.02)
    memory = board.store()
    x, y = np.linspace(-1.0, 2.0, 31), np.linspace(-1.0, 2.0, 23)
    values = memory.grid(x, y)
    assert values.shape == (23, 31, 4) and values[..., RUT].max() == pytest.approx(0.018, rel=1e-3)
    for i, j in ((4, 7), (11, 13), (15, 18)):
        assert tuple(values[i, j, :DUG]) == pytest.approx(memory.sample(x[j], y[i]), abs=1e-12)
    assert len(list(memory.touched())) == len(memory.tiles)


@settings(max_examples=30, deadline=None)
@given(inside, inside, turns, st.floats(0.03, 0.3), st.floats(0.05, 1.0))
def test_soil_pressed_aside_is_found_beside_the_rut(
    x: float, y: float, heading: float, width: float, beside: float
) -> None:
    """Whatever the direction, and however often the rut is deepened, the banks have their part of its volume."""
    board = MemoryBoard(EMPTY)
    for depth in (0.004, 0.01):
        for s in np.arange(0.0, 0.8, 0.3 * CELL):
            write(board, x + s * np.cos(heading), y + s * np.sin(heading), heading, width, depth, beside)
        tiles = [tile for _, _, tile in board.store().touched()]
        ruts = sum(float(tile[..., RUT].sum(dtype=np.float64)) for tile in tiles)
        banks = -sum(float(tile[..., DUG].sum(dtype=np.float64)) for tile in tiles)
        assert banks == pytest.approx(beside * ruts, rel=1e-4)
    # a wheel that follows meets the rut and no bank; one beside it stands higher
    middle = x + 0.4 * np.cos(heading), y + 0.4 * np.sin(heading)
    assert read(board, *middle, heading, 0.1, width)[2] == pytest.approx(0.0, abs=1e-9)
    aside = max(0.5 * width, CELL) + CELL
    bank = read(board, middle[0] - aside * np.sin(heading), middle[1] + aside * np.cos(heading), heading, 0.1, CELL)
    assert bank[2] < 0.0


def test_a_rut_that_is_run_over_again_as_deep_heaps_nothing_up() -> None:
    board = MemoryBoard(EMPTY)
    write(board, 0.0, 0.0, 0.3, 0.2, 0.01, 0.4)
    once = board.store()
    write(board, 0.0, 0.0, 0.3, 0.2, 0.01, 0.4)
    write(board, 0.0, 0.0, 0.3, 0.2, 0.008, 0.4)
    assert board.store() is once
