"""A soil identified from trials, told and written: the work of scripts/fit_soil."""

import argparse
import json
import math
from typing import Any

from rich.table import Table

from sojourn_analysis.wheels.soil_bounds import EXIT_LAMBDA
from sojourn_analysis.wheels.soil_identification import (
    Fit,
    bounds_of,
    identifiable,
    identify,
)
from sojourn_analysis.wheels.trials import Trials, summary
from sojourn_config.command_errors import UsageError
from sojourn_config.load import load_params
from sojourn_machine.errors import MachineError
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.params import SOIL_ONLY, SoilParams
from sojourn_studies.trial_file import has_wheel, read_rows, read_trials, select
from sojourn_studies.wheel_bed import print_statistics, print_table

DEFAULT_FREE = (
    "k_phi", "interface_friction_angle_deg", "shear_modulus", "shear_modulus_lateral", "theta_m_c1", "theta_m_c2",
    "theta_m_c3", EXIT_LAMBDA, "slip_sinkage", "skid_sinkage", "side_sinkage", "bulldozing_modulus",
)  # fmt: skip


def _run(given: argparse.Namespace) -> int:
    base = load_params("soils", given.soil, SoilParams, [text.removeprefix("soil.") for text in given.set])
    rows = select(read_rows(given.trials), given.where)
    wheel = None
    if given.wheel is not None or not has_wheel(rows):
        if given.wheel is None:
            raise UsageError(f"{given.trials}: has no wheel_radius_m and wheel_width_m: name the wheel with --wheel")
        wheel = load_params("wheels", given.wheel, WheelShape)
    trials = read_trials(given.trials, rows, wheel, given.gravity)
    names = [name.strip() for name in given.free.split(",")] if given.free else identifiable(trials, DEFAULT_FREE)
    if len(set(names)) < len(names):
        raise UsageError(f"--free {given.free}: names a parameter twice")
    fit = identify(base, trials, names, max(given.starts, 1), given.seed, not given.no_cross_validation)
    if given.json:
        print(json.dumps(_report(fit, trials), indent=1))
    else:
        _print(fit, trials, given.trials.name)
    if given.write is not None:
        try:
            given.write.write_text(soil_text(fit, given.trials.name), encoding="utf-8")
        except OSError as error:
            raise UsageError(f"--write {given.write}: cannot be written ({error.strerror})") from error
        if not given.json:
            print(f"\nsoil: {given.write}")
    return 0


def _report(fit: Fit, trials: Trials) -> dict[str, Any]:
    report: dict[str, Any] = {
        "soil": fit.soil.name,
        "parameters": {
            name: {"value": value, "standard_error": fit.standard_errors[name]} for name, value in fit.values.items()
        },
        "covariance": {"order": list(fit.values), "matrix": fit.covariance.tolist()},
        "fitted": summary(trials, fit.predicted),
    }
    if fit.held_out is not None:
        report["cross_validated"] = summary(trials, fit.held_out)
    return report


def _print(fit: Fit, trials: Trials, name: str) -> None:
    table = Table(box=None, pad_edge=False)
    for head in ("parameter", "value", "standard error", "bounds"):
        table.add_column(head, justify="left" if head == "parameter" else "right")
    bounds = bounds_of(fit.soil, list(fit.values))
    for key, value in fit.values.items():
        error = fit.standard_errors[key]
        low, high = bounds[key]
        table.add_row(
            key,
            f"{value:.4g}",
            "at bound or no effect" if error is None else f"{error:.2g}",
            f"{low:.4g} to {high:.4g}",
        )
    print_table(table)
    _print_correlations(fit)
    print()
    print_statistics(f"{name}, fitted", summary(trials, fit.predicted))
    if fit.held_out is not None:
        print()
        title = f"{name}, cross-validated (each slip angle, or slip, by the others)"
        print_statistics(title, summary(trials, fit.held_out))


def _print_correlations(fit: Fit) -> None:
    names = list(fit.values)
    pairs = []
    for i, first in enumerate(names):
        for j in range(i):
            scale = math.sqrt(fit.covariance[i, i] * fit.covariance[j, j])
            if scale > 0.0 and abs(fit.covariance[i, j]) > 0.9 * scale:
                pairs.append(f"{names[j]} and {first} ({fit.covariance[i, j] / scale:+.2f})")
    if pairs:
        print("\nhardly told apart (correlation): " + "; ".join(pairs))


def soil_text(fit: Fit, source: str) -> str:
    """The soil as a file of `config/soils`, with the standard errors of what was identified as its spread."""
    given = json.loads(fit.soil.model_dump_json())
    defaults = {name: field.default for name, field in SoilParams.model_fields.items()}
    spread = {k: float(f"{e:.2g}") for k, e in fit.standard_errors.items() if e is not None and k != EXIT_LAMBDA}
    given["spread"] = {**given["spread"], **spread}
    given["estimates"] = [name for name in given["estimates"] if name not in fit.values]
    lines = [f"# Identified by scripts/fit_soil from {source}: {', '.join(fit.values)}."]
    for name, value in given.items():
        if name in defaults and value == defaults[name] and name not in ("kind", "form", "estimates", *SOIL_ONLY):
            continue
        if isinstance(value, float):
            value = float(f"{value:.4g}")
        lines.append(f"{name}: {_yaml(value)}")
    return "\n".join(lines) + "\n"


def _yaml(value: Any) -> str:
    if isinstance(value, str) and ("," in value or ":" in value or len(value) > 60):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_yaml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_yaml(item) for item in value) + "]"
    if isinstance(value, float):
        # YAML 1.1 reads 1e+06 as text: it wants the point
        text = repr(value)
        return text.replace("e", ".0e") if "e" in text and "." not in text else text
    return str(value) if not isinstance(value, bool) else str(value).lower()


def run(given: argparse.Namespace) -> int:
    """Fit, report and write."""
    try:
        return _run(given)
    except MachineError as error:
        raise UsageError(str(error)) from error
