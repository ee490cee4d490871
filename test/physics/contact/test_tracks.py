"""Tracks in plates: against the closed forms of a level track, and what only plates can do."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_analysis.wheels.examples import example_row
from sojourn_machine.contact_report import REPORT_COLUMNS, ReportColumn
from sojourn_machine.params import FloatArray
from sojourn_machine.supports import TrackEndParams, TrackParams
from sojourn_machine.vectors import cross
from sojourn_physics.contact.contact_law import STATE_COLUMNS, StateColumn, WheelColumn
from sojourn_physics.contact.contact_set import contact_forces
from sojourn_physics.contact.hysteresis import ON_BACKBONE
from sojourn_physics.contact.passive_pressure import wall_resistance
from sojourn_physics.contact.rows import track_plates, track_rows
from sojourn_physics.contact.tables import Ground, Kinematics, Touch, TrackTable, make_workspace
from sojourn_physics.contact.track import LevelTrackColumn, track_shear
from sojourn_physics.contact.track_on_soil import RUT, PlateColumn
from sojourn_physics.contact.wheel_on_soil import pressure_modulus
from sojourn_physics.soil.params import SoilColumn
from sojourn_physics.terrain.memory import GroundMemory, MemoryBoard

from .conftest import carried, one_state, soil_table, supports, turned

LENGTH, WIDTH, RADIUS, GRAVITY = 0.9, 0.2, 0.1, 1.62
STEEP = TrackEndParams(angle_deg=85.0, length=0.0, radius=0.02)
BODY_AND_SPROCKET = np.hstack([np.eye(6), np.zeros((6, 1))])
"""Jacobian of the body, which six coordinates move and the sprocket's does not."""
RISING = TrackEndParams(angle_deg=30.0, length=0.25, radius=0.1)


def track(**changes: object) -> TrackParams:
    given = {"front": STEEP, "rear": STEEP, "plates": 18, **changes}
    return TrackParams(
        name="left", joint="sprocket", link="base_link", position=(0.0, 0.0, 0.0), radius=RADIUS, length=LENGTH,
        width=WIDTH, **given,
    )  # fmt: skip


@dataclass
class TrackRig:
    """One track that is held and moved by hand: six coordinates of its body, one of its sprocket."""

    params: TrackParams
    soil: FloatArray
    heights: Callable[[FloatArray, FloatArray], FloatArray] = field(default=lambda x, y: 0.0 * x)
    cell: float = 0.0
    dt: float = 0.002

    def __post_init__(self) -> None:
        self.grid = np.array([-10.0, -10.0, 0.05, 0.0])
        axis = -10.0 + 0.05 * np.arange(401)
        x, y = np.meshgrid(axis, axis)
        plates = track_plates(self.params)
        belts = np.array([[6, 0, len(plates)]], dtype=np.int64)
        table = TrackTable(track_rows([self.params], GRAVITY), belts, plates, carried(1))
        self.supports = supports(tracks=table)
        self.states: FloatArray = np.zeros((len(plates), STATE_COLUMNS))
        self.report = np.zeros((1, REPORT_COLUMNS))
        self.memory = MemoryBoard(GroundMemory(self.cell, -10.0, -10.0))
        self.ground = Ground(
            np.asarray(self.heights(x, y)), np.zeros(x.shape, np.uint8), self.grid, self.soil[np.newaxis, :],
            self.memory.tables,
        )  # fmt: skip
        self.on_map = True

    def push(
        self,
        centre: FloatArray,
        velocity: FloatArray,
        belt: float,
        yaw_rate: float = 0.0,
        rotation: FloatArray | None = None,
    ) -> FloatArray:
        """Force and moment about its middle and torque of the sprocket, (7,), after one step of this motion."""
        turned_by = np.eye(3) if rotation is None else rotation
        placement = np.concatenate([turned_by.T.reshape(-1), centre])[np.newaxis, :]
        turning = np.array([0.0, 0.0, yaw_rate])
        rates = np.concatenate([velocity - cross(turning, centre), turning, [belt / RADIUS]])
        force = np.zeros(7)
        workspace = make_workspace(self.soil[np.newaxis, :])
        touch = Touch(one_state(self.supports, self.states), self.report, force, workspace)
        machine = Kinematics(placement, BODY_AND_SPROCKET, rates)
        ground = self.ground._replace(memory=self.memory.tables)
        self.on_map = contact_forces(self.supports, ground, machine, self.dt, touch)
        force[3:6] -= cross(centre, force[:3])
        return force

    def roll(self, depth: float, speed: float, belt: float, way: float, yaw_rate: float = 0.0) -> FloatArray:
        """The last push of so much way [m] of the belt at a depth below z = 0, the ground being level."""
        for _ in range(round(way / (abs(belt) * self.dt))):
            found = self.push(np.array([0.0, 0.0, -depth]), np.array([speed, 0.0, 0.0]), belt, yaw_rate)
        return found


