"""Closed forms of machines on tracks, each by another route."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from sojourn_analysis.vehicle.stability import tip_over_margin
from sojourn_analysis.vehicle.track_traction import (
    POINTS,
    TrackGround,
    footing,
    greatest_grade,
    mean_powers,
    pull,
    slip_on,
    steady_climb,
    thrust,
)
from sojourn_analysis.vehicle.track_turning import friction, sliding_moment, steady_turn, track_row
from sojourn_analysis.vehicle.tracked_vehicle import (
    TrackedVehicle,
    balanced_step,
    end_height,
    highest_step,
    tracked_vehicle_of,
    widest_trench,
)
from sojourn_analysis.vehicle.wheel_loads import StandingMachine
from sojourn_config.bundle import read_machine
from sojourn_config.vehicle import supply_of
from sojourn_machine.errors import InvalidValueError
from sojourn_machine.supports import TrackEndParams
from sojourn_physics.contact.passive_pressure import wall_resistance
from sojourn_physics.contact.rows import track_plates
from sojourn_physics.contact.track import track_shear
from sojourn_physics.contact.track_on_soil import PlateColumn
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import SoilColumn, kernel_table

SOILS = ("lunar_nominal", "dry_sand", "sandy_loam", "lean_clay")


def tracked_on(soil: str) -> TrackGround:
    bundle = read_machine("tracked", "moon", soil)
    machine = StandingMachine(bundle.urdf_xml, bundle.machine, bundle.gravity)
    vehicle = tracked_vehicle_of(machine, supply_of(bundle).voltage)
    return TrackGround(vehicle, kernel_table([bundle.soil])[0], bundle.gravity)


GROUNDS = {soil: tracked_on(soil) for soil in SOILS}
LUNAR = GROUNDS["lunar_nominal"]


def centred(ground: TrackGround, **changes: float) -> TrackGround:
    return ground._replace(vehicle=replace(ground.vehicle, ahead=0.0, **changes))


def slippery(ground: TrackGround, modulus: float) -> TrackGround:
    """Soil that slides after this displacement [m]."""
    soil = ground.soil.copy()
    soil[[SoilColumn.SHEAR_MODULUS, SoilColumn.SHEAR_MODULUS_LATERAL]] = modulus
    return ground._replace(soil=soil)


def test_sizes_are_those_of_its_files() -> None:
    """Tracks 0.72 m apart, 0.25 m below base_link; the mass is that of the URDF."""
    vehicle = LUNAR.vehicle
    assert vehicle.mass == pytest.approx(120.0) and vehicle.gauge == pytest.approx(0.72)
    assert vehicle.clearance == pytest.approx(0.25 - 0.12)
    assert (vehicle.inertia > 0.0).all() and vehicle.inertia.max() < vehicle.inertia.sum() - vehicle.inertia.max()
    assert vehicle.area == pytest.approx(2.0 * 0.16 * 0.70)


def test_tracks_that_are_not_two_alike_are_refused() -> None:
    bundle = read_machine("skid", "moon", "lunar_nominal")
    with pytest.raises(InvalidValueError, match="two alike"):
        tracked_vehicle_of(StandingMachine(bundle.urdf_xml, bundle.machine, bundle.gravity), 29.0)


@pytest.mark.parametrize("soil", SOILS)
def test_on_the_level_it_is_bekkers_pressure_and_the_law_in_one_piece(soil: str) -> None:
    ground = centred(GROUNDS[soil])
    level, track = footing(ground), ground.vehicle.track
    mean = ground.weight / ground.vehicle.area
    k, n = pressure_modulus(ground.soil, track.width), ground.soil[SoilColumn.N]
    assert k * level.depth**n == pytest.approx(mean * (1.0 + track.peakedness), rel=1e-6)
    assert level.compaction == pytest.approx(
        2.0 * track.width * quad(lambda z: k * z**n, 0.0, level.depth)[0], rel=1e-6
    )
    weight = ground.soil[SoilColumn.DENSITY] * ground.gravity
    wall = wall_resistance(level.depth, ground.soil[SoilColumn.COHESION], ground.soil[SoilColumn.TAN_PHI], weight)
    assert level.bulldozing == pytest.approx(2.0 * track.width * wall)
    for slip in (0.02, 0.2, 0.7):
        whole = 2.0 * track_shear(track_row(ground), ground.soil, mean, slip, 0.0, 0.0, 1.0)[0]
        assert thrust(ground, level, slip) == pytest.approx(whole, rel=2e-3)


@settings(deadline=None, max_examples=60)
@given(
    soil=st.sampled_from(SOILS),
    grade=st.floats(-0.5, 0.7),
    ahead=st.floats(-0.1, 0.1),
    peakedness=st.floats(0.0, 0.9),
)
@example(soil="lean_clay", grade=-0.21851210136229826, ahead=0.05872596419529966, peakedness=0.1329810794592457)
def test_the_pressure_carries_the_machine_on_a_grade(soil: str, grade: float, ahead: float, peakedness: float) -> None:
    """Forces and moments about the middle of the runs, by sums over the pressure alone."""
    ground = GROUNDS[soil]
    track = ground.vehicle.track.model_copy(update={"peakedness": peakedness})
    ground = ground._replace(vehicle=replace(ground.vehicle, ahead=ahead, track=track))
    lever = ahead - ground.vehicle.height * math.tan(grade)
    if abs(lever) > 0.4 * track.length:
        return
    found = footing(ground, grade)
    place = track.length * (0.5 - (np.arange(POINTS) + 0.5) / POINTS)
    carried = 2.0 * track.width * track.length * found.pressure / POINTS
    assert carried.sum() == pytest.approx(ground.weight * math.cos(grade), rel=1e-9)
    moment = float(carried @ place)
    assert moment == pytest.approx(ground.weight * math.cos(grade) * lever, abs=1e-6 * ground.weight)
    assert (found.pressure >= 0.0).all()


@given(slope=st.floats(0.0, 20.0), n=st.floats(0.2, 1.6))
def test_means_of_powers_add_up_to_the_integral(slope: float, n: float) -> None:
    reach = 1.0 if slope <= 1.0 else 1.0 / slope
    whole, _ = quad(lambda x: max(1.0 - slope * x, 0.0) ** n, 0.0, reach, epsabs=1e-13, epsrel=1e-12)
    assert mean_powers(slope, n).mean() == pytest.approx(whole, rel=1e-7)


@settings(deadline=None, max_examples=60)
@given(soil=st.sampled_from(SOILS), grade=st.floats(0.0, 0.5), slip=st.floats(0.001, 0.8))
def test_thrust_is_bounded_and_grows_with_slip(soil: str, grade: float, slip: float) -> None:
    ground = GROUNDS[soil]
    found = footing(ground, grade)
    strength = ground.soil[SoilColumn.COHESION] * ground.vehicle.area
    strength += ground.weight * math.cos(grade) * ground.soil[SoilColumn.TAN_PHI]
    here = thrust(ground, found, slip)
    assert 0.0 < here < strength
    assert thrust(ground, found, 1.1 * slip) >= here
    assert thrust(ground, found, -slip) == pytest.approx(-here)
    assert pull(ground, slip, grade) == pytest.approx(here - found.compaction - found.bulldozing)


@pytest.mark.parametrize("soil", SOILS)
def test_a_steady_climb_balances_the_weight(soil: str) -> None:
    ground, grade = GROUNDS[soil], math.radians(12.0)
    slip = slip_on(ground, grade)
    assert slip is not None
    assert pull(ground, slip, grade) == pytest.approx(ground.weight * math.sin(grade), rel=1e-6)
    steady = steady_climb(ground, 0.1, grade)
    found = footing(ground, grade)
    resisting = ground.weight * math.sin(grade) + found.compaction + found.bulldozing
    assert steady is not None and steady.torque == pytest.approx(
        0.5 * resisting * ground.vehicle.track.radius, rel=1e-6
    )
    # what the ground takes is less than what the motors draw
    assert steady.power > resisting * 0.1 / (1.0 - slip)


def test_the_steepest_grade_is_one_that_is_just_climbed() -> None:
    steepest, limit = greatest_grade(LUNAR, 0.05)
    assert limit == "traction"
    below, above = steady_climb(LUNAR, 0.05, steepest - 1e-3), steady_climb(LUNAR, 0.05, steepest + 1e-3)
    assert below is not None and below.feasible and above is None
    # on sand alone it cannot be steeper than the angle of friction
    soil = LUNAR.soil.copy()
    soil[SoilColumn.COHESION] = 0.0
    assert greatest_grade(LUNAR._replace(soil=soil), 0.05)[0] < math.atan(soil[SoilColumn.TAN_PHI])
    weak = replace(LUNAR.vehicle, motor=LUNAR.vehicle.motor.model_copy(update={"max_current": 0.6}))
    assert greatest_grade(LUNAR._replace(vehicle=weak), 0.05)[1] == "motor"
    tall = replace(LUNAR.vehicle, height=0.8)
    assert greatest_grade(GROUNDS["lean_clay"]._replace(vehicle=tall), 0.05)[1] == "tipping"


def test_tracks_that_slide_all_along_resist_a_turn_as_steeds_says() -> None:
    """By a narrow gauge and soil that slides at once the belts' own slip is small beside the sideways one."""
    ground = slippery(centred(LUNAR, gauge=2.0), 1e-5)
    turn = steady_turn(ground, 0.1, 0.0)
    assert sliding_moment(ground) == pytest.approx(friction(ground) * ground.weight * 0.70 / 4.0)
    assert turn.moment == pytest.approx(sliding_moment(ground), rel=0.02)
    assert turn.moment < sliding_moment(ground)


