"""Laws of one wheel: work that goes in and comes out, limits, and the numbers of the law that each stands on."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from sojourn_analysis.vehicle.wheel_traction import (
    ClosedFormWheel,
    FirmWheel,
    RimStressWheel,
    RollingLoss,
)
from sojourn_machine.errors import InvalidValueError
from sojourn_physics.contact.wheel_shape import WheelShape
from sojourn_physics.soil.params import SoilParams
from sojourn_physics.soil.pressure_sinkage import pressure

R, B = 0.4065, 0.229
SHAPE = WheelShape(name="lrv", citation="test", radius=R, width=B)


def test_closed_form_thrust_is_the_integral_of_the_shear_stress(lunar_soil: SoilParams) -> None:
    """Janosi's stress over a flat contact with a shear displacement that grows with the slip."""
    wheel = ClosedFormWheel(lunar_soil, R, B, 1.624)
    load, slip = 284.0, 0.23
    found = wheel.forces(load, slip)
    length = R * math.acos(1.0 - found.sinkage / R)
    stress = lunar_soil.cohesion + load / (B * length) * math.tan(lunar_soil.friction_angle)
    thrust = quad(lambda x: B * stress * -math.expm1(-slip * x / lunar_soil.shear_modulus), 0.0, length)[0]
    assert found.torque / R == pytest.approx(thrust, rel=1e-9)
    rut = B * quad(lambda z: pressure(lunar_soil, B, z), 0.0, found.sinkage)[0]
    assert found.compaction == pytest.approx(rut, rel=1e-9)
    assert found.pull == pytest.approx(thrust - rut, rel=1e-9)


@given(slip=st.floats(0.0, 0.9), load=st.floats(20.0, 600.0))
def test_a_driving_wheel_never_gives_more_work_than_it_takes(slip: float, load: float, lunar_soil: SoilParams) -> None:
    """Per metre of rim: torque over radius goes in, pull times (1 - slip) comes out."""
    loss = RollingLoss(0.02)
    for wheel in (
        ClosedFormWheel(lunar_soil, R, B, 1.624, loss),
        RimStressWheel(lunar_soil, SHAPE, 1.624, loss),
        FirmWheel(R, 0.7, loss=loss),
    ):
        force = wheel.forces(load, slip)
        assert force.torque / R >= force.pull * (1.0 - slip)


def test_bulldozing_counts_from_six_percent_of_the_diameter(lunar_soil: SoilParams) -> None:
    wheel = ClosedFormWheel(lunar_soil, R, B, 1.624)
    light, heavy = wheel.forces(284.0, 0.1), wheel.forces(2000.0, 0.1)
    assert light.sinkage < 0.06 * 2.0 * R < heavy.sinkage
    assert light.bulldozing == 0.0
    assert heavy.bulldozing > 0.0


def test_bad_numbers_are_refused(lunar_soil: SoilParams) -> None:
    wheel = ClosedFormWheel(lunar_soil, R, B, 1.624)
    with pytest.raises(InvalidValueError, match="load"):
        wheel.forces(0.0, 0.1)
    with pytest.raises(InvalidValueError, match="slip"):
        wheel.forces(100.0, 1.5)
    with pytest.raises(InvalidValueError, match="load"):
        RimStressWheel(lunar_soil, SHAPE, 1.624).forces(1e7, 0.1)
