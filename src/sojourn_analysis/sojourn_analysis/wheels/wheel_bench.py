"""Single-wheel test bed: the sinkage at which a rigid wheel in steady motion bears its load, and the forces there.

A carriage moves at speed v, turned from the wheel's heading by the slip angle β towards its left, and the rim turns at
the speed rω. The slip ratio is that of the carriage, as measured on a test bed,

    s = (rω - v)/max(rω, v),    -1 (locked) to 1 (spinning on the spot)

so that v_x = v cos β and v_y = v sin β. For β = 0 it is the slip of Wong and Reece. Signs: drawbar pull ahead along the
wheel's heading; side force to the left of it, so negative for a positive slip angle: it acts against the motion.

The least sinkage that bears the load is taken: it is where a wheel that is let down comes to rest.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sojourn_analysis.wheels.test_bed import GRAVITY
from sojourn_machine.errors import InvalidValueError, MachineError
from sojourn_machine.kernels import njit
from sojourn_machine.params import FloatArray
from sojourn_physics.contact.rigid_rim import RigidRim, RimContact
from sojourn_physics.contact.wheel_on_soil import QUADRATURE, contact_angles, travel, wheel_forces
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.params import SoilParams, kernel_row

DEEPEST = 1.5
"""Sinkage at which a wheel counts as lost, over its radius."""
SCAN_STEPS = 40
SHALLOWEST = 1e-6
"""First sinkage of the scan, over the radius."""

# Columns of the shapes, cases and results of `solve`
SHAPE_COLUMNS = 5
"""radius, shear radius, width [m], grouser count [-], grouser thickness [m]"""
CASE_COLUMNS = 4
"""load [N], slip ratio [-], slip angle [rad], gravity [m/s^2]"""
RESULT_COLUMNS = 8
"""sinkage [m], drawbar pull [N], side force [N], torque [N m], entry, exit angle [rad], compaction, bulldozing
resistance [N]; all not-a-number where the load cannot be carried"""


class OverloadError(MachineError):
    """A load that the soil does not carry at any sinkage of the model."""


@dataclass(frozen=True, slots=True)
class BenchResult:
    """One steady state of the test bed."""

    load_n: float
    slip: float
    slip_angle_deg: float
    sinkage_m: float
    drawbar_pull_n: float
    """Along the wheel's heading."""
    side_force_n: float
    """To the left of the heading: negative for a positive slip angle."""
    torque_nm: float
    entry_angle_rad: float | None
    """None from a law that does not tell where the contact begins and ends."""
    exit_angle_rad: float | None
    resistances: dict[str, float]
    """`compaction_n`: soil pressed down ahead; `bulldozing_n`: soil pushed ahead; `rolling_n`, from laws that know it:
    of the wheel itself. Parts of the pull, at least 0."""
    deflection_m: float = 0.0
    """Of the wheel itself, pressed flat by its load."""


@njit(cache=True)
def slips(slip: float, slip_angle: float) -> tuple[float, float]:
    """Slip along the heading and lateral slip of the contact laws, both over max(rω, v), from those of the carriage."""
    speed = 1.0 - max(slip, 0.0)
    rim = 1.0 + min(slip, 0.0)
    return rim - speed * math.cos(slip_angle), -speed * math.sin(slip_angle)


@njit(cache=True)
def _bears(
    shape: FloatArray, case: FloatArray, sinkage: float, slip: float, lateral: float, soil: FloatArray
) -> tuple[float, float, float, float, float, float, float, float, float]:
    rim = RigidRim(shape[0], shape[1], shape[2], shape[3], shape[4])
    contact = RimContact(sinkage, slip, lateral, 1.0)
    return wheel_forces(rim, case[3], contact, soil, QUADRATURE)  # type: ignore[no-any-return]


