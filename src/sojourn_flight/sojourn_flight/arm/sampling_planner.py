"""A way round what is in the way, where neither the direct one nor that over a named pose is free: RRT-Connect.

Two trees of postures grow in turns, one from where the arm is, one from all the ends that it may have. A random posture
draws one tree a step towards it from its nearest node; the other tree then goes for what was reached, step after step,
until it is there or something is in the way (Kuffner & LaValle, IEEE ICRA 2000). The corners of the way found are cut:
two random places on it are joined by a straight line where that is free and shorter (Geraerts & Overmars, Int. J.
Robotics Research 26(8), 2007). Lengths are times: those in which every joint runs at its own speed limit, by the
Euclidean norm.

The same question has the same answer: random numbers come from a fixed seed, and what may be spent is counted in
postures that are looked at, not in seconds. Complete in probability only: a way through a narrow place may be missed.
"""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from sojourn_flight.arm.collision import check_posture, check_samples, refined
from sojourn_flight.arm.law_params import WayParams
from sojourn_flight.arm.model import ArmModel
from sojourn_flight.arm.param_groups import NamedPoseParams
from sojourn_flight.arm.relief import Ground
from sojourn_machine.params import FloatArray

SEED = 2000
STEP = 0.4
"""Largest run of a joint from one node to the next [rad or m]."""
MOST_POSTURES = 30_000
"""Looked at, before it gives up: a second or less [-]."""
MARGINS = (0.003, 0.0)
"""Kept beside the clearance [m], tried in this order: lines are looked at in places, and motions run between them."""
SHORTCUTS = 40
_SHORTER = 0.98
"""A shortcut is taken where it takes less than this share of the time [-]."""


def posture_of(params: NamedPoseParams, model: ArmModel, name: str) -> FloatArray:
    """Joint positions (n,) of a named pose; a joint that does not move stays where it is."""
    named = np.array(params.named_poses[name])
    return np.asarray(np.minimum(np.maximum(named, model.lower), model.upper), dtype=np.float64)


@dataclass(slots=True)
class _Tree:
    """Postures, each with the number of the one before it; -1 for a root."""

    forward: bool
    """Whether the arm goes from the root to the leaves, or back."""
    nodes: FloatArray
    parents: list[int] = field(default_factory=list)

    def add(self, posture: FloatArray, parent: int) -> int:
        count = len(self.parents)
        if count == len(self.nodes):
            self.nodes = np.vstack([self.nodes, np.zeros_like(self.nodes)])
        self.nodes[count] = posture
        self.parents.append(parent)
        return count

    def nearest(self, posture: FloatArray, speeds: FloatArray) -> int:
        off = (self.nodes[: len(self.parents)] - posture) / speeds
        return int(np.argmin(np.einsum("ij,ij->i", off, off)))

    def line(self, node: int) -> list[FloatArray]:
        """Postures from the root to a node."""
        found = []
        while node >= 0:
            found.append(self.nodes[node].copy())
            node = self.parents[node]
        return found[::-1]


