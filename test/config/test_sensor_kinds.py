"""Tables of sensors: kinds that are no names, and two sensors that build on one part."""

import pytest

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_sensors.kinds.camera import StereoCameraSensorParams

CAMERAS = "machine=explorer_cameras"


@pytest.mark.parametrize("kind", ["true", "3", "[camera]", "null"])
def test_a_kind_that_is_no_name_is_refused_in_words(kind: str) -> None:
    with pytest.raises(ConfigError, match=r"navcam\.kind"):
        load_scenario("flat_drive", [CAMERAS, f"sensors.navcam.kind={kind}"])


def test_what_is_set_of_one_of_two_that_build_on_a_part_is_not_set_of_the_other() -> None:
    sensors = load_scenario("flat_drive", [CAMERAS, "sensors.front.stereo.range=10.0"]).sensors.named
    pairs = [sensors[name] for name in ("front", "rear")]
    assert [pair.stereo.range for pair in pairs if isinstance(pair, StereoCameraSensorParams)] == [10.0, 6.0]
