"""One table for wheels of all kinds: what the kernels of this chapter know of a machine.

Each wheel gives two lines in the body's twist (v_x, v_y, w), see `rolling_lines`. What differs from kind to kind is in
the columns: a steered wheel turns about a pivot (its own contact; the joint between two bodies, if it is rigid on the
second), a Mecanum wheel has rollers, and wheels that cannot all roll freely act as one axle.

Wheels rigid on one body at different places along it, and tracks, scrub in every turn. What they do together is that of
a single axle: it stands where the scrubbing balances, in the middle of the wheels, and the wheels' free-rolling centres
lie farther apart than the wheels do (Martinez et al. 2005, Int. J. Robotics Research 24(10):867: centres of rotation of
the treads; their distance over the track is `track_ratio` here, 1.4 to 2 for tyres on hard ground; of tracks first).
Assumption: the ratio does not depend on the radius of the turn, and the loads are even along the body.
"""

from collections.abc import Sequence
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from sojourn_machine.params import FloatArray

if TYPE_CHECKING:
    from sojourn_flight.mobility.steering_geometry import WheelGeometry

SAME_PLACE = 1e-3
"""Wheels of one body whose places along it differ by less are one axle [m]."""


class WheelTableColumn(IntEnum):
    """Columns of the table, one row a wheel."""

    X = 0
    Y = 1
    """Contact in base_link with the steering straight [m]."""
    RADIUS = 2
    STEERED = 3
    """1 if a joint turns the wheel's heading, 0 if not."""
    STEER_MIN = 4
    STEER_MAX = 5
    """[rad]"""
    PIVOT_X = 6
    PIVOT_Y = 7
    """Axis of that joint in base_link; the origin for a fixed wheel [m]."""
    ARM_X = 8
    ARM_Y = 9
    """From the pivot to where the wheel acts, in the turned body [m]."""
    ROLLER = 10
    """Cotangent of the angle of the rollers to the axle; 0 for an ordinary and for an omni wheel [-]."""
    ROLL_WEIGHT = 11
    SLIDE_WEIGHT = 12
    """Trust in 'it rolls' and in 'it does not slide sideways' [-]."""
    MAX_RATE = 13
    MAX_STEER_RATE = 14
    """Of the wheel's own motors [rad/s]; infinite where only the machine's limits hold."""


TABLE_COLUMNS = len(WheelTableColumn)


def wheel_table(wheels: Sequence["WheelGeometry"], track_ratio: float = 1.0) -> FloatArray:
    """Array for the kernels, shape (wheels, TABLE_COLUMNS).

    Args:
        wheels: of the machine, in its order.
        track_ratio: distance of the free-rolling centres over the track, for wheels that cannot all roll freely [-].
    """
    table = np.zeros((len(wheels), TABLE_COLUMNS))
    for row, wheel in zip(table, wheels, strict=True):
        pivot_x, pivot_y = wheel.pivot
        row[WheelTableColumn.X], row[WheelTableColumn.Y] = wheel.x, wheel.y
        row[WheelTableColumn.RADIUS] = wheel.radius
        row[WheelTableColumn.STEERED] = float(wheel.steered)
        row[WheelTableColumn.STEER_MIN], row[WheelTableColumn.STEER_MAX] = wheel.steer_min, wheel.steer_max
        row[WheelTableColumn.PIVOT_X], row[WheelTableColumn.PIVOT_Y] = pivot_x, pivot_y
        row[WheelTableColumn.ARM_X], row[WheelTableColumn.ARM_Y] = wheel.x - pivot_x, wheel.y - pivot_y
        row[WheelTableColumn.ROLL_WEIGHT] = row[WheelTableColumn.SLIDE_WEIGHT] = 1.0
        if wheel.roller_angle is not None:
            row[WheelTableColumn.ROLLER] = 1.0 / np.tan(wheel.roller_angle)
            row[WheelTableColumn.ROLL_WEIGHT] = np.sin(wheel.roller_angle) ** 2  # its misfit is along the roller's axis
            row[WheelTableColumn.SLIDE_WEIGHT] = 0.0
        row[WheelTableColumn.MAX_RATE] = np.inf if wheel.max_rate is None else wheel.max_rate
        row[WheelTableColumn.MAX_STEER_RATE] = np.inf if wheel.max_steer_rate is None else wheel.max_steer_rate
    for group in _rigid_groups(wheels):
        if _group_scrubs(wheels, group):
            _act_as_one_axle(table, group, track_ratio)
    return table


def scrubs(wheels: Sequence["WheelGeometry"]) -> bool:
    """Whether there are wheels that cannot all roll freely in a turn: a skid-steered machine, or a part of one."""
    return any(_group_scrubs(wheels, group) for group in _rigid_groups(wheels))


def _group_scrubs(wheels: Sequence["WheelGeometry"], group: list[int]) -> bool:
    """Whether wheels that are rigid on one body stand at different places along it, or are tracks."""
    return any(wheels[i].scrubs for i in group) or bool(np.ptp([wheels[i].x for i in group]) > SAME_PLACE)


def _rigid_groups(wheels: Sequence["WheelGeometry"]) -> list[list[int]]:
    """Wheels without rollers that are rigid on one body: all fixed ones, and those of each steering joint."""
    groups: dict[str | None, list[int]] = {}
    for index, wheel in enumerate(wheels):
        if wheel.roller_angle is None:
            groups.setdefault(wheel.steer_group, []).append(index)
    return list(groups.values())


def _act_as_one_axle(table: FloatArray, group: list[int], track_ratio: float) -> None:
    along, across = table[group, WheelTableColumn.ARM_X], table[group, WheelTableColumn.ARM_Y]
    middle = 0.5 * (across.min() + across.max())
    table[group, WheelTableColumn.ARM_X] = along.mean()
    table[group, WheelTableColumn.ARM_Y] = middle + track_ratio * (across - middle)
