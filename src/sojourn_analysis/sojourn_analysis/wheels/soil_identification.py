"""Identification of a soil's parameters from measured trials of a wheel.

Least squares with a robust loss (soft L1: outliers count linearly; Huber 1964; scipy's trust region reflective) of the
relative errors of `trials`, from several starts, within physical bounds. Positive parameters that span decades are
searched by their logarithm.

Standard errors are those of linear least squares at the optimum, s² (JᵀJ)⁻¹, with the residuals' spread s from their
median magnitude (1.4826 MAD). A parameter at a bound is held there, and has none. Cross-validation leaves out all
trials of one slip angle (of one slip, where there is one angle alone), fits the others, and predicts what was left out.

Assumes that trials are independent; trials of one setting, repeated, are not quite.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import ValidationError
from scipy.optimize import least_squares

from sojourn_analysis.wheels.soil_bounds import EXIT_LAMBDA, PHYSICAL_BOUNDS
from sojourn_analysis.wheels.trials import QUANTITIES, Trials, errors, predict
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.params import FloatArray
from sojourn_physics.soil.params import SoilParams, kernel_row

LOGARITHMIC = frozenset({"k_phi", "shear_modulus", "shear_modulus_lateral", "bulldozing_modulus"})
SLIP_ANGLE_ONLY = frozenset({"shear_modulus_lateral", "theta_m_c3", "side_sinkage", "bulldozing_modulus"})
"""Parameters that straight trials say nothing about."""
SKID_ONLY = frozenset({"skid_sinkage"})

LOSS_SCALE = 0.02
"""Relative error from which a trial counts as an outlier."""
DRIVING_WEIGHT = 2.0
"""Weight of trials of driving, over braking and full sideslip: it is what rovers do."""
TORQUE_WEIGHT = 0.3
"""Weight of the torque: it holds the friction of the drive train as well."""
LOST = 0.5
"""Relative error of a trial whose load is not carried."""
AT_BOUND = 1e-3
"""Distance from a bound, over its range, at which a parameter counts as held there."""


@dataclass(frozen=True, slots=True)
class Fit:
    """What has been identified."""

    soil: SoilParams
    values: dict[str, float]
    standard_errors: dict[str, float | None]
    """None for a parameter at a bound, or without any effect on the trials."""
    covariance: FloatArray
    """Of the values in their order; zero for a parameter at a bound."""
    predicted: FloatArray
    """(count, len(QUANTITIES)) for the trials, by the fit."""
    held_out: FloatArray | None
    """The same, each by a fit that has not seen the trial's group; None without cross-validation."""


class _Problem:
    def __init__(self, base: SoilParams, trials: Trials, free: Mapping[str, tuple[float, float]]) -> None:
        self.base, self.trials, self.free = base, trials, free
        weights = np.where(trials.driving(), DRIVING_WEIGHT, 1.0)[:, None] * np.ones(len(QUANTITIES))
        weights[:, QUANTITIES.index("torque_nm")] *= TORQUE_WEIGHT
        self.weights = weights
        self.known = ~np.isnan(trials.measured)

    def values(self, place: FloatArray) -> dict[str, float]:
        result = {}
        for (name, (low, high)), x in zip(self.free.items(), place, strict=True):
            result[name] = float(low * (high / low) ** x if name in LOGARITHMIC else low + x * (high - low))
        if "theta_m_c1" in result:  # θm stays below θ1 at every slip
            c2 = result.get("theta_m_c2", self.base.theta_m_c2)
            result["theta_m_c1"] = min(result["theta_m_c1"], 1.0 - max(c2, 0.0))
        return result

    def slopes(self, place: FloatArray) -> FloatArray:
        """Derivative of each value by its place."""
        found = self.values(place)
        pairs = self.free.items()
        return np.array([found[k] * math.log(h / low) if k in LOGARITHMIC else h - low for k, (low, h) in pairs])

    def place(self, values: Mapping[str, float]) -> FloatArray:
        result = []
        for name, (low, high) in self.free.items():
            value = min(max(values[name], low), high)
            linear = (value - low) / (high - low)
            result.append(math.log(value / low) / math.log(high / low) if name in LOGARITHMIC else linear)
        return np.array(result)

    def soil(self, place: FloatArray) -> SoilParams:
        return with_values(self.base, self.values(place))

    def residuals(self, place: FloatArray) -> FloatArray:
        found = errors(self.trials, predict(self.trials, kernel_row(self.soil(place))))
        found = np.where(np.isnan(found), LOST, found)
        result: FloatArray = (found * self.weights)[self.known]
        return result


