"""A wheel on its bed in the terminal, case by case or trial by trial: the work of scripts/wheel_test."""

import argparse
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from sojourn_analysis.wheels.law_bench import Bed
from sojourn_analysis.wheels.trials import QUANTITIES, predict, summary
from sojourn_analysis.wheels.wheel_bench import BenchResult
from sojourn_config.command_errors import UsageError
from sojourn_config.errors import ConfigError
from sojourn_config.load import load_params, validate
from sojourn_config.machine_reader import machine_config
from sojourn_config.overrides import override_document, split_override
from sojourn_config.yaml_file import Data, YamlDocument
from sojourn_machine.contact_choice import CONTACT_LAWS, ContactChoice
from sojourn_machine.errors import MachineError
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.params import SoilParams, kernel_row
from sojourn_studies.trial_file import WHEEL, read_rows, read_trials, select
from sojourn_studies.wheel_test import DEFAULT_LAW, DEFAULT_WHEEL

TABLE_WIDTH = 120


def _run(given: argparse.Namespace) -> int:
    changes = _changes(given.set)
    if not given.gravity >= 0.0:
        raise UsageError(f"--gravity {given.gravity:g}: allowed is a number of at least 0")
    soil = load_params("soils", given.soil, SoilParams, changes["soil"])
    if given.csv is not None:
        return _trials(given, soil, changes["wheel"])
    if given.where:
        raise UsageError("--where goes with --csv")
    if given.load is None:
        raise UsageError("--load is missing: the load on the wheel [N] (see wheel_test --help)")
    wheel, contact = _of_machine(given, changes) if given.machine is not None else _of_options(given, changes)
    bed = Bed(wheel, contact, soil, given.load, given.gravity)
    slips, angles = given.slip or [0.2], given.slip_angle or [0.0]
    results = bed.measure(slips, angles)
    if given.json:
        names = {"wheel": wheel.name, "law": contact.model, "soil": soil.name}
        print(json.dumps([{**names, **asdict(result)} for result in results], indent=1))
    else:
        _print_results(bed, results)
    if given.plot is not None:
        # matplotlib takes a second to load, for nothing where there is no plot
        from sojourn_studies.wheel_plot import draw

        draw(given.plot, bed, angles, results)
        if not given.json:
            print(f"plot: {given.plot}")
    return 0


def _trials(given: argparse.Namespace, soil: SoilParams, wheel_changes: list[str]) -> int:
    refused = ("load", "slip", "slip_angle", "plot", "law", "machine")
    for option in refused:
        if getattr(given, option) is not None:
            raise UsageError(f"--{option.replace('_', '-')} does not go with --csv: the file says it, of rigid wheels")
    rows = select(read_rows(given.csv), given.where)
    wheel = None
    if given.wheel is not None:
        wheel = _wheel(given.wheel, wheel_changes)
    elif wheel_changes:
        # what --set leaves open each row may say, such as its grousers
        rows = [{**row, **_as_columns(wheel_changes)} for row in rows]
    trials = read_trials(given.csv, rows, wheel, given.gravity)
    predicted = predict(trials, kernel_row(soil))
    statistics = summary(trials, predicted)
    if given.json:
        named = [
            {**row, **dict(zip(QUANTITIES, [_or_none(x) for x in values], strict=True))}
            for row, values in zip(rows, predicted.tolist(), strict=True)
        ]
        finite = {key: {name: _or_none(x) for name, x in part.items()} for key, part in statistics.items()}
        print(json.dumps({"rows": named, "statistics": {"soil": soil.name, **finite}}, indent=1))
    else:
        print_statistics(f"{given.csv.name} on {soil.name}", statistics)
    return 0


def _wheel(name: str | None, changes: list[str]) -> WheelShape:
    """The wheel with its changes. Radius and width without a name are a smooth wheel of that size."""
    given = {text.partition("=")[0] for text in changes}
    if name is None and {"radius", "width"} <= given:
        blank: dict[str, Data] = {"name": "custom", "citation": "command line"}
        return validate(override_document(YamlDocument("command line", blank, {}), changes), WheelShape)
    return load_params("wheels", name or DEFAULT_WHEEL, WheelShape, changes)


def _of_options(given: argparse.Namespace, changes: Mapping[str, list[str]]) -> tuple[WheelShape, ContactChoice]:
    name = given.law or DEFAULT_LAW
    contact = _law(YamlDocument(f"--law {name}", {"model": name}, {}), changes["law"], CONTACT_LAWS.get(name))
    return _wheel(given.wheel, changes["wheel"]), contact


def _law(table: YamlDocument, changes: list[str], model: type[ContactChoice]) -> ContactChoice:
    """The law with its changes.

    Raises:
        ConfigError: its keys are named as --set takes them, and what is missing with the option that gives it.
    """
    try:
        return validate(override_document(table, changes), model)
    except ConfigError as error:
        missing = "the key is missing: "
        raise ConfigError(
            replace(
                problem,
                file=problem.file.replace("--set ", "--set law."),
                key=f"law.{problem.key}",
                allowed=problem.allowed.replace(missing, f"missing: give --set law.{problem.key}=VALUE; "),
            )
            for problem in error.problems
        ) from error


