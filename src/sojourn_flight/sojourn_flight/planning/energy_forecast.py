"""What the way to a goal will take, before it starts; what it has taken; whether the charge suffices.

    E = sum over the stretches of e(grade) length  +  stops E_stop  +  turns E_turn  +  angle E_radian  +  P_house T
    T = sum over the stretches of t(grade) length  +  stops T_stop  +  turns T_turn  +  angle T_radian

e(grade) is the energy of the drive and steering motors for a metre of way, at the bus, and t(grade) the time, both
interpolated between grades at which they were measured: rolling and compaction of the soil, slip, the weight on the
grade, gears and motors are all in it (with work W = (R + m g sin a) / ((1 - s) eta) a metre, R the resistance, s the
slip and eta the efficiency; Wong 2010, ch. 4). Beyond the measured grades it goes on as between the last two. A
stretch whose climb is not known counts as level, which `margin` is for: a goal is refused if E (1 + margin) is more
than what the battery holds above the reserve, at which the power manager takes the drive's power away. P_house is
all that goes on whether the rover moves or not. What sources give meanwhile spares the battery as much; it is told
of the charge at the end alone: no goal is begun that needs the Sun to go on shining.

Range: the soil and the machine of the measurement, at full speed; |grade| somewhat beyond those measured. Losses
within the battery (about 1 %) are in the margin."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sojourn_flight.planning.energy_params import EnergyParams
from sojourn_flight.planning.goal import Goal
from sojourn_flight.planning.path import PlannedPath
from sojourn_machine.evolution import replace

SECONDS_PER_HOUR = 3600.0


@dataclass(frozen=True, slots=True)
class EnergyLeft:
    """What is known of the battery."""

    left: float
    """Energy above the reserve [J]."""
    soc: float
    reserve: float
    """Charge now and at the reserve [1]."""
    power: float
    """Taken now, from it and from sources [W]."""
    given: float = 0.0
    """Of that by sources [W]."""
    stamp: int = 0
    """Of the newest reading [ns]."""
    has_stood: bool = False
    """Whether one of them was at a stand."""


class Forecast(NamedTuple):
    """What a way will take."""

    motion: float
    """By drive and steering [J]."""
    house: float
    """By everything else meanwhile [J]."""
    seconds: float
    length: float
    """[m]"""
    climb: float | None
    """From the start to the end [m], None if it is not known."""

    @property
    def total(self) -> float:
        """[J]"""
        return self.motion + self.house


@dataclass(frozen=True, slots=True)
class EnergyUse:
    """Of the goal on its way, or of the last one."""

    forecast: Forecast | None = None
    used: float = 0.0
    """Taken since the goal was accepted [J]."""
    judged: bool = True
    """The charge has been held against the forecast."""


def on_grade(params: EnergyParams, measured: Sequence[float], grade: float) -> float:
    """Of the figures measured on the grades that for a grade [rad], up positive; at least nothing: gears do not drive
    motors.
    """
    grades = np.radians(params.grades_deg)
    if grades[0] <= grade <= grades[-1]:
        return float(np.interp(grade, grades, measured))
    a, b = (0, 1) if grade < grades[0] else (-2, -1)
    slope = (measured[b] - measured[a]) / (grades[b] - grades[a])
    return max(float(measured[b if b == -1 else a] + slope * (grade - grades[b if b == -1 else a])), 0.0)


def forecast_way(params: EnergyParams, path: PlannedPath, goal: Goal, z: float, yaw: float) -> Forecast:
    """What a path will take.

    Args:
        path, goal: `goal.heights` tell the ground's height at its points as far as it is known.
        z, yaw: height of the ground [m] and heading [rad] at the start, of the same frame.
    """
    motion = seconds = 0.0
    for length, climb in _stretches(path, goal.heights, z):
        grade = math.asin(min(max(climb / length, -1.0), 1.0)) if length > 0.0 else 0.0
        motion += length * on_grade(params, params.energy_per_metre, grade)
        seconds += length * on_grade(params, params.time_per_metre, grade)
    turns = path.turns(yaw, goal.yaw)
    angle, stops = sum(turns), len(path.legs)
    motion += stops * params.stop_energy + len(turns) * params.turn_energy + angle * params.energy_per_radian
    seconds += stops * params.stop_time + len(turns) * params.turn_time + angle * params.time_per_radian
    end = goal.heights[-1] if goal.heights else None
    return Forecast(motion, params.house_power * seconds, seconds, path.length, None if end is None else end - z)


def _stretches(path: PlannedPath, heights: Sequence[float | None], z: float) -> list[tuple[float, float]]:
    """Length and climb between the places whose height is known; level from the last of them."""
    found, begin = [], 0.0
    for mark, height in zip(path.marks, heights, strict=False):
        if height is not None and mark > begin:
            found.append((mark - begin, height - z))
            begin, z = mark, height
    return [*found, (path.length - begin, 0.0)]


def shortage(params: EnergyParams, forecast: Forecast, supply: EnergyLeft) -> str | None:
    """Why the charge does not suffice, with the numbers; None if it does, or if goals are not to be refused for it."""
    needed = (1.0 + params.margin) * forecast.total
    if not params.refuse or needed <= supply.left:
        return None
    way = "level, its climb is not known" if forecast.climb is None else f"climbs {forecast.climb:+.2f} m"
    return (
        f"the charge does not suffice: forecast {_wh(forecast.total)} (driving {_wh(forecast.motion)}, everything else "
        f"{_wh(forecast.house)} in {forecast.seconds:.0f} s; {forecast.length:.1f} m, {way}), with "
        f"{100 * params.margin:.0f} % margin {_wh(needed)}; left are {_wh(max(supply.left, 0.0))}, from "
        f"{100 * supply.soc:.1f} % of charge down to the reserve of {100 * supply.reserve:.1f} %"
    )


def account_step(account: EnergyUse, supply: EnergyLeft | None, under_way: bool, dt: float) -> EnergyUse:
    """The account after a period of `dt` [s]."""
    if supply is None or not under_way:
        return account
    return replace(account, used=account.used + supply.power * dt)


def account_status(account: EnergyUse, distance_to_go: float | None) -> dict[str, str | float]:
    """Fields of /drive/status; nothing is to go where there is no goal (None)."""
    if account.forecast is None:
        return {}
    share = 0.0
    if distance_to_go is not None:
        share = min(distance_to_go / account.forecast.length, 1.0) if account.forecast.length > 0.0 else 0.0
    return {
        "energy_forecast_wh": account.forecast.total / SECONDS_PER_HOUR,
        "energy_used_wh": account.used / SECONDS_PER_HOUR,
        "energy_to_go_wh": share * account.forecast.total / SECONDS_PER_HOUR,
    }


def _wh(energy: float) -> str:
    return f"{energy / SECONDS_PER_HOUR:.2f} Wh"