def level(soil: str, **changes: object) -> TrackRig:
    return TrackRig(track(**changes), soil_table(soil, damping=0.0)[0])


@pytest.mark.parametrize("soil", ["lunar_nominal", "sandy_loam", "lean_clay"])
@pytest.mark.parametrize("slip", [0.03, 0.2, 0.7])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_level_track_in_steady_rolling_is_the_closed_form(soil: str, slip: float, sense: float) -> None:
    """Thrust of the law in one piece, integrated by a rule of its own; resistances of compaction and of a wall."""
    rig, depth, belt = level(soil, plates=36), 0.01, 0.5 * sense
    found = rig.roll(depth, belt * (1.0 - slip), belt, 8.0 * LENGTH / (1.0 - slip))
    row = example_row("track")
    row[WheelColumn.WIDTH], row[LevelTrackColumn.LENGTH], row[LevelTrackColumn.PEAKEDNESS] = WIDTH, LENGTH, 0.0
    k, n = pressure_modulus(rig.soil, WIDTH), rig.soil[SoilColumn.N]
    load = WIDTH * LENGTH * k * depth**n
    assert found[2] == pytest.approx(load, rel=1e-6)
    thrust = track_shear(row, rig.soil, load / (WIDTH * LENGTH), slip, 0.0, 0.0, 1.0)[0]
    assert -found[6] / RADIUS == pytest.approx(sense * thrust, rel=5e-3)
    compaction = WIDTH * k * depth ** (n + 1.0) / (n + 1.0)
    weight = rig.soil[SoilColumn.DENSITY] * GRAVITY
    wall = WIDTH * wall_resistance(depth, rig.soil[SoilColumn.COHESION], rig.soil[SoilColumn.TAN_PHI], weight)
    assert rig.report[0, ReportColumn.COMPACTION_RESISTANCE] == pytest.approx(compaction, rel=1e-3)
    assert rig.report[0, ReportColumn.BULLDOZING_RESISTANCE] == pytest.approx(wall, rel=1e-3)
    assert found[0] == pytest.approx(sense * (thrust - compaction - wall), rel=5e-3, abs=5e-3 * thrust)
    assert rig.report[0, ReportColumn.SLIP_RATIO] == pytest.approx(slip)


def test_plates_converge_to_the_closed_form() -> None:
    """Of second order in the pitch: four times as many plates, a tenth of the error at least."""
    errors = []
    for plates in (4, 16):
        rig = level("lunar_nominal", plates=plates)
        found = rig.roll(0.01, 0.4, 0.5, 10.0 * LENGTH)
        modulus = rig.soil[SoilColumn.SHEAR_MODULUS]
        strength = WIDTH * LENGTH * rig.soil[SoilColumn.COHESION] + found[2] * rig.soil[SoilColumn.TAN_PHI]
        j = 0.2 * LENGTH / modulus
        errors.append(abs(-found[6] / RADIUS - strength * (1.0 - (1.0 - math.exp(-j)) / j)) / strength)
    assert errors[1] < 0.1 * errors[0] + 4e-4  # what a dragged link forgets


