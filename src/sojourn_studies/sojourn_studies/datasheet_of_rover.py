"""The data sheet of a rover, written or printed: the work of scripts/rover_datasheet."""

import argparse
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from sojourn_analysis.datasheet.afloat import afloat
from sojourn_analysis.datasheet.motors import motors_of
from sojourn_analysis.datasheet.on_tracks import TrackedSubject, tracked_sections
from sojourn_analysis.datasheet.sheet import Datasheet, datasheet
from sojourn_analysis.datasheet.subject import Subject
from sojourn_analysis.vehicle.tracked_vehicle import tracked_vehicle_of
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_config.bundle import read_machine
from sojourn_config.command_errors import UsageError
from sojourn_config.machine import MachineConfig
from sojourn_config.machine_body import STOWED
from sojourn_config.machine_reader import machine_config
from sojourn_config.vehicle import supply_of, vehicle_of_machine
from sojourn_machine.drives import JointDriveParams
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


def tracked_subject_of(machine: str, body: str, soil: str) -> TrackedSubject:
    """A machine of `config/machines` on tracks, or that in a folder. Raises as `subject_of`."""
    bundle = read_machine(machine, body, soil)
    standing = StandingMachine(bundle.urdf_xml, bundle.machine, bundle.gravity)
    vehicle = tracked_vehicle_of(standing, supply_of(bundle).voltage, bundle.arm_pose(STOWED))
    limits = bundle.drive.limits
    return TrackedSubject(standing, vehicle, bundle.soil, bundle.body, limits.max_speed, limits.max_yaw_rate)


class Told(NamedTuple):
    """What a sheet tells."""

    name: str
    figures: dict[str, Any]
    """As plain data, for JSON."""
    sheet: Datasheet
    lead: list[str]
    sources: str


def of_a_rover(machine: str, body: str, soil: str) -> Told:
    """All figures of a machine that drives. Raises as `subject_of`."""
    subject = subject_of(machine, body, soil)
    try:
        sheet = datasheet(subject)
    except MachineError as error:
        raise UsageError(f"{machine} on {soil}, {body}: {error}") from error
    lead = [
        f"On soil {subject.soil.name}, {subject.body.name} (gravity {subject.gravity:.3f} m/s²). Computed from the "
        "vehicle's files; nothing here is measured."
    ]
    if subject.vehicle.estimates:
        lead.append("Estimates, for want of a source: " + ", ".join(subject.vehicle.estimates) + ".")
    figures = {
        "vehicle": subject.vehicle.name,
        "body": subject.body.name,
        "soil": subject.soil.name,
        "figures": _figures(sheet),
        "published": [
            {**entry._asdict(), "own": _plain(entry.own), "published": list(entry.published)}
            for entry in sheet.comparisons
        ],
    }
    return Told(subject.vehicle.name, figures, sheet, lead, subject.vehicle.citation)


def of_tracks(machine: str, body: str, soil: str) -> Told:
    """Of a machine on tracks.

    Raises:
        ConfigError: files that do not fit together.
        UsageError: a soil that the closed forms of tracks do not take.
    """
    subject = tracked_subject_of(machine, body, soil)
    try:
        sheet = Datasheet(tracked_sections(subject), ())
    except MachineError as error:
        raise UsageError(f"{machine} on {soil}, {body}: {error}") from error
    lead = [
        f"On soil {subject.soil.name}, {subject.body.name} (gravity {subject.ground.gravity:.3f} m/s²), on two tracks. "
        "Computed from the machine's files; nothing here is measured."
    ]
    name = Path(machine).name
    figures = {"vehicle": name, "body": subject.body.name, "soil": subject.soil.name, "figures": _figures(sheet)}
    return Told(name, figures, sheet, lead, f"config/machines/{name}")


def of_its_drives(machine: str, body: str, soil: str) -> Told:
    """Of a machine that stands fast, or moves by drives whose closed forms are not known: its drives alone.

    Raises:
        ConfigError: files that do not fit together, such as an arm that cannot hold itself on that body.
    """
    bundle = read_machine(machine, body, soil)
    sheet = Datasheet((motors_of(bundle.machine.drives, supply_of(bundle).voltage),), ())
    forms = "The closed forms of driving are those of a motor with its gear"
    why = "It stands fast" if bundle.machine.fixed_base else forms
    lead = [f"{why}: its drives, computed from its files; nothing here is measured."]
    figures = {"vehicle": machine, "body": body, "figures": _figures(sheet)}
    return Told(Path(machine).name, figures, sheet, lead, f"config/machines/{Path(machine).name}")


def of_a_spacecraft(machine: str, body: str, soil: str) -> Told:
    """Of a machine that floats: how its base gives way, and its drives. Raises ConfigError."""
    bundle = read_machine(machine, body, soil)
    arm = bundle.carried_arm()
    postures = {name: bundle.arm_pose(name) for name in arm.named_poses if name != STOWED}
    reaction = afloat(bundle.urdf_xml, arm.tip_link, postures)
    sheet = Datasheet((reaction, motors_of(bundle.machine.drives, supply_of(bundle).voltage)), ())
    lead = [
        "It floats free: its base under its arm, and its drives, computed from its files; nothing here is measured."
    ]
    figures = {"vehicle": machine, "body": body, "figures": _figures(sheet)}
    return Told(Path(machine).name, figures, sheet, lead, f"config/machines/{Path(machine).name}")


def _figures(sheet: Datasheet) -> dict[str, Any]:
    """Numbers, words, or null where a figure does not apply or is without bound."""
    return {
        figure.key: {"value": _plain(figure.value), "unit": figure.unit, "label": figure.label, "note": figure.note}
        for section in sheet.sections
        for figure in section.figures
    }


def _plain(value: float | str | None) -> float | str | None:
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _teller(config: MachineConfig) -> Callable[[str, str, str], Told]:
    if config.floats:
        return of_a_spacecraft
    moving = {wheel.joint for wheel in config.wheels} | {track.joint for track in config.tracks}
    geared = all(isinstance(drive, JointDriveParams) for drive in config.drives if moving & set(drive.joints))
    if config.fixed_base or not geared:
        return of_its_drives
    return of_tracks if config.tracks and not config.wheels else of_a_rover


def run(given: argparse.Namespace) -> int:
    """Compute the sheet and write or print it."""
    config = machine_config(given.machine)
    body = given.body or ("low_earth_orbit" if config.floats else "moon")
    told = _teller(config)(given.machine, body, given.soil)
    if given.json:
        print(json.dumps(told.figures, indent=2, ensure_ascii=False))
        if given.out is None:
            return 0
    # here and not above: it loads matplotlib, which the figures alone do not need
    from sojourn_studies.datasheet_page import page

    out = given.out or Path(f"{told.name}_datasheet.html")
    try:
        out.write_text(page(told.sheet, f"{told.name}: data sheet", told.lead, told.sources), encoding="utf-8")
    except OSError as error:
        raise UsageError(f"--out {out}: cannot be written: {error.strerror}") from error
    if not given.json:
        print(f"{out} written: {sum(len(section.figures) for section in told.sheet.sections)} figures")
    return 0