@njit(cache=True)
def solve(shapes: FloatArray, cases: FloatArray, soil: FloatArray, results: FloatArray) -> None:
    """Steady states of several wheels on one soil.

    Args:
        shapes: (count, SHAPE_COLUMNS). cases: (count, CASE_COLUMNS). soil: kernel row.
        results: (count, RESULT_COLUMNS), written.
    """
    growth = (DEEPEST / SHALLOWEST) ** (1.0 / SCAN_STEPS)
    for i in range(cases.shape[0]):
        shape, case = shapes[i], cases[i]
        load = case[0]
        slip, lateral = slips(case[1], case[2])
        below = 0.0
        above = SHALLOWEST * shape[0]
        under = -load
        over = _bears(shape, case, above, slip, lateral, soil)[2] - load
        for _ in range(SCAN_STEPS):
            if over >= 0.0:
                break
            below, under = above, over
            above *= growth
            over = _bears(shape, case, above, slip, lateral, soil)[2] - load
        if over < 0.0:
            results[i] = math.nan
            continue
        # Regula falsi with Illinois' halving: keeps the bracket
        last = 0
        for _ in range(100):
            middle = (below * over - above * under) / (over - under) if over > under else above
            middle = min(max(middle, below), above)
            here = _bears(shape, case, middle, slip, lateral, soil)[2] - load
            if here >= 0.0:
                above, over = middle, here
                if last == 1:
                    under *= 0.5
                last = 1
            else:
                below, under = middle, here
                if last == -1:
                    over *= 0.5
                last = -1
            if above - below <= 1e-12 * shape[0] or abs(here) <= 1e-11 * load:
                break
        found = _bears(shape, case, middle, slip, lateral, soil)
        sideways = travel(slip, lateral)[3]
        entry, exit_angle, _ = contact_angles(shape[0], middle, slip, 1.0, soil, sideways)
        results[i, 0] = middle
        results[i, 1] = found[0]
        results[i, 2] = found[1]
        results[i, 3] = found[3]
        results[i, 4] = entry
        results[i, 5] = exit_angle + 0.0  # no minus zero
        results[i, 6] = found[7]
        results[i, 7] = found[8]


def shape_row(wheel: WheelShape) -> FloatArray:
    """Row of `solve`'s shapes."""
    count = wheel.grouser_count
    return np.array([wheel.radius, wheel.shear_radius, wheel.width, count, wheel.grouser_thickness], dtype=np.float64)


def check_case(load: float, slip: float, slip_angle_deg: float) -> None:
    """Raise InvalidValueError for a load that is not positive, or a slip or angle out of range."""
    if not (math.isfinite(load) and load > 0.0):
        raise InvalidValueError("load", load, "a finite number more than 0 N")
    if not -1.0 <= slip <= 1.0:
        raise InvalidValueError("slip", slip, "-1 (locked) to 1 (spinning on the spot)")
    if not -90.0 <= slip_angle_deg <= 90.0:
        raise InvalidValueError("slip angle", slip_angle_deg, "-90 to 90 degrees")


def measure(
    wheel: WheelShape,
    soil: SoilParams,
    load: float,
    slips_of_carriage: Sequence[float],
    slip_angles_deg: Sequence[float] = (0.0,),
    gravity: float = GRAVITY,
) -> list[BenchResult]:
    """Steady states at every slip for every slip angle.

    Args:
        load: on the wheel [N]. slips_of_carriage: see the module. gravity: at the test bed [m/s^2].

    Raises:
        InvalidValueError: as `check_case`. OverloadError: the soil does not carry the load.
    """
    pairs = [(slip, angle) for angle in slip_angles_deg for slip in slips_of_carriage]
    for slip, angle in pairs:
        check_case(load, slip, angle)
    cases = np.array([[load, slip, math.radians(angle), gravity] for slip, angle in pairs])
    found = np.empty((len(pairs), RESULT_COLUMNS))
    solve(np.tile(shape_row(wheel), (len(pairs), 1)), cases, kernel_row(soil), found)
    for (slip, angle), row in zip(pairs, found, strict=True):
        if math.isnan(row[0]):
            where = f"slip {slip:g}" + (f" and slip angle {angle:g} degrees" if angle else "")
            raise OverloadError(
                f"load = {load:g} N: soil {soil.name} does not carry it under wheel {wheel.name} at {where}, "
                f"not even at a sinkage of {DEEPEST:g} radii"
            )
    return [_result(load, *pair, row) for pair, row in zip(pairs, found.tolist(), strict=True)]


def _result(load: float, slip: float, angle: float, row: Sequence[float]) -> BenchResult:
    sinkage, pull, side, torque, entry, exit_angle, compaction, bulldozing = row
    resistances = {"compaction_n": compaction, "bulldozing_n": bulldozing}
    return BenchResult(load, slip, angle, sinkage, pull, side, torque, entry, exit_angle, resistances)