@settings(deadline=None, max_examples=40)
@given(soil=st.sampled_from(SOILS), radius=st.floats(0.0, 20.0), rate=st.floats(0.01, 0.3))
def test_a_turn_balances_and_pays_for_itself(soil: str, radius: float, rate: float) -> None:
    """Power of the sprockets = what both belts lose in sliding + what is pushed down and ahead; forces cancel."""
    ground = GROUNDS[soil]
    turn = steady_turn(ground, rate, radius)
    places = np.array([0.5, -0.5]) * ground.vehicle.gauge
    hull = rate * (radius - places)
    pulls = turn.thrusts - turn.resistance * np.sign(hull)
    assert pulls.sum() == pytest.approx(0.0, abs=1e-6 * ground.weight)
    assert turn.moments.sum() == pytest.approx(float(places @ pulls), abs=1e-6 * ground.weight)
    sliding = float(turn.thrusts @ (turn.belts - hull)) + rate * turn.moment
    assert sliding > 0.0
    assert turn.power == pytest.approx(sliding + turn.resistance * float(np.abs(hull).sum()), rel=1e-6)
    # the same path at another speed takes the same forces
    faster = steady_turn(ground, 2.0 * rate, radius)
    assert faster.thrusts == pytest.approx(turn.thrusts, rel=1e-5, abs=1e-4 * ground.weight)


