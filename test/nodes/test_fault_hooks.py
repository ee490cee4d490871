"""Faults on single readings of any form: the equation, the form kept, spikes as often and as high as asked for."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from sojourn_machine.params import FloatArray
from sojourn_machine.sensor_faults import SensorFaultParams
from sojourn_sensors.fault_hooks import FaultNow, faulted

NUMBERS = st.floats(-1e6, 1e6)


@dataclass(frozen=True, slots=True)
class TwoQuantities:
    force: FloatArray
    heat: float
    name: str = "gauge"


def fault_of(of: str = "", time: float = 2.0, number: int = 1, **keys: Any) -> FaultNow:
    return FaultNow(SensorFaultParams(of=of, **keys), time, 5, number)


@given(
    arrays(float, array_shapes(max_dims=2, max_side=4), elements=NUMBERS),
    NUMBERS,
    NUMBERS,
    NUMBERS,
    st.floats(0.0, 1e4),
)
def test_the_equation_holds_for_each_number(
    x: FloatArray, scale: float, bias: float, drift: float, time: float
) -> None:
    fault = FaultNow(SensorFaultParams.model_construct(scale=scale, bias=bias, drift=drift), time, 1, 1)
    wrong = faulted(x, fault)
    assert wrong.shape == x.shape and wrong.dtype == x.dtype
    for place, value in np.ndenumerate(x):
        size = abs(scale * value) + abs(bias) + abs(drift * time)
        assert wrong[place] == pytest.approx(scale * value + bias + drift * time, abs=1e-12 * size)


@given(arrays(np.float32, 3, elements=st.floats(-100.0, 100.0, width=32)))
def test_a_swapped_sign_is_swapped_back(x: FloatArray) -> None:
    swapped = faulted(x, fault_of(scale=-1.0))
    assert swapped.dtype == np.float32
    np.testing.assert_array_equal(faulted(swapped, fault_of(scale=-1.0)), x)


def test_a_reading_keeps_its_form_and_its_other_quantities() -> None:
    reading = ("left", TwoQuantities(np.array([1.0, 2.0]), 3.0))
    side, wrong = faulted(reading, fault_of("heat", bias=0.5))
    assert side == "left" and wrong.heat == 3.5 and wrong.name == "gauge"
    np.testing.assert_array_equal(wrong.force, reading[1].force)
    np.testing.assert_array_equal(faulted(reading, fault_of("force", scale=(2.0, 3.0)))[1].force, [2.0, 6.0])
    assert faulted(4.0, fault_of(drift=0.25)) == 4.5
    np.testing.assert_array_equal(reading[1].force, [1.0, 2.0])


@pytest.mark.parametrize("reading", [None, "text", np.arange(3), TwoQuantities(np.zeros(2), 0.0)])
def test_what_has_no_such_numbers_is_refused(reading: Any) -> None:
    with pytest.raises(ValueError, match=r"numbers|one of force, heat"):
        faulted(reading, fault_of(bias=1.0))


@pytest.mark.parametrize("probability", [0.02, 0.5, 1.0])
def test_spikes_come_as_often_as_asked_for_to_either_side(probability: float) -> None:
    count = 4000
    spikes = np.array(
        [
            faulted(np.zeros(2), fault_of(number=number, spike_probability=probability, spike_size=3.0))
            for number in range(count)
        ]
    )
    assert set(np.unique(spikes)) <= {-3.0, 0.0, 3.0}
    for each in spikes.T:
        spread = 5.0 * (count * probability) ** 0.5
        assert abs(np.count_nonzero(each) - count * probability) <= spread * (1.0 - probability) ** 0.5
        assert abs(np.sum(np.sign(each))) < spread
    assert np.any(spikes[:, 0] != spikes[:, 1])