class SamplingPlanner:
    """Finds ways of one arm round the rover, itself and the ground.

    Args:
        ground: that the arm keeps above, or None.
    """

    def __init__(self, params: WayParams, model: ArmModel, ground: Ground | None) -> None:
        self._params, self._model, self._ground = params, model, ground
        self._generator = np.random.default_rng(SEED)
        self._tight = False
        """The arm is nearer to something than it may come: it may go away from it."""
        self.checked = 0
        """Postures so far."""

    def way(self, start: FloatArray, ends: list[FloatArray]) -> list[FloatArray] | None:
        """Corners (n,) of a way from `start` (n,) to one of `ends` (n,), without the start; None if none is found."""
        model = self._model
        free = [end for end in ends if check_posture(self._params, model, end, self._ground) is None]
        if not free:
            return None
        self._tight = check_posture(self._params, model, start, self._ground) is not None
        room = np.zeros((256, model.joint_count))
        trees = [_Tree(True, room.copy()), _Tree(False, room)]
        trees[0].add(start, -1)
        for end in free:
            trees[1].add(end, -1)
        met = self._connect(trees[1], start)
        if met is not None:
            return self._cut(self._joined(trees, 0, met))
        for name in self._params.via_poses:  # good places to come from, which a random posture seldom hits
            for tree in trees:
                self._connect(tree, posture_of(self._params, model, name))
        span = model.upper - model.lower
        while self.checked < MOST_POSTURES:
            drawn = model.lower + self._generator.random(model.joint_count) * span
            new = self._extend(trees[0], drawn)
            if new is not None:
                met = self._connect(trees[1], trees[0].nodes[new])
                if met is not None:
                    return self._cut(self._joined(trees, new, met))
            trees.reverse()
        return None

    def _extend(self, tree: _Tree, towards: FloatArray) -> int | None:
        """A node one step from the nearest one on; None where something is in the way."""
        near = tree.nearest(towards, self._model.max_velocity)
        there = _step(tree.nodes[near], towards)
        return tree.add(there, near) if self._is_free(tree.forward, tree.nodes[near], there) else None

    def _connect(self, tree: _Tree, goal: FloatArray) -> int | None:
        """The node at `goal`, if the tree comes there by steps on a straight line."""
        node = tree.nearest(goal, self._model.max_velocity)
        while True:
            there = _step(tree.nodes[node], goal)
            if not self._is_free(tree.forward, tree.nodes[node], there):
                return None
            node = tree.add(there, node)
            if there is goal:
                return node

    def _joined(self, trees: list[_Tree], new: int, met: int) -> list[FloatArray]:
        lines = {tree.forward: tree.line(node) for tree, node in zip(trees, (new, met), strict=True)}
        return lines[True] + lines[False][::-1][1:]

    def _is_free(self, forward: bool, inner: FloatArray, outer: FloatArray) -> bool:
        """Whether the straight line between a node and one further from the root is free."""
        ends = (inner, outer) if forward else (outer, inner)
        samples = refined(np.array(ends), self._params.collision_step)
        self.checked += len(samples)
        allow = self._tight and forward
        return check_samples(self._params, self._model, samples, self._ground, allow_start=allow) is None

    def _cut(self, corners: list[FloatArray]) -> list[FloatArray]:
        """The way without the corners that it does not need; its start is left out."""
        for _ in range(SHORTCUTS):
            if len(corners) <= 2:
                break
            times = np.array([self._time(*ends) for ends in pairwise(corners)])
            first, last = np.sort(self._generator.random(2)) * times.sum()
            (one, here), (two, there) = (_place(corners, times, at) for at in (first, last))
            way = self._time(here, there)
            if one == two or way > _SHORTER * (last - first) or not self._is_free(True, here, there):
                continue
            corners = [*corners[: one + 1], here, there, *corners[two + 1 :]]
        return self._without_needless(corners)[1:]

    def _without_needless(self, corners: list[FloatArray]) -> list[FloatArray]:
        """Leave out each corner whose neighbours are joined by a free line."""
        kept, k = list(corners), 1
        while k < len(kept) - 1:
            if self._is_free(True, kept[k - 1], kept[k + 1]):
                del kept[k]
            else:
                k += 1
        return kept

    def _time(self, here: FloatArray, there: FloatArray) -> float:
        return float(np.linalg.norm((there - here) / self._model.max_velocity))


def _step(here: FloatArray, towards: FloatArray) -> FloatArray:
    """A posture STEP from one on a straight line to another; the other itself where it is no further."""
    run = float(np.max(np.abs(towards - here)))
    return towards if run <= STEP else here + STEP / run * (towards - here)


def _place(corners: list[FloatArray], times: FloatArray, at: float) -> tuple[int, FloatArray]:
    """Number of the leg at a time along the way, and the posture there."""
    ends = np.cumsum(times)
    leg = min(int(np.searchsorted(ends, at)), len(times) - 1)
    share = 1.0 - (ends[leg] - at) / max(times[leg], 1e-12)
    return leg, corners[leg] + share * (corners[leg + 1] - corners[leg])


class Detours:
    """Ways round, each looked for once: a motion that is planned anew, slower, goes the same way.

    Args:
        ground: that the arm keeps above, or None.
    """

    def __init__(self, params: WayParams, model: ArmModel, ground: Ground | None) -> None:
        self.ground = ground
        self._params, self._model = params, model
        self._found: dict[bytes, list[FloatArray] | None] = {}

    def corners(self, start: FloatArray, ends: list[FloatArray], margin: float) -> list[FloatArray] | None:
        """As `SamplingPlanner.way`, with a `margin` [m] beside the clearance."""
        key = np.array([*start, *np.ravel(ends), margin]).tobytes()
        if key not in self._found:
            wider = self._params.model_copy(update={"collision_clearance": self._params.collision_clearance + margin})
            self._found[key] = SamplingPlanner(wider, self._model, self.ground).way(start, ends)
        return self._found[key]
