"""The data sheet of a rover, written or printed: the work of scripts/rover_datasheet."""

import argparse
import json
import math
from pathlib import Path
from typing import Any

from sojourn_analysis.datasheet.sheet import Datasheet, datasheet
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.vehicle.from_machine import Supply, vehicle_of
from sojourn_analysis.vehicle.params import VehicleParams
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_config.bundle import Bundle, read_machine
from sojourn_config.command_errors import UsageError
from sojourn_config.errors import single
from sojourn_config.load import load_params
from sojourn_config.paths import available
from sojourn_machine.errors import MachineError
from sojourn_machine.names import names_text
from sojourn_machine.power.battery import open_circuit_voltage
from sojourn_physics.environment.body import BodyParams
from sojourn_physics.soil.params import SoilParams
from sojourn_studies.linear_rover import linear_plants

STOWED = "stow"
"""Pose of the arm, if it has one of this name."""


def subject_of(rover: str, body: str, soil: str) -> Subject:
    """A rover of `config/rovers` (from its URDF) or a vehicle of `config/vehicles`.

    Raises:
        ConfigError: an unknown name, or files that do not fit together.
    """
    if rover in available("vehicles") and rover not in available("rovers"):
        return Subject(
            load_params("vehicles", rover, VehicleParams),
            load_params("soils", soil, SoilParams),
            load_params("bodies", body, BodyParams),
        )
    names = sorted({*available("rovers"), *available("vehicles")})
    if rover not in names and not Path(rover).is_file():
        raise single("command line", "rover", rover, names_text(rover, names))
    bundle = read_machine(rover, body, soil)
    machine = StandingMachine(bundle.urdf_xml, bundle.rover, bundle.gravity)
    angles = bundle.arm_pose(STOWED)
    if rover in available("vehicles"):  # it has published figures, and what a rover's files do not tell
        vehicle = load_params("vehicles", rover, VehicleParams)
    else:
        vehicle = vehicle_of(Path(rover).stem, machine, supply_of(bundle), bundle.drive.limits.max_speed, angles)
    standing, driving = linear_plants(bundle, angles, vehicle.cruise_speed)
    return Subject(vehicle, bundle.soil, bundle.body, machine, angles, standing, driving)


def supply_of(bundle: Bundle) -> Supply:
    """Voltage of the half full battery, the energy of the full one, and what the loads beside the motors take."""
    house = sum(load.power_w for load in bundle.bus.loads if load.kind != "commanded")
    return Supply(open_circuit_voltage(bundle.battery, 0.5), bundle.battery.energy_capacity_wh, house)


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
    subject = subject_of(given.rover, given.body, given.soil)
    try:
        sheet = datasheet(subject)
    except MachineError as error:
        raise UsageError(f"{given.rover} on {given.soil}, {given.body}: {error}") from error
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
