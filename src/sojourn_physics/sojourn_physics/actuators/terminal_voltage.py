"""Voltage at the terminals of motors whose current and rate are known:

    u = R i + K N w        direct-current and brushless motors, w the joint's rate, N the gear's ratio
    u = R i + K0 i/(1 + |i|/I_s) N w        series motors, whose field is that of their own current

as `dc_motor` and `series_motor` have them, with their sources. Left out: inductance, whose time is far below a step,
and the drop over brushes.
"""

import numpy as np

from sojourn_machine.params import FloatArray
from sojourn_physics.actuators.joint_drive import RATIO, RESISTANCE, SATURATION, TORQUE_CONSTANT


def terminal_voltages(parameters: FloatArray, currents: FloatArray, rates: FloatArray) -> FloatArray:
    """Voltages, (n,) [V].

    Args:
        parameters: rows of `joint_drive`, (n, columns). currents: (n,) [A]. rates: of the motors, over the gear, (n,)
            [rad/s].
    """
    constant, saturation = parameters[:, TORQUE_CONSTANT], parameters[:, SATURATION]
    series = saturation > 0.0
    own_field = currents / (1.0 + np.abs(currents) / np.where(series, saturation, 1.0))
    field = constant * np.where(series, own_field, 1.0)
    return np.asarray(parameters[:, RESISTANCE] * currents + field * parameters[:, RATIO] * rates)
