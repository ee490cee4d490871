"""The data sheet of a rover, written or printed: the work of scripts/rover_datasheet."""

import argparse
import json
import math
from pathlib import Path
from typing import Any

from sojourn_analysis.datasheet.sheet import Datasheet, datasheet
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_config.bundle import read_machine
from sojourn_config.command_errors import UsageError
from sojourn_config.scenario import STOWED
from sojourn_config.vehicle import vehicle_of_machine
from sojourn_machine.errors import MachineError
from sojourn_studies.linear_rover import linear_plants


def subject_of(machine: str, body: str, soil: str) -> Subject:
    """A machine of `config/machines` that drives, or that in a folder.

    Raises:
        ConfigError: an unknown name, or files that do not fit together.
    """
    bundle = read_machine(machine, body, soil)
    standing_machine = StandingMachine(bundle.urdf_xml, bundle.machine, bundle.gravity)
    angles = bundle.arm_pose(STOWED)
    vehicle = vehicle_of_machine(machine, bundle, standing_machine)
    standing, driving = linear_plants(bundle, angles, vehicle.cruise_speed)
    return Subject(vehicle, bundle.soil, bundle.body, standing_machine, angles, standing, driving)


def figures_of(sheet: Datasheet, subject: Subject) -> dict[str, Any]:
    """The figures as plain data: numbers, words, or null where a figure does not apply or is without bound."""
    return {
        "vehicle": subject.vehicle.name,
        "body": subject.body.name,
        "soil": subject.soil.name,
        "figures": {
            figure.key: {"value": _plain(figure.value), "unit": figure.unit, "label": figure.label, "note": figure.note}
            for section in sheet.sections
            for figure in section.figures
        },
        "published": [
            {**entry._asdict(), "own": _plain(entry.own), "published": list(entry.published)}
            for entry in sheet.comparisons
        ],
    }


def _plain(value: float | str | None) -> float | str | None:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def run(given: argparse.Namespace) -> int:
    """Compute the sheet and write or print it."""
    subject = subject_of(given.machine, given.body, given.soil)
    try:
        sheet = datasheet(subject)
    except MachineError as error:
        raise UsageError(f"{given.machine} on {given.soil}, {given.body}: {error}") from error
    if given.json:
        print(json.dumps(figures_of(sheet, subject), indent=2, ensure_ascii=False))
        if given.out is None:
            return 0
    # here and not above: it loads matplotlib, which the figures alone do not need
    from sojourn_studies.datasheet_page import page

    out = given.out or Path(f"{subject.vehicle.name}_datasheet.html")
    title = f"{subject.vehicle.name}: data sheet"
    lead = [
        f"On soil {subject.soil.name}, {subject.body.name} (gravity {subject.gravity:.3f} m/s²). Computed from the "
        "vehicle's files; nothing here is measured."
    ]
    if subject.vehicle.estimates:
        lead.append("Estimates, for want of a source: " + ", ".join(subject.vehicle.estimates) + ".")
    try:
        out.write_text(page(sheet, title, lead, subject.vehicle.citation), encoding="utf-8")
    except OSError as error:
        raise UsageError(f"--out {out}: cannot be written: {error.strerror}") from error
    if not given.json:
        print(f"{out} written: {sum(len(section.figures) for section in sheet.sections)} figures")
    return 0
