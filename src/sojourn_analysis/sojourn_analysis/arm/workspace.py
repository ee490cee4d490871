"""Where the tip of an arm can be, and what the arm is worth there, from evenly spread postures.

Postures are the points of a low-discrepancy sequence over the joint ranges (see inverse_search.spread): the same map
every time. The map is a section: distance from the first joint's axis against height along it, if that joint turns
(the workspace is the section turned about the axis, within its range), else x against z of the base. In each cell:

    pointing    share of the sphere of tool directions that some posture has there, of `DIRECTIONS` equal patches:
                dexterous where it is 1 (reachable and dexterous workspace: Kumar & Waldron, ASME J. Mech. Design 1981).
                Of an arm whose tool points one way whatever it does: share of the turns about the tool, of as many
    manipulability   largest of the postures there (Yoshikawa)
    force       largest over the postures of the force that can be given in the worst of six directions [N]; of an arm
                that cannot hold itself under this gravity, what it could give without weight
    payload     largest mass that some posture there can hold at rest [kg]
Collisions are not looked at. A map of samples: a cell without any may yet be reached near the rim.
"""

from dataclasses import dataclass

import numpy as np

from sojourn_flight.arm.chain import Chain, tip_kinematics
from sojourn_flight.arm.dynamics import gravity_effort
from sojourn_flight.arm.inverse_search import spread
from sojourn_flight.arm.serial_arm import SerialArm
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray, IntArray

BANDS, SECTORS = 6, 8
DIRECTIONS = BANDS * SECTORS + 2
"""Patches of the sphere, of equal area: two caps, and bands of equal height between them, cut into sectors."""
_HARDLY = 0.01
"""Share of the postures below which an arm counts as one that cannot hold itself."""
_ONE_WAY = 1.0e-6
_CAP = 1.0 - 2.0 / DIRECTIONS
"""Height above which a direction is in a cap."""


@dataclass(frozen=True, slots=True, eq=False)
class WorkspaceMap:
    """Maps over a section; arrays (rows, columns), rows along the height, NaN where no posture was found."""

    across: FloatArray  # edges of the columns (columns + 1,) [m]
    height: FloatArray  # edges of the rows (rows + 1,) [m]
    about_axis: bool  # across is the distance from the first joint's axis, or else x
    pointing: FloatArray  # [-]
    one_way: bool  # the tool points one way: pointing is of the turns about it
    manipulability: FloatArray
    force: FloatArray  # [N]
    weightless: bool  # the force is without weight: the arm cannot hold itself
    payload: FloatArray | None  # [kg]; None without weight
    tips: FloatArray  # some tip positions in the base (m, 3) [m]
    reach_from_axis: float  # largest distance from the first axis, or largest x [m]
    volume: float  # of the cells that are reached, turned about the first axis through its range [m3]; 0 if it slides


