"""A hazard camera that sees less than it did, or the same again and again: recognised from its clouds alone.

    dim      a cloud has less than `dim_part` of the points that clouds usually have: dust on the lens, light gone
    blind    less than `blind_part` of them, or none
    frozen   the points of a cloud are those of the one before, to the last bit: noise makes that impossible

Each counts from the `clouds`-th in a row on, and ends with the first that is well. What is usual is a mean over the
clouds that were neither, with a weight of `weight` for the newest; from the first one on, so that a lens that is dusty
before the run begins is taken for a clean one.

What follows (`drive`): while the camera is dim the rover drives no faster than `slow_part` of its speed. A blind or
frozen camera is as good as none: its clouds are left out, so that the map and the odometry are not told of ground that
is elsewhere, and the rover waits as it does without clouds (`avoidance`).

Source: own formulation. Assumption: ground that truly gives fewer points (a crest, a wall before the lens) gives them
back before `clouds` have passed, or is a reason to go slowly, too.
"""

from dataclasses import dataclass

import numpy as np
from pydantic import Field

from sojourn_machine.params import FloatArray, Params

WELL, DIM, BLIND, FROZEN = "", "dim", "blind", "frozen"


class CameraWatchParams(Params):
    """When a camera does not see."""

    dim_part: float = Field(default=0.5, gt=0.0, lt=1.0, description="of the usual points, below which it is dim [-]")
    blind_part: float = Field(default=0.1, gt=0.0, lt=1.0, description="below which it is blind [-]")
    clouds: int = Field(default=3, ge=1, le=1000, description="in a row, after which it counts [1]")
    weight: float = Field(default=0.1, gt=0.0, le=1.0, description="of the newest cloud in what is usual [-]")
    slow_part: float = Field(default=0.5, gt=0.0, le=1.0, description="of its speed that a dim camera leaves [-]")


@dataclass(frozen=True, slots=True)
class CameraState:
    """What is known of a camera. Arrays are not written to."""

    last: FloatArray | None = None
    """Points of the last cloud, (n, 3) [m]; None before the first."""
    usual: float = 0.0
    """Points of a cloud [1]."""
    seems: str = WELL
    """What the last cloud was: one of the words above."""
    count: int = 0
    """So many times in a row."""
    found: str = WELL
    """What the camera is taken for."""


def watched(params: CameraWatchParams, state: CameraState, cloud: FloatArray | None) -> CameraState:
    """The state after a period with a cloud, (n, 3) [m], or without one."""
    if cloud is None:
        return state
    seems = _looks(params, state, cloud)
    count = state.count + 1 if seems == state.seems else 1
    usual = state.usual
    if seems == WELL:
        usual = float(len(cloud)) if not usual else usual + params.weight * (len(cloud) - usual)
    found = WELL if seems == WELL else seems if count >= params.clouds else state.found
    return CameraState(cloud, usual, seems, count, found)


def usable(state: CameraState, cloud: FloatArray | None) -> FloatArray | None:
    """The cloud of this period, None where the camera does not tell of the ground that is there."""
    return None if state.seems in (BLIND, FROZEN) else cloud


def speed_left(params: CameraWatchParams, state: CameraState) -> float:
    """Part of its speed that a rover may have with such a camera [-]."""
    return params.slow_part if state.found else 1.0


def in_words(state: CameraState) -> str:
    """What is wrong, "" where nothing is."""
    if state.found == FROZEN:
        return "the hazard camera is frozen: it says the same again and again"
    if state.found:
        points = 0 if state.last is None else len(state.last)
        return f"the hazard camera is {state.found}: {points} points, usual are {state.usual:.0f}"
    return ""


def _looks(params: CameraWatchParams, state: CameraState, cloud: FloatArray) -> str:
    if len(cloud) == 0 or len(cloud) < params.blind_part * state.usual:
        return BLIND
    if state.last is not None and np.array_equal(cloud, state.last):
        return FROZEN
    return DIM if len(cloud) < params.dim_part * state.usual else WELL