def _of_machine(given: argparse.Namespace, changes: Mapping[str, list[str]]) -> tuple[WheelShape, ContactChoice]:
    """The first wheel of a machine's file, and its law, with the changes."""
    for option in ("wheel", "law"):
        if getattr(given, option) is not None:
            raise UsageError(f"--{option} does not go with --machine: the machine's file says it")
    wheels = machine_config(given.machine).wheels
    if not wheels:
        raise UsageError(f"--machine {given.machine}: it has no wheel")
    first = wheels[0]
    shape: dict[str, Data] = {
        "name": first.name,
        "citation": f"config/machines/{given.machine}",
        **{key: getattr(first, key) for key in ("radius", "width", "grouser_height", "grouser_count")},
    }
    table: dict[str, Data] = first.contact.model_dump(mode="json")
    return (
        validate(override_document(YamlDocument(given.machine, shape, {}), changes["wheel"]), WheelShape),
        _law(YamlDocument(given.machine, table, {}), changes["law"], type(first.contact)),
    )


def _changes(texts: Sequence[str]) -> dict[str, list[str]]:
    """--set texts for the wheel, its law and the soil, without their first word."""
    sorted_texts: dict[str, list[str]] = {"wheel": [], "law": [], "soil": []}
    for text in texts:
        path, value = split_override(text)
        if len(path) < 2 or path[0] not in sorted_texts:
            raise UsageError(
                f"--set {text}: unknown key {path[0]}; allowed is wheel.KEY=VALUE, law.KEY=VALUE, soil.KEY=VALUE"
            )
        sorted_texts[str(path[0])].append(".".join(str(part) for part in path[1:]) + "=" + value)
    return sorted_texts


def _as_columns(wheel_changes: Sequence[str]) -> dict[str, str]:
    columns = {field: column for column, field in WHEEL.items()}
    found = {}
    for text in wheel_changes:
        field, _, value = text.partition("=")
        if field not in columns:
            raise UsageError(f"--set wheel.{text}: with the wheels of a --csv allowed are " + ", ".join(columns))
        found[columns[field]] = value
    return found


def _or_none(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _print_results(bed: Bed, results: Sequence[BenchResult]) -> None:
    wheel = bed.wheel
    grousers = f", {wheel.grouser_count} grousers of {1e3 * wheel.grouser_height:g} mm" if wheel.grouser_count else ""
    print(f"wheel {wheel.name}: radius {wheel.radius:g} m, width {wheel.width:g} m{grousers}; {bed.contact.model}")
    print(f"soil {bed.soil.name}; gravity {bed.gravity:.3f} m/s2; load {bed.load:g} N\n")
    columns: list[tuple[str, str, Callable[[BenchResult], str]]] = [
        ("slip", "[-]", lambda one: f"{one.slip:g}"),
        ("slip angle", "[deg]", lambda one: f"{one.slip_angle_deg:g}"),
        ("sinkage", "[mm]", lambda one: f"{1e3 * one.sinkage_m:.2f}"),
        ("drawbar pull", "[N]", lambda one: f"{one.drawbar_pull_n:.2f}"),
        ("side force", "[N]", lambda one: f"{one.side_force_n:.2f}"),
        ("torque", "[N m]", lambda one: f"{one.torque_nm:.3f}"),
    ]
    if results[0].entry_angle_rad is not None:
        columns += [
            ("entry", "[deg]", lambda one: f"{math.degrees(one.entry_angle_rad or 0.0):.1f}"),
            ("exit", "[deg]", lambda one: f"{math.degrees(one.exit_angle_rad or 0.0):.1f}"),
        ]
    else:
        columns += [
            ("pressed flat", "[mm]", lambda one: f"{1e3 * one.deflection_m:.2f}"),
            ("rolling", "[N]", lambda one: f"{one.resistances['rolling_n']:.2f}"),
        ]
    columns += [
        ("compaction", "[N]", lambda one: f"{one.resistances['compaction_n']:.2f}"),
        ("bulldozing", "[N]", lambda one: f"{one.resistances['bulldozing_n']:.2f}"),
    ]
    table = Table(box=None, pad_edge=False)
    for name, unit, _ in columns:
        table.add_column(f"{name}\n{escape(unit)}", justify="right")
    for one in results:
        table.add_row(*(text(one) for _, _, text in columns))
    print_table(table)


def print_table(table: Table) -> None:
    """Print a table in its full width, in a narrow terminal and in a file as well."""
    console = Console()
    console.width = max(console.width, TABLE_WIDTH)
    console.print(table)


def print_statistics(title: str, statistics: Mapping[str, Mapping[str, float | int | None]]) -> None:
    """Print the errors of predictions as a table."""
    print(f"{title}: median error, over the load for forces, over the radius for sinkage, over both for torque\n")
    table = Table(box=None, pad_edge=False)
    for name in ("", "trials", "drawbar pull [%]", "side force [%]", "sinkage [%]", "torque [%]", "not carried"):
        table.add_column(escape(name), justify="left" if not name else "right")
    names = {"driving": "driving (slip >= 0, angle <= 45)"}
    for key, part in statistics.items():
        table.add_row(
            names.get(key, key),
            str(part["trials"]),
            *(_percent(part[f"{q.rsplit('_', 1)[0]}_error_percent"]) for q in QUANTITIES),
            str(part["not_carried"]),
        )
    print_table(table)


def _percent(value: float | int | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def run(given: argparse.Namespace) -> int:
    """Run the test bed; 0 if every case was carried."""
    try:
        return _run(given)
    except MachineError as error:
        raise UsageError(str(error)) from error