def test_a_turn_on_the_spot_meets_the_friction_of_its_length() -> None:
    """Sliding all along: mu W l / 4 (Steeds 1950), and nothing aside."""
    soil = soil_table("lunar_nominal", damping=0.0)[0]
    soil[SoilColumn.COHESION] = 0.0
    soil[[SoilColumn.SHEAR_MODULUS, SoilColumn.SHEAR_MODULUS_LATERAL]] = 1e-4
    rig = TrackRig(track(plates=60), soil)
    for _ in range(2000):
        found = rig.push(np.array([0.0, 0.0, -0.01]), np.zeros(3), 0.0, yaw_rate=0.5)
    assert found[5] == pytest.approx(-soil[SoilColumn.TAN_PHI] * found[2] * LENGTH / 4.0, rel=0.01)
    assert abs(found[1]) < 1e-9 * found[2]


@pytest.mark.parametrize("turn", [0.02, 0.05])
def test_a_turning_track_is_the_closed_form(turn: float) -> None:
    """Side force and moment of a track that runs ahead with slip and turns: Wong & Chiang's shear by the local slip."""
    rig, belt = level("sandy_loam", plates=36), 0.5
    slip = 5.0 * rig.soil[SoilColumn.SHEAR_MODULUS] / LENGTH  # no link comes to the largest shear that it remembers
    rig.states[:, StateColumn.LARGEST_SHEAR] = ON_BACKBONE  # shear whose direction turns is no loop here
    found = rig.roll(0.01, belt * (1.0 - slip), belt, 10.0 * LENGTH, yaw_rate=turn * belt)
    x = (np.arange(2000) + 0.5) / 2000 - 0.5
    passed = (0.5 - x) * LENGTH  # what a point of the belt has run since it came down
    # v_side = yaw rate times x: what a link has been dragged aside on its way from the front to x
    j_x = slip * passed / rig.soil[SoilColumn.SHEAR_MODULUS]
    j_y = -turn * (0.25 * LENGTH**2 - (x * LENGTH) ** 2) / 2.0 / rig.soil[SoilColumn.SHEAR_MODULUS_LATERAL]
    j = np.hypot(j_x, j_y)
    area = WIDTH * LENGTH
    mean = found[2] / area
    tau = (rig.soil[SoilColumn.COHESION] + mean * rig.soil[SoilColumn.TAN_PHI]) * -np.expm1(-j) / j
    assert -found[6] / RADIUS == pytest.approx(area * np.mean(tau * j_x), rel=0.01)
    assert found[1] == pytest.approx(area * np.mean(tau * j_y), rel=0.02)
    assert found[5] == pytest.approx(area * np.mean(tau * j_y * x * LENGTH), rel=0.05, abs=1e-3 * area * LENGTH * mean)


@pytest.mark.parametrize("pitch", [-0.02, 0.02])
def test_a_pitched_track_is_righted(pitch: float) -> None:
    rig = level("lunar_nominal")
    found = rig.push(np.array([0.0, 0.0, -0.01]), np.zeros(3), 0.0, rotation=turned("y", pitch))
    assert found[4] * pitch < 0.0
    assert found[2] > 0.0


@pytest.mark.parametrize("slope", [0.0, 0.3])
def test_on_a_slope_all_is_turned_with_it(slope: float) -> None:
    """The same track on a plane that is tilted: the same forces in its axes."""
    soil = soil_table("lunar_nominal", damping=0.0)[0]
    flat = TrackRig(track(), soil)
    tilted = TrackRig(track(), soil, heights=lambda x, y: math.tan(slope) * x)
    rotation = turned("y", -slope)
    for _ in range(2000):
        one = flat.push(np.array([0.0, 0.0, -0.01]), np.array([0.4, 0.0, 0.0]), 0.5)
        other = tilted.push(
            rotation @ np.array([0.0, 0.0, -0.01]), rotation @ np.array([0.4, 0.0, 0.0]), 0.5, rotation=rotation
        )
    assert np.allclose(rotation.T @ other[:3], one[:3], rtol=2e-3, atol=1e-3 * one[2])
    assert other[6] == pytest.approx(one[6], rel=2e-3)


def test_a_parked_track_stays_as_it_is() -> None:
    rig = level("lunar_nominal")
    rig.roll(0.01, 0.4, 0.5, LENGTH)
    centre = np.array([0.0, 0.0, -0.01])
    rig.push(centre, np.zeros(3), 0.0)
    states = rig.states.copy()
    first = rig.push(centre, np.zeros(3), 0.0)
    for _ in range(500):
        last = rig.push(centre, np.zeros(3), 0.0)
    assert np.array_equal(first, last) and np.array_equal(rig.states, states)