def workspace_map(
    arm: SerialArm, gravity: FloatArray, postures: int = 400_000, loaded_postures: int = 40_000, cells: int = 48
) -> WorkspaceMap:
    """Sample the workspace.

    Args:
        gravity: in the base (3,) [m/s2].
        postures: that are asked where the tip is. loaded_postures: of them, that are asked what they can carry, as
            many in each cell as in the others where there are so many.
        cells: along the longer side of the map.
    """
    positions = spread(arm.joint_count, postures) * (arm.upper - arm.lower) + arm.lower
    tips, tools, sides = tip_samples(arm.chain, positions)
    points, turn, about_axis = _section(arm, tips)
    directions = _turned(tools, turn)
    one_way = float(np.ptp(directions, axis=0).max()) < _ONE_WAY
    across, height = _edges(points, cells, about_axis)
    shape = (len(height) - 1, len(across) - 1)
    cell = _cell_of(points, across, height)
    seen = np.zeros((shape[0] * shape[1], DIRECTIONS), dtype=bool)
    seen[cell, _sector_of(directions[0], _turned(sides, turn)) if one_way else _patch_of(directions)] = True
    reached = np.any(seen, axis=1)
    pointing = np.where(reached, seen.mean(axis=1), np.nan)

    chosen = _evenly(cell, loaded_postures)
    few, cells_of_few = np.ascontiguousarray(positions[chosen]), cell[chosen]
    jacobians = jacobian_samples(arm.chain, few)
    holding = np.array([gravity_effort(arm, row, gravity) for row in few])
    values = np.linalg.svd(jacobians, compute_uv=False)
    weight = float(np.linalg.norm(gravity))
    payload = None
    if weight > 0.0:
        lift = _largest_forces(arm, jacobians, holding, -gravity / weight) / weight
        payload = _largest_in(cells_of_few, lift, len(reached)).reshape(shape)
    weightless = bool(np.mean(np.all(np.abs(holding) <= arm.max_effort, axis=1)) < _HARDLY)
    bearing = np.zeros_like(holding) if weightless else holding
    worst = np.min([_largest_forces(arm, jacobians, bearing, side) for side in (*np.eye(3), *-np.eye(3))], axis=0)
    return WorkspaceMap(
        across=across,
        height=height,
        about_axis=about_axis,
        pointing=pointing.reshape(shape),
        one_way=one_way,
        manipulability=_largest_in(cells_of_few, np.prod(values, axis=1), len(reached)).reshape(shape),
        force=_largest_in(cells_of_few, worst, len(reached)).reshape(shape),
        weightless=weightless,
        payload=payload,
        tips=tips[:20_000],  # the first points of the sequence are as evenly spread as all of them
        reach_from_axis=float(points[:, 0].max()),
        volume=_volume(arm, reached.reshape(shape), across, height) if about_axis else 0.0,
    )


