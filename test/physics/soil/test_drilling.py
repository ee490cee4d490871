"""A drill against the relations of its sources, by another route, and in its limits."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_machine.errors import InvalidValueError
from sojourn_machine.tools import DrillBitParams
from sojourn_physics.soil.drilling import drill

BITS = st.builds(
    DrillBitParams,
    radius=st.floats(0.005, 0.1),
    thrust_ratio=st.floats(0.3, 1.5),
    flat_friction=st.floats(0.1, 1.0),
    flat_force=st.floats(0.0, 50.0),
)


@settings(max_examples=80, deadline=None)
@given(BITS, st.floats(1e5, 1e8), st.floats(1.0, 500.0))
def test_energy_and_drilling_strength_lie_on_the_line(bit: DrillBitParams, ground: float, beyond: float) -> None:
    """E = (1 - β) ε + μ S, whatever the thrust: Detournay and Defourny's diagram."""
    thrust = bit.flat_force + beyond
    found = drill(bit, ground, thrust)
    energy = 2.0 * found.torque / (bit.radius**2 * found.depth_per_turn)
    strength = thrust / (bit.radius * found.depth_per_turn)
    beta = bit.flat_friction * bit.thrust_ratio
    assert energy == pytest.approx((1.0 - beta) * ground + bit.flat_friction * strength, rel=1e-9)


@settings(max_examples=60, deadline=None)
@given(BITS, st.floats(1e5, 1e8), st.floats(0.1, 300.0))
def test_more_thrust_goes_deeper_and_harder_ground_less(bit: DrillBitParams, ground: float, beyond: float) -> None:
    thrust = bit.flat_force + beyond
    found, more, harder = drill(bit, ground, thrust), drill(bit, ground, 1.5 * thrust), drill(bit, 2 * ground, thrust)
    assert more.depth_per_turn > found.depth_per_turn > harder.depth_per_turn > 0.0
    assert more.torque > found.torque
    # a sharp bit takes ε by its torque, and the thrust's little share; wear only adds
    assert found.specific_energy >= ground


def test_a_sharp_bit_by_hand() -> None:
    """ε 1 MPa, a 10 mm, ζ 0.5, 20 N: d = 20/(0.5e6 0.01) = 4 mm, T = 0.5e6 1e-4 0.004 = 0.2 N m."""
    found = drill(DrillBitParams(radius=0.01, thrust_ratio=0.5), 1e6, 20.0)
    assert found.depth_per_turn == pytest.approx(0.004)
    assert found.torque == pytest.approx(0.2)
    assert found.specific_energy == pytest.approx(1e6 + 20.0 / (math.pi * 1e-4))


def test_pressed_too_little_it_only_rubs() -> None:
    bit = DrillBitParams(radius=0.01, flat_force=10.0)
    found = drill(bit, 1e6, 6.0)
    assert found.depth_per_turn == 0.0 and math.isinf(found.specific_energy)
    assert found.torque == pytest.approx(0.5 * 0.6 * 0.01 * 6.0)
    for thrust, ground in ((-1.0, 1e6), (math.nan, 1e6), (1.0, 0.0)):
        with pytest.raises(InvalidValueError):
            drill(bit, ground, thrust)
