"""What the plant tells of the ground: what is new, and all of it after all messages."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_contract.codecs import decode, encode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.ground import GROUND, ground_cloud, with_ground
from sojourn_physics.terrain.memory import GroundMemory
from sojourn_physics.terrain.memory_tiles import CHANNELS, DUG, RUT, SHEAR, TILE, Tile

KEYS = st.lists(st.tuples(st.integers(0, 40), st.integers(0, 40)), max_size=4, unique=True)


def tile(seed: int, part: float = 0.1) -> Tile:
    random = np.random.default_rng(seed)
    numbers = random.uniform(0.0, 0.1, (TILE, TILE, CHANNELS)).astype(np.float32)
    numbers[random.random((TILE, TILE)) > part] = 0.0
    numbers[:, :, DUG] -= 0.5 * numbers[:, :, RUT]
    return numbers


def lowered(memory: GroundMemory) -> dict[tuple[int, int], np.ndarray]:
    found = {key: one[:, :, RUT] + one[:, :, DUG] for key, one in memory.tiles.items()}
    return {key: one for key, one in found.items() if one.any()}


@settings(max_examples=40)
@given(st.lists(KEYS, max_size=4), st.floats(-500.0, 500.0), st.sampled_from((0.01, 0.025, 0.1)))
def test_who_hears_all_messages_knows_the_ground(
    steps: list[list[tuple[int, int]]], origin: float, cell: float
) -> None:
    start = GroundMemory(cell, origin, -origin)
    truth, heard = start, start
    for number, keys in enumerate(steps):
        after = GroundMemory(
            cell,
            origin,
            -origin,
            {**truth.tiles, **{key: tile(1 + 50 * number + key[0] + 2500 * key[1]) for key in keys}},
        )
        cloud = decode(GROUND, encode(GROUND, ground_cloud(1000, truth, after)))
        heard, truth = with_ground(heard, cloud), after
    expected, found = lowered(truth), lowered(heard)
    assert expected.keys() == found.keys()
    assert all(np.array_equal(expected[key], found[key]) for key in expected)


def test_only_what_is_new_is_told() -> None:
    memory = GroundMemory(0.025, 0.0, 0.0, {(1, 2): tile(1), (3, 3): tile(2)})
    assert ground_cloud(0, memory, memory).width == 0
    changed = memory.tiles[(1, 2)].copy()
    changed[4, 7, RUT] += 0.5
    changed[9, 9, SHEAR] += 0.5  # which is not to be seen
    after = GroundMemory(0.025, 0.0, 0.0, {**memory.tiles, (1, 2): changed})
    cloud = ground_cloud(0, memory, after)
    x, y, _ = np.frombuffer(cloud.data, dtype="<f4")
    assert cloud.width == 1
    assert (x, y) == pytest.approx(((TILE + 7) * 0.025, (2 * TILE + 4) * 0.025))


@pytest.mark.parametrize("value", [np.nan, np.inf, -1e7])
@pytest.mark.parametrize("place", [0, 1, 2])
def test_numbers_that_no_ground_has_are_refused(value: float, place: int) -> None:
    start = GroundMemory(0.025, 0.0, 0.0)
    cloud = ground_cloud(0, start, GroundMemory(0.025, 0.0, 0.0, {(0, 0): tile(1)}))
    points = np.frombuffer(cloud.data, dtype="<f4").copy().reshape(-1, 3)
    points[1, place] = value
    with pytest.raises(RefusedMessageError, match="/truth/ground"):
        with_ground(start, cloud._replace(data=points.tobytes()))


def test_ground_that_remembers_nothing_stays_as_it_is() -> None:
    start = GroundMemory(0.0, 0.0, 0.0)
    cloud = ground_cloud(0, GroundMemory(0.025, 0.0, 0.0), GroundMemory(0.025, 0.0, 0.0, {(0, 0): tile(1)}))
    assert with_ground(start, cloud) is start
