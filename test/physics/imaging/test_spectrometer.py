"""Point spectrometers: which name a soil is given."""

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from sojourn_physics.imaging.spectrometer import SpectrometerParams, named

CONFUSION = {"sand": {"sand": 0.85, "clay": 0.1, "unknown": 0.05}, "clay": {"clay": 1.0}}


def spectrometer(**told: Any) -> SpectrometerParams:
    return SpectrometerParams.model_validate({"range": 3.0, "confusion": CONFUSION} | told)


def test_names_come_as_often_as_the_matrix_says() -> None:
    random, count = np.random.default_rng(6), 50_000
    names = [named(spectrometer(), "sand", random) for _ in range(count)]
    for name, probability in CONFUSION["sand"].items():
        deviation = (probability * (1.0 - probability) / count) ** 0.5
        assert names.count(name) / count == pytest.approx(probability, abs=4.0 * deviation)
    assert {named(spectrometer(), "clay", random) for _ in range(1000)} == {"clay"}


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({"confusion": {"sand": {"sand": 0.9, "clay": 0.05}}}, r"confusion.sand sums to 0.95: allowed is 1"),
        ({"confusion": {"sand": {}}}, "sums to 0"),
        ({"confusion": {"sand": {"sand": 1.5, "clay": -0.5}}}, r"confusion.sand.sand = 1.5: allowed is 0 to 1"),
        ({"confusion": {}}, "confusion"),
        ({"range": 0.0}, "range"),
    ],
)
def test_what_is_no_confusion_matrix_is_refused(told: dict[str, Any], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        spectrometer(**told)
