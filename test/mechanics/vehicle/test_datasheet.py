"""The data sheet: its figures against the models behind them, the published ones, and machines of the plant."""

import math

import numpy as np
import pytest

from sojourn_config.bundle import read_machine
from sojourn_config.load import load_params
from sojourn_mechanics.environment.body import BodyParams
from sojourn_mechanics.errors import InvalidValueError
from sojourn_mechanics.soil.params import SoilParams
from sojourn_mechanics.vehicle.datasheet.figures import Section
from sojourn_mechanics.vehicle.datasheet.sheet import Datasheet, compare, datasheet
from sojourn_mechanics.vehicle.datasheet.standing import standing, tip_over_angles
from sojourn_mechanics.vehicle.datasheet.subject import Subject
from sojourn_mechanics.vehicle.datasheet.turning import steering
from sojourn_mechanics.vehicle.from_machine import Supply, vehicle_of
from sojourn_mechanics.vehicle.longitudinal import loads
from sojourn_mechanics.vehicle.params import PublishedFigure, VehicleParams
from sojourn_mechanics.vehicle.wheel_loads import StandingMachine


@pytest.fixture(scope="module")
def rover() -> Subject:
    """The lunar roving vehicle."""
    return Subject(
        load_params("vehicles", "lrv", VehicleParams),
        load_params("soils", "lunar_nominal", SoilParams),
        load_params("bodies", "moon", BodyParams),
    )


@pytest.fixture(scope="module")
def sheet(rover: Subject) -> Datasheet:
    return datasheet(rover)


@pytest.fixture(scope="module")
def explorer() -> Subject:
    bundle = read_machine("explorer", "moon", "lunar_nominal")
    machine = StandingMachine(bundle.urdf_xml, bundle.rover, bundle.gravity)
    angles = dict(zip(bundle.arm.joint_names, bundle.arm.named_poses["stow"], strict=True))
    vehicle = vehicle_of("explorer", machine, Supply(29.0, 473.0, 80.0), 0.1, angles)
    return Subject(vehicle, bundle.soil, bundle.body, machine, angles)


def values(*sections: Section) -> dict[str, float | str | None]:
    return {figure.key: figure.value for section in sections for figure in section.figures}


def test_every_figure_has_its_own_key(sheet: Datasheet) -> None:
    keys = [figure.key for section in sheet.sections for figure in section.figures]
    assert len(keys) == len(set(keys)) > 60
    assert {section.title for section in sheet.sections} >= {"Standing", "Steps", "Energy", "Steering", "Ride"}
    for section in sheet.sections:
        for curve in section.curves:
            for x, y in curve.lines.values():
                assert x.shape == y.shape and np.isfinite(x).all() and np.isfinite(y).any()


def test_published_figures_of_the_lunar_rover(sheet: Datasheet) -> None:
    """All but the range, for which the design value holds a reserve, agree."""
    assert len(sheet.comparisons) >= 6
    assert {entry.label for entry in sheet.comparisons if not entry.inside} == {"Range at cruise, level"}


def test_range_is_battery_over_energy(sheet: Datasheet, rover: Subject) -> None:
    found = values(*sheet.sections)
    assert found["greatest_range"] == pytest.approx(rover.vehicle.battery_energy_wh / found["energy_per_km"])
    assert found["bus_power"] == pytest.approx(found["energy_per_km"] * found["cruise_speed"])
    assert found["bus_power"] == pytest.approx(found["drive_power"] + found["house_power"])


def test_energy_of_the_lunar_rover_by_every_law(sheet: Datasheet) -> None:
    """Published: 59 to 76 Wh/km. By Bekker and Janosi, and with the rear wheels of mesh in the ruts of the front ones.

    Rim stresses of rigid wheels on fresh soil need a third more.
    """
    found = values(*sheet.sections)
    assert 59.0 < found["energy_per_km"] < 76.0
    assert 59.0 < found["energy_per_km_in_ruts"] < 80.0
    assert found["energy_per_km_in_ruts"] < found["energy_per_km_fresh"]
    assert found["energy_per_km_fresh"] == found["energy_per_km_contact_model_of_the_plant"]
    assert 95.0 < found["energy_per_km_rim_stress"] < 105.0
    assert found["energy_per_km_rigid_in_ruts"] < 0.95 * found["energy_per_km_rim_stress"]


def test_tip_over_in_every_direction(rover: Subject) -> None:
    """Over the sides half the track counts, over the ends half the wheelbase, over a corner the diagonal."""
    angles = tip_over_angles(rover, np.array([0.0, 0.5 * math.pi, math.atan2(0.9145, 1.143)]))
    assert np.tan(angles) * rover.vehicle.height == pytest.approx([1.143, 0.9145, math.hypot(1.143, 0.9145)])


def test_an_unknown_published_figure_is_refused(sheet: Datasheet) -> None:
    wrong = PublishedFigure(figure="colour", low=1.0, high=1.0, source="nobody")
    with pytest.raises(InvalidValueError, match="colour"):
        compare((wrong,), sheet.sections)


def test_ground_on_which_it_cannot_drive(rover: Subject) -> None:
    """Heavy on Venus, in clay: the sheet says so and compares nothing."""
    stuck = Subject(
        rover.vehicle, load_params("soils", "clayey_soil", SoilParams), load_params("bodies", "venus", BodyParams)
    )
    found = datasheet(stuck)
    figures = values(*found.sections)
    assert figures["energy_per_km"] is None and figures["greatest_range"] is None
    assert found.comparisons == ()


def test_the_explorer_is_that_of_its_urdf(explorer: Subject) -> None:
    vehicle = explorer.vehicle
    assert vehicle.mass == pytest.approx(180.0)
    assert vehicle.wheelbase == pytest.approx(1.41)
    assert [axle.track for axle in vehicle.axles] == pytest.approx([1.06, 1.06, 1.06], abs=0.01)
    assert [axle.max_steer > 0.0 for axle in vehicle.axles] == [True, False, True]
    assert vehicle.clearance == pytest.approx(0.30)
    assert explorer.law == "rim stress" and vehicle.equalising


def test_the_explorer_shares_its_load_and_turns_on_the_spot(explorer: Subject) -> None:
    course = explorer.course()
    level = loads(course, 0.0)
    assert level.sum() * 2.0 == pytest.approx(180.0 * explorer.gravity)
    assert level == pytest.approx(np.full(3, level.mean()), rel=0.03)
    up = loads(course, math.radians(15.0))
    assert up.sum() * 2.0 == pytest.approx(180.0 * explorer.gravity * math.cos(math.radians(15.0)))
    assert up[0] < up[2]
    found = values(steering(explorer), standing(explorer))
    assert found["turn_on_spot"] == "yes"
    assert found["tip_over_least"] > 45.0  # as its class was built
