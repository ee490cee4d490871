"""What a goal comes to, before it starts: whether it is accepted, along which way, what that takes of time, energy and
charge, and how near it brings the machine to tipping over or sliding, on the ground that has been seen.

The way is the one that was asked for, round keep-out zones; ways round obstacles that are seen later are not in it. The
charge at the end lies on the straight line between the charge now and the reserve, over the energy between them.
"""

import math
from typing import NamedTuple

import numpy as np

from sojourn_flight.hazards.settling import settled
from sojourn_flight.odometry.odometry import OdometryState
from sojourn_flight.planning.clothoid import Pose
from sojourn_flight.planning.energy_forecast import SECONDS_PER_HOUR, EnergyLeft, Forecast, forecast_way, shortage
from sojourn_flight.planning.follower_state import FollowerState
from sojourn_flight.planning.goal import Goal, GoalOutcome
from sojourn_flight.planning.goal_follower import accept
from sojourn_flight.planning.path import PlannedPath, thinned
from sojourn_flight.supervision.avoidance import accepted
from sojourn_flight.supervision.avoidance_types import Avoidance, AvoidanceState
from sojourn_flight.supervision.driven_machine import DrivenMachine
from sojourn_flight.supervision.path_check import slope_at, tilts_of
from sojourn_flight.supervision.zone_check import clear_of_zones
from sojourn_machine.params import FloatArray

EVERY = 0.1
"""The ground under a way is looked at so often [m]."""


class Foresight(NamedTuple):
    """The answer to a goal."""

    answer: FollowerState | GoalOutcome
    """The goal at its start, or its refusal."""
    path: PlannedPath | None
    """The way, of a goal that is refused for the charge too; None where there is none."""
    forecast: Forecast | None
    """What it takes; None where that is not known."""
    avoidance: AvoidanceState | None
    """At the start of the way."""


def foresee(
    model: DrivenMachine,
    avoidance: AvoidanceState | None,
    goal: Goal,
    here: OdometryState,
    supply: EnergyLeft | None,
) -> Foresight:
    """Answer a goal, and change nothing. supply: None as long as nothing is known of the battery."""
    params, path, forecast = model.params, None, None
    answer = accept(params.follower, model.mobility.ability.turning, goal, Pose(here.x, here.y, here.yaw))
    answer = clear_of_zones(model.keep_out, model.avoidance, avoidance, goal, answer, here)
    if isinstance(answer, FollowerState):
        path = answer.path
        if params.energy is not None:
            ground = here.z - model.mobility.ability.ride_height
            forecast = forecast_way(params.energy, path, goal, ground, here.yaw)
            short = shortage(params.energy, forecast, supply) if supply is not None else None
            if short is not None:
                answer = GoalOutcome("refused", short, goal, math.nan)
    if model.avoidance is not None and avoidance is not None:
        answer, avoidance = accepted(model.avoidance, avoidance, goal, answer, here)
    return Foresight(answer, path, forecast, avoidance)


def foresight_status(model: DrivenMachine, found: Foresight, supply: EnergyLeft | None) -> dict[str, str | float]:
    """Fields of /drive/status that answer a question; what is not known is left out."""
    refused = isinstance(found.answer, GoalOutcome)
    told: dict[str, str | float] = {
        "asked_state": "refused" if refused else "allowed",
        "asked_reason": found.answer.reason if isinstance(found.answer, GoalOutcome) else "",
    }
    if found.path is None:
        return told
    told["asked_length_m"] = found.path.length
    if found.forecast is not None:
        told["asked_time_s"] = found.forecast.seconds
        told["asked_energy_wh"] = found.forecast.total / SECONDS_PER_HOUR
        if supply is not None:
            told["asked_charge_at_end"] = _charge_at_end(found.forecast, supply)
    if model.avoidance is not None and found.avoidance is not None:
        told |= _tilt(model.avoidance, found.avoidance, found.path)
    return told


def _charge_at_end(forecast: Forecast, supply: EnergyLeft) -> float:
    """State of charge after the way, with what sources give now [1]."""
    if supply.left <= 0.0:
        return supply.soc
    taken = forecast.total - supply.given * forecast.seconds
    return min(max(supply.soc - (supply.soc - supply.reserve) * taken / supply.left, 0.0), 1.0)


def _tilt(avoidance: Avoidance, seen: AvoidanceState, path: PlannedPath) -> dict[str, str | float]:
    """How much of the way has been seen, and where on that the machine is nearest to its limits of tilt."""
    poses = _poses(path)
    if not len(poses):
        return {}
    ground = seen.ground.under(seen.map)
    known = np.array([math.isfinite(settled(ground, avoidance.supports, *pose)[0]) for pose in poses])
    told: dict[str, str | float] = {"asked_seen": float(known.mean())}
    if known.any():
        steepest = poses[known][int(np.argmax(tilts_of(avoidance, seen, poses[known])))]
        slope = slope_at(avoidance, seen, Pose(*steepest.tolist()))
        told["asked_tilt_margin_deg"] = slope.limit - slope.measured
        told["asked_tilt"] = str(slope)
    return told


def _poses(path: PlannedPath) -> FloatArray:
    """x, y, heading along a path, shape (n, 3)."""
    parts = []
    for leg in path.legs:
        parts.append(leg.samples[thinned(leg.samples[:, 0], EVERY), 1:4])
    return np.concatenate(parts) if parts else np.empty((0, 3))