@njit(cache=True)
def tip_samples(chain: Chain, positions: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Tip positions (m, 3) [m], tool directions (m, 3), a direction across it (m, 3) at joint positions (m, n)."""
    count, n = positions.shape
    tips, tools, sides = np.empty((count, 3)), np.empty((count, 3)), np.empty((count, 3))
    rotation, position, jacobian = np.empty((3, 3)), np.empty(3), np.empty((6, n))
    across = np.zeros(3)
    across[np.argmin(np.abs(chain.tool_axis))] = 1.0
    across -= np.sum(across * chain.tool_axis) * chain.tool_axis
    across /= np.sqrt(np.sum(across**2))
    for i in range(count):
        tip_kinematics(chain, positions[i], rotation, position, jacobian)
        for k in range(3):
            tips[i, k] = position[k]
            tools[i, k], sides[i, k] = 0.0, 0.0
            for m in range(3):
                tools[i, k] += rotation[k, m] * chain.tool_axis[m]
                sides[i, k] += rotation[k, m] * across[m]
    return tips, tools, sides


@njit(cache=True)
def jacobian_samples(chain: Chain, positions: FloatArray) -> FloatArray:
    """Jacobians (m, 6, n) at joint positions (m, n)."""
    jacobians = np.empty((positions.shape[0], 6, positions.shape[1]))
    rotation, position = np.empty((3, 3)), np.empty(3)
    for i in range(positions.shape[0]):
        tip_kinematics(chain, positions[i], rotation, position, jacobians[i])
    return jacobians


def first_axis(arm: SerialArm) -> tuple[FloatArray, FloatArray]:
    """A point on the first joint's axis (3,) [m] and its direction (3,), in the base."""
    return arm.chain.translation[0], arm.chain.rotation[0] @ arm.chain.axis[0]


def _section(arm: SerialArm, tips: FloatArray) -> tuple[FloatArray, FloatArray | None, bool]:
    """Across and height (m, 2), the axes of the section through each tip (m, 3, 3), and whether it is about an axis."""
    if not arm.revolute[0]:
        return tips[:, [0, 2]], None, False
    point, axis = first_axis(arm)
    if axis[2] < -0.5:  # height counts upward where there is an up
        axis = -axis
    out = tips - point
    height = out @ axis
    radial = out - height[:, None] * axis
    distance = np.linalg.norm(radial, axis=1)
    radial /= np.maximum(distance, 1e-12)[:, None]
    axes = np.stack([radial, np.cross(axis, radial), np.broadcast_to(axis, radial.shape)], axis=1)
    return np.stack([distance, height + float(point @ axis)], axis=1), axes, True


def _turned(directions: FloatArray, axes: FloatArray | None) -> FloatArray:
    """Directions (m, 3) in the axes of their sections."""
    return directions if axes is None else np.asarray(np.einsum("mij,mj->mi", axes, directions))


def _evenly(cell: IntArray, count: int) -> IntArray:
    """Indices of at most `count` samples: the first of every cell, then the second of every cell, and so on."""
    order = np.argsort(cell, kind="stable")
    ordered = cell[order]
    firsts = np.concatenate([[True], ordered[1:] != ordered[:-1]])
    begin = np.maximum.accumulate(np.where(firsts, np.arange(len(cell)), 0))
    rank = np.empty(len(cell), dtype=np.int64)
    rank[order] = np.arange(len(cell)) - begin
    return np.asarray(np.sort(np.argsort(rank, kind="stable")[:count]), dtype=np.int64)


def _sector_of(tool: FloatArray, sides: FloatArray) -> IntArray:
    """Sector, of `DIRECTIONS`, in which directions (m, 3) across a tool (3,) lie."""
    first = sides[0] - (sides[0] @ tool) * tool
    turn = np.arctan2(sides @ np.cross(tool, first), sides @ first) / (2.0 * np.pi) + 0.5
    return np.asarray(np.clip((turn * DIRECTIONS).astype(np.int64), 0, DIRECTIONS - 1), dtype=np.int64)


def _edges(points: FloatArray, cells: int, from_zero: bool) -> tuple[FloatArray, FloatArray]:
    low, high = points.min(axis=0), points.max(axis=0)
    if from_zero:
        low[0] = 0.0
    size = float(np.max(high - low)) / cells
    counts = np.maximum(np.ceil((high - low) / size - 1e-3).astype(int), 1)
    return low[0] + size * np.arange(counts[0] + 1), low[1] + size * np.arange(counts[1] + 1)


def _cell_of(points: FloatArray, across: FloatArray, height: FloatArray) -> IntArray:
    column = np.clip(((points[:, 0] - across[0]) / (across[1] - across[0])).astype(np.int64), 0, len(across) - 2)
    row = np.clip(((points[:, 1] - height[0]) / (height[1] - height[0])).astype(np.int64), 0, len(height) - 2)
    return np.asarray(row * (len(across) - 1) + column, dtype=np.int64)


def _patch_of(directions: FloatArray) -> IntArray:
    up = directions[:, 2]
    band = np.clip(((up / _CAP + 1.0) * 0.5 * BANDS).astype(np.int64), 0, BANDS - 1)
    turn = np.arctan2(directions[:, 1], directions[:, 0]) / (2.0 * np.pi) + 0.5
    patch = band * SECTORS + np.clip((turn * SECTORS).astype(np.int64), 0, SECTORS - 1)
    patch[up > _CAP], patch[up < -_CAP] = DIRECTIONS - 2, DIRECTIONS - 1
    return np.asarray(patch, dtype=np.int64)


def _largest_forces(arm: SerialArm, jacobians: FloatArray, holding: FloatArray, direction: FloatArray) -> FloatArray:
    """As manipulability.largest_force, for many postures (m,)."""
    needed = np.einsum("mki,k->mi", jacobians[:, :3], direction)
    spare = np.where(needed > 0.0, arm.max_effort - holding, arm.max_effort + holding)
    with np.errstate(divide="ignore", invalid="ignore"):
        force = np.min(np.where(np.abs(needed) > 1e-9, spare / np.abs(needed), np.inf), axis=1)
    return np.asarray(np.where(np.any(np.abs(holding) > arm.max_effort, axis=1), 0.0, force))


def _largest_in(cell: IntArray, values: FloatArray, count: int) -> FloatArray:
    largest = np.full(count, -np.inf)
    np.maximum.at(largest, cell, values)
    return np.where(np.isneginf(largest), np.nan, largest)


def _volume(arm: SerialArm, reached: FloatArray, across: FloatArray, height: FloatArray) -> float:
    if len(height) == 2:
        return 0.0  # the tip stays in a plane
    turn = min(float(arm.upper[0] - arm.lower[0]), 2.0 * np.pi)
    rings = 0.5 * turn * (across[1:] ** 2 - across[:-1] ** 2) * (height[1] - height[0])
    return float(np.sum(reached * rings[None, :]))
