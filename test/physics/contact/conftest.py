"""One wheel, or one pad, on a plane: what the tests of the contact set share."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import yaml

from sojourn_analysis.wheels.examples import example_row
from sojourn_machine.contact_report import REPORT_COLUMNS
from sojourn_machine.params import FloatArray
from sojourn_machine.vectors import cross
from sojourn_physics.contact.contact_law import (
    MOTION_COLUMNS,
    OUT_COLUMNS,
    STATE_COLUMNS,
    WHEEL_COLUMNS,
    MotionColumn,
    OutColumn,
    WheelColumn,
)
from sojourn_physics.contact.contact_set import contact_forces
from sojourn_physics.contact.law_call import apply_law, row_entry
from sojourn_physics.contact.pad_on_soil import CUT_COLUMNS, TOOL_COLUMNS
from sojourn_physics.contact.rigid_wheel_on_soil import rigid_wheel_on_soil
from sojourn_physics.contact.tables import (
    Carried,
    FootTable,
    Ground,
    Kinematics,
    PadTable,
    Supports,
    SupportStates,
    Touch,
    TrackTable,
    WheelTable,
    make_workspace,
)
from sojourn_physics.contact.track_on_soil import PLATE_COLUMNS, TRACK_COLUMNS
from sojourn_physics.soil.params import SoilColumn, SoilParams, kernel_table
from sojourn_physics.terrain.height_field import SoilArray
from sojourn_physics.terrain.memory import GroundMemory, MemoryBoard

SOIL_FOLDER = Path(__file__).resolve().parents[3] / "config" / "soils"


def soil_table(*names: str, damping: float | None = None) -> FloatArray:
    """Kernel rows of soils of `config/soils`."""
    texts = [(SOIL_FOLDER / f"{name}.yaml").read_text(encoding="utf-8") for name in names]
    table = kernel_table([SoilParams.model_validate(yaml.safe_load(text)) for text in texts])
    if damping is not None:
        table[:, SoilColumn.CONTACT_DAMPING] = damping
    return table


@cache
def carried(count: int) -> Carried:
    """So many supports on one body that is moved by six coordinates."""
    bodies = np.zeros(count, dtype=np.int64)
    return Carried(bodies, np.tile([0, 1, 2, 3, 4, 5, -1], (count, 1)), np.zeros((count, 3)), 0)


FREE_BODY = np.eye(6)
"""Jacobian of a body that is moved by six coordinates."""
NO_ROWS = np.zeros((0, WHEEL_COLUMNS))
NO_TRACKS = TrackTable(
    np.zeros((0, TRACK_COLUMNS)), np.zeros((0, 3), np.int64), np.zeros((0, PLATE_COLUMNS)), carried(0)
)
NO_FEET = FootTable(NO_ROWS, np.zeros((0, 3, 3)), carried(0))
NO_STATES = np.zeros((0, STATE_COLUMNS))


def supports(
    wheels: FloatArray | None = None,
    radius: float | None = None,
    cuts: FloatArray | None = None,
    tracks: TrackTable | None = None,
) -> Supports:
    """One wheel, by its row, or one pad, by its radius and its cuts, or tracks; nothing else."""
    wheel_rows = NO_ROWS if wheels is None else wheels
    radii = np.zeros(0) if radius is None else np.array([radius])
    given = np.zeros((len(radii), 1, CUT_COLUMNS)) if cuts is None else cuts
    return Supports(
        WheelTable(wheel_rows, carried(len(wheel_rows))),
        NO_TRACKS if tracks is None else tracks,
        NO_FEET,
        PadTable(radii, given, np.zeros((len(radii), TOOL_COLUMNS)), carried(len(radii))),
    )


def one_state(one: Supports, state: FloatArray) -> SupportStates:
    """The states of these supports, of which one kind alone is there."""
    tables = (one.wheels.rows, one.tracks.rows, one.pads.radii)
    wheels, tracks, pads = (state if len(table) else NO_STATES for table in tables)
    return SupportStates(wheels, tracks, NO_STATES, pads)


@dataclass
class Rig:
    """A wheel (or a pad) that is held and moved by hand over a height field of 20 x 20 m.

    slope_x, slope_y: gradient of the plane. step: rise of the ground where x > 0 [m].
    cell: of the ground's memory [m]; 0 is ground that remembers nothing.
    """

    soils: FloatArray
    slope_x: float = 0.0
    slope_y: float = 0.0
    step: float = 0.0
    soil_where_positive_x: int = 0
    wheel: bool = True
    radius: float = 0.125
    shear_radius: float = 0.131
    width: float = 0.16
    dt: float = 0.001
    cell: float = 0.0
    state: FloatArray = field(default_factory=lambda: np.zeros((1, STATE_COLUMNS)))
    report: FloatArray = field(default_factory=lambda: np.zeros((1, REPORT_COLUMNS)))
    on_map: bool = True

    def __post_init__(self) -> None:
        self.grid = np.array([-10.0, -10.0, 0.05, 0.0])
        axis = -10.0 + 0.05 * np.arange(401)
        x, y = np.meshgrid(axis, axis)
        self.heights: FloatArray = self.slope_x * x + self.slope_y * y + np.where(x > 1e-9, self.step, 0.0)
        self.soil_index: SoilArray = np.where(x > 1e-9, self.soil_where_positive_x, 0).astype(np.uint8)

        self.memory = MemoryBoard(GroundMemory(self.cell, -10.0, -10.0))

        self.row: FloatArray = np.zeros(WHEEL_COLUMNS)
        self.row[WheelColumn.RADIUS] = self.radius
        self.row[WheelColumn.SHEAR_RADIUS] = self.shear_radius
        self.row[WheelColumn.WIDTH] = self.width
        self.row[WheelColumn.LAW] = row_entry(rigid_wheel_on_soil)
        self.cuts: FloatArray = np.zeros((1, len(self.soils), CUT_COLUMNS))

    @property
    def normal(self) -> FloatArray:
        """Unit normal of the plane."""
        normal = np.array([-self.slope_x, -self.slope_y, 1.0])
        return normal / np.linalg.norm(normal)

    def push(
        self, centre: FloatArray, rotation: FloatArray, velocity: FloatArray, angular: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """One step with this motion: force at the centre and moment about it, both in map.

        rotation: from the wheel's frame (x ahead, y along the axle) to map. velocity: of the centre.
        """
        placement = np.concatenate([rotation.T.reshape(-1), centre])[np.newaxis, :]
        twist = np.concatenate([velocity - cross(angular, centre), angular])
        force = np.zeros(6)
        one = supports(wheels=self.row[np.newaxis, :]) if self.wheel else supports(radius=self.radius, cuts=self.cuts)
        ground = Ground(self.heights, self.soil_index, self.grid, self.soils, self.memory.tables)
        machine = Kinematics(placement, FREE_BODY, twist)
        states = one_state(one, self.state)
        touch = Touch(states, self.report, force, make_workspace(self.soils))
        self.on_map = contact_forces(one, ground, machine, self.dt, touch)
        return force[:3], force[3:] - cross(centre, force[:3])

    def hold(
        self,
        centre: FloatArray,
        rotation: FloatArray,
        velocity: FloatArray,
        angular: FloatArray,
        steps: int = 4000,
    ) -> tuple[FloatArray, FloatArray]:
        """Force and moment after so many steps of one motion, the centre held where it is (the ground is a plane)."""
        for _ in range(steps):
            result = self.push(centre, rotation, velocity, angular)
        return result


def turned(axis: str, angle: float) -> FloatArray:
    """Rotation matrix about x, y or z."""
    c, s = math.cos(angle), math.sin(angle)
    rows = {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }
    return np.array(rows[axis], dtype=np.float64)


@pytest.fixture(scope="session")
def rig() -> Callable[..., Rig]:
    """Maker of rigs: `rig("lunar_nominal", slope_x=0.1)`; `damping=0` switches the soils' normal damping off."""

    def make(*soils: str, damping: float | None = None, **options: float) -> Rig:
        return Rig(soil_table(*soils, damping=damping), **options)  # type: ignore[arg-type]

    return make


