"""What is told of a contact with the ground: one definition of its columns, for the kernels that write them and for the
topic that carries them.
"""

from enum import IntEnum


class ReportColumn(IntEnum):
    """Columns of a contact's report. Their names in small letters are the fields of /truth/contacts."""

    X = 0
    """Place in map [m]."""
    Y = 1
    Z = 2
    SINKAGE = 3
    """Of the ground [m]."""
    SLIP_RATIO = 4
    SLIP_ANGLE = 5
    """[rad]"""
    FORCE_X = 6
    """Of the ground on the machine, in map [N]."""
    FORCE_Y = 7
    FORCE_Z = 8
    TORQUE = 9
    """That the motor has to supply [N m]."""
    SOIL = 10
    """Index of the soil with the largest share."""
    DEFLECTION = 11
    """Of the wheel [m]."""
    ROLLING_RESISTANCE = 12
    """[N]"""
    COMPACTION_RESISTANCE = 13
    BULLDOZING_RESISTANCE = 14
    POWER = 15
    """Into the contact [W]."""


REPORT_COLUMNS = len(ReportColumn)
PLACE = slice(ReportColumn.X, ReportColumn.Z + 1)
FORCE = slice(ReportColumn.FORCE_X, ReportColumn.FORCE_Z + 1)