def test_a_track_that_leaves_the_ground_forgets(rig_height: float = 0.05) -> None:
    rig = level("lunar_nominal")
    rig.roll(0.01, 0.4, 0.5, LENGTH)
    found = rig.push(np.array([0.0, 0.0, rig_height]), np.zeros(3), 0.0)
    assert not found.any() and not rig.states[:, StateColumn.SHEAR_ALONG].any()


def test_off_the_map_is_told() -> None:
    rig = level("lunar_nominal")
    rig.push(np.array([0.0, 11.0, -0.01]), np.zeros(3), 0.0)
    assert not rig.on_map


def test_plates_lie_on_the_outline() -> None:
    """Evenly along it, from the upright front over the flat run to the rear; the rear is the front's mirror image."""
    params = track(front=RISING, rear=RISING, plates=10)
    plates = track_plates(params)
    centres = plates[:, [PlateColumn.X, PlateColumn.Z]]
    pitch = LENGTH / 10
    assert np.allclose(np.hypot(*np.diff(centres, axis=0).T), pitch, rtol=0.06)  # chords of what is bent
    assert np.allclose(plates[::-1][:, PlateColumn.X], -plates[:, PlateColumn.X])
    assert np.allclose(plates[::-1][:, PlateColumn.Z], plates[:, PlateColumn.Z])
    assert np.allclose(np.hypot(plates[:, PlateColumn.AHEAD_X], plates[:, PlateColumn.AHEAD_Z]), 1.0)
    ahead = np.diff(centres, axis=0)[::-1] * -1.0
    assert plates[0, PlateColumn.AHEAD_Z] > 0.9 and plates[-1, PlateColumn.AHEAD_Z] < -0.9
    assert (ahead @ np.array([1.0, 0.0]) >= -1e-12).all()


def test_a_second_pass_sinks_less() -> None:
    """A track rolls over ground that remembers, and comes again: in the rut the same depth bears more."""
    rig = TrackRig(track(front=RISING, rear=RISING), soil_table("lunar_nominal", damping=0.0)[0], cell=0.05)
    loads, lowered = [], []
    for end in (2.0, 0.5):
        rig.states[:] = 0.0
        x = -2.0
        while x < end:
            found = rig.push(np.array([x, 0.0, -0.02]), np.array([0.45, 0.0, 0.0]), 0.5)
            x += 0.45 * rig.dt
        loads.append(found[2])
        lowered.append(rig.states[len(rig.states) // 2, RUT])
    assert lowered[0] == 0.0 and 0.005 < lowered[1] < 0.02
    # it meets the bottom of the rut: less deep below that, stiffer, and never above the load of the first pass
    assert 0.5 * loads[0] < loads[1] <= loads[0] * 1.001


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from(["lunar_nominal", "rigid_rock", "snow"]),
    st.floats(1e-6, 0.05), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(-3.0, 3.0),
)  # fmt: skip
def test_finite_within_the_soils_strength_and_never_a_gift(
    soil: str, depth: float, along: float, side: float, belt: float, yaw: float
) -> None:
    rig = TrackRig(track(), soil_table(soil)[0])
    depth *= 0.05 if soil == "rigid_rock" else 1.0
    taken = 0.0
    for _ in range(400):
        found = rig.push(np.array([0.0, 0.0, -depth]), np.array([along, side, 0.0]), belt, yaw)
        taken += rig.report[0, ReportColumn.POWER] * rig.dt
    assert np.isfinite(found).all() and np.isfinite(rig.states).all()
    strength = WIDTH * LENGTH * rig.soil[SoilColumn.COHESION] + found[2] * rig.soil[SoilColumn.TAN_PHI]
    resisting = rig.report[0, ReportColumn.COMPACTION_RESISTANCE] + rig.report[0, ReportColumn.BULLDOZING_RESISTANCE]
    assert math.hypot(found[0], found[1]) <= (strength + resisting) * (1.0 + 1e-9)
    assert abs(found[6]) / RADIUS <= strength * (1.0 + 1e-9)
    assert taken >= -1e-9 * found[2]
