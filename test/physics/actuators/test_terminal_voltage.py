"""Voltages of motors, against the working points of their catalogues."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from test_motors import RE25, SERIES

from sojourn_physics.actuators import dc_motor, series_motor
from sojourn_physics.actuators.joint_drive import JOINT_COLUMNS, RATIO, RESISTANCE, SATURATION, TORQUE_CONSTANT
from sojourn_physics.actuators.terminal_voltage import terminal_voltages

GEAR = 50.0


@given(torque=st.floats(-0.2, 0.2), rate=st.floats(-1000.0, 1000.0), series_torque=st.floats(0.0, 0.5))
def test_they_are_those_of_the_working_point(torque: float, rate: float, series_torque: float) -> None:
    """Of a motor with a constant field and one with its own, the latter turning forwards."""
    points = [
        dc_motor.working_point(RE25, torque, rate),
        series_motor.series_working_point(SERIES, series_torque, abs(rate)),
    ]
    parameters = np.zeros((2, JOINT_COLUMNS))
    parameters[:, RATIO] = GEAR
    parameters[0, [RESISTANCE, TORQUE_CONSTANT]] = RE25.resistance, RE25.torque_constant
    parameters[1, [RESISTANCE, TORQUE_CONSTANT]] = SERIES.series_resistance, SERIES.field_constant
    parameters[1, SATURATION] = SERIES.saturation_current
    currents = np.array([point.current for point in points])
    rates = np.array([point.rate for point in points]) / GEAR
    found = terminal_voltages(parameters, currents, rates)
    np.testing.assert_allclose(found, [point.voltage for point in points], rtol=1e-9, atol=1e-9)