@dataclass
class LawRig:
    """One contact under a law of its own, without terrain: motion in, forces out."""

    wheel: FloatArray
    soil: FloatArray
    dt: float = 0.001
    state: FloatArray = field(default_factory=lambda: np.zeros(STATE_COLUMNS))

    def step(self, steps: int = 1, **motion: float) -> dict[str, float]:
        """Forces by the names of `OutColumn` after so many steps of one motion, by the names of `MotionColumn`.

        POWER is filled in: what the wheel gives to the contact.
        """
        row = np.zeros(MOTION_COLUMNS)
        for name, value in motion.items():
            row[MotionColumn[name.upper()]] = value
        out = np.zeros(OUT_COLUMNS)
        for _ in range(steps):
            out[:] = 0.0
            apply_law(self.wheel, self.soil, row, self.dt, self.state, out)
        found = {column.name.lower(): float(out[column]) for column in OutColumn}
        column = MotionColumn
        spin = row[column.RIM_SPEED] / self.wheel[WheelColumn.RADIUS]
        found["power"] = -(
            found["force_x"] * row[column.V_ALONG]
            + found["force_y"] * row[column.V_SIDE]
            + found["force_z"] * row[column.V_NORMAL]
            + found["moment_x"] * row[column.ROLL_RATE]
            + found["moment_z"] * row[column.YAW_RATE]
            - found["torque"] * spin
        )
        return found

    def penetration_for(self, load: float, **motion: float) -> float:
        """Penetration at which a fresh contact carries a load [N]."""
        low, high = 1e-9, 0.3
        for _ in range(80):
            middle = 0.5 * (low + high)
            self.state[:] = 0.0
            if self.step(penetration=middle, **motion)["force_z"] < load:
                low = middle
            else:
                high = middle
        self.state[:] = 0.0
        return 0.5 * (low + high)


@pytest.fixture(scope="session")
def law() -> Callable[..., LawRig]:
    """Maker of rigs of one law: `law("brush", "rigid_rock")`, or with a row of one's own."""

    def make(wheel: str | FloatArray, soil: str | FloatArray, dt: float = 0.001) -> LawRig:
        row = example_row(wheel) if isinstance(wheel, str) else wheel
        return LawRig(row, soil_table(soil)[0] if isinstance(soil, str) else soil, dt)

    return make


@pytest.fixture(scope="session")
def rotation() -> Callable[[str, float], FloatArray]:
    """Maker of rotation matrices."""
    return turned