def test_moment_falls_with_the_radius_to_none() -> None:
    moments = [steady_turn(LUNAR, 0.1, radius).moment for radius in (0.0, 1.0, 3.0, 10.0, 100.0, 1000.0)]
    assert all(after < before for before, after in pairwise(moments))
    assert moments[-1] < 0.02 * moments[0]


def test_a_turn_that_is_none_is_refused() -> None:
    for rate, radius in ((0.0, 1.0), (-0.1, 1.0), (0.1, -1.0), (0.1, math.nan)):
        with pytest.raises(InvalidValueError):
            steady_turn(LUNAR, rate, radius)


@given(angle=st.floats(5.0, 85.0), length=st.floats(0.0, 0.5), radius=st.floats(0.02, 0.5))
def test_the_end_is_as_high_as_its_plates(angle: float, length: float, radius: float) -> None:
    end = TrackEndParams(angle_deg=angle, length=length, radius=radius)
    track = LUNAR.vehicle.track.model_copy(update={"front": end, "rear": end, "plates": 200})
    plates = track_plates(track)
    assert end_height(end) == pytest.approx(plates[:, PlateColumn.Z].max(), abs=track.length / track.plates)


def _comes_over(vehicle: TrackedVehicle, height: float) -> bool:
    """Whether there is a pitch at which the centre of mass is past the edge that the run lies on."""
    for pitch in np.linspace(1e-3, 1.5, 3000):
        along = height / math.sin(pitch)
        ahead = (0.5 * vehicle.track.length + vehicle.ahead) * math.cos(pitch) - vehicle.height * math.sin(pitch)
        if ahead >= along * math.cos(pitch):
            return True
    return False


@settings(deadline=None, max_examples=30)
@given(ahead=st.floats(-0.2, 0.2), height=st.floats(0.05, 0.6))
def test_the_balanced_step_is_the_highest_of_a_search(ahead: float, height: float) -> None:
    vehicle = replace(LUNAR.vehicle, ahead=ahead, height=height)
    highest = balanced_step(vehicle)
    assert _comes_over(vehicle, 0.999 * highest) and not _comes_over(vehicle, 1.001 * highest)
    assert highest_step(vehicle) == min(highest, end_height(vehicle.track.front))


def test_a_trench_is_narrower_the_further_the_mass_is_off_the_middle() -> None:
    """A machine that stands on both edges with its mass in the middle of what is left bears half of its run free."""
    assert widest_trench(replace(LUNAR.vehicle, ahead=0.0)) == pytest.approx(0.35)
    assert widest_trench(replace(LUNAR.vehicle, ahead=0.1)) == pytest.approx(0.25)
    assert widest_trench(replace(LUNAR.vehicle, ahead=-0.1)) == pytest.approx(0.25)


def test_corners_give_the_least_tip_over_angle() -> None:
    vehicle = LUNAR.vehicle
    contacts = np.column_stack([vehicle.corners, np.zeros(4)])[None]
    margin = float(tip_over_margin(contacts, np.ones((1, 4), bool), np.array([[0.0, 0.0, vehicle.height]]))[0])
    assert math.tan(margin) == pytest.approx((0.35 - abs(vehicle.ahead)) / vehicle.height)