def with_values(base: SoilParams, values: Mapping[str, float]) -> SoilParams:
    """The soil with other values; EXIT_LAMBDA goes to the exit angle.

    Raises:
        InvalidValueError: a value that a soil cannot have.
    """
    changes: dict[str, float | str] = {name: value for name, value in values.items() if name != EXIT_LAMBDA}
    if EXIT_LAMBDA in values:
        changes["exit_angle"] = f"lambda:{values[EXIT_LAMBDA]:.6g}"
    try:
        return SoilParams.model_validate({**base.model_dump(), **changes})
    except ValidationError as error:
        raise InvalidValueError("soil", changes, str(error.errors()[0]["msg"])) from error


def value_of(soil: SoilParams, name: str) -> float:
    """Value of a parameter that can be identified."""
    if name == EXIT_LAMBDA:
        return soil.exit_lambda or 0.0
    if name == "interface_friction_angle_deg" and soil.interface_friction_angle_deg is None:
        return soil.friction_angle_deg
    return float(getattr(soil, name))


def bounds_of(soil: SoilParams, names: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Physical bounds of the parameters for a soil.

    Raises:
        InvalidValueError: a parameter that cannot be identified.
    """
    result = {}
    for name in names:
        if name not in PHYSICAL_BOUNDS:
            raise InvalidValueError("parameter", name, "one of " + ", ".join(PHYSICAL_BOUNDS))
        low, high = PHYSICAL_BOUNDS[name]
        if name == "interface_friction_angle_deg":
            low, high = low * soil.friction_angle_deg, high * soil.friction_angle_deg
        result[name] = (low, high)
    return result


def identifiable(trials: Trials, names: Sequence[str]) -> list[str]:
    """Those of the parameters about which the trials say something."""
    straight = not np.any(trials.cases[:, 2] != 0.0)
    driven = not np.any(trials.cases[:, 1] < 0.0)
    return [k for k in names if not (straight and k in SLIP_ANGLE_ONLY) and not (driven and k in SKID_ONLY)]


def identify(
    base: SoilParams, trials: Trials, names: Sequence[str], starts: int = 4, seed: int = 0, cross_validate: bool = True
) -> Fit:
    """Fit the parameters `names` of a soil to trials; all others stay as in `base`, where the first start begins.

    Args:
        starts: number of starts. seed: of the others, which are scattered about the first.

    Raises:
        InvalidValueError: a parameter that cannot be identified.
    """
    free = bounds_of(base, names)
    problem = _Problem(base, trials, free)
    first = problem.place({name: value_of(base, name) for name in names})
    place, jacobian, residuals = _search(problem, first, starts, np.random.default_rng(seed))
    values = problem.values(place)
    covariance, deviations = _spread(problem, place, jacobian, residuals)
    held_out = None
    if cross_validate:
        groups = trials.groups()
        held_out = np.empty((len(trials.cases), len(QUANTITIES)))
        for group in np.unique(groups):
            left = groups == group
            without = _Problem(base, trials.only(~left), free)
            found, _, _ = _search(without, place, 1, np.random.default_rng(seed))
            held_out[left] = predict(trials.only(left), kernel_row(without.soil(found)))
    soil = problem.soil(place)
    return Fit(soil, values, deviations, covariance, predict(trials, kernel_row(soil)), held_out)


def _search(
    problem: _Problem, first: FloatArray, starts: int, random: np.random.Generator
) -> tuple[FloatArray, FloatArray, FloatArray]:
    best = None
    for start in range(max(starts, 1)):
        scatter = random.normal(0.0, 0.2, len(first)) if start else 0.0
        found = least_squares(
            problem.residuals, np.clip(first + scatter, 0.02, 0.98), bounds=(0.0, 1.0), loss="soft_l1",
            f_scale=LOSS_SCALE, max_nfev=100, diff_step=1e-4,
        )  # fmt: skip
        if best is None or found.cost < best.cost:
            best = found
    if best is None:
        raise InvalidValueError("starts", starts, "at least 1")
    return best.x, best.jac, best.fun


def _spread(
    problem: _Problem, place: FloatArray, jacobian: FloatArray, residuals: FloatArray
) -> tuple[FloatArray, dict[str, float | None]]:
    inside = (place > AT_BOUND) & (place < 1.0 - AT_BOUND) & np.any(jacobian != 0.0, axis=0)
    spread = 1.4826 * float(np.median(np.abs(residuals)))
    covariance = np.zeros((len(place), len(place)))
    if inside.any():
        columns, slopes = jacobian[:, inside], problem.slopes(place)[inside]
        covariance[np.ix_(inside, inside)] = spread**2 * np.linalg.pinv(columns.T @ columns) * np.outer(slopes, slopes)
    deviations: dict[str, float | None] = {}
    for i, name in enumerate(problem.free):
        deviations[name] = math.sqrt(max(covariance[i, i], 0.0)) if inside[i] else None
    return covariance, deviations
