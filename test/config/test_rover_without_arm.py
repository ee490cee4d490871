"""A rover without an arm: nothing of an arm is read, and what asks for one is refused with its place."""

import pytest

from sojourn_config.arms import load_arm
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario


def test_it_loads_and_has_no_arm() -> None:
    scenario = load_scenario("flat_drive", ["machine=skid"])
    assert scenario.arm is None
    assert scenario.arm_joints == ()
    assert scenario.arm_pose("stow") == {}
    assert not any("arms/" in name for name in scenario.files)


@pytest.mark.parametrize(
    ("scenario", "override", "words"),
    [
        ("lunar_sample", "seed=1", ["steps[2].arm_joints", "steps[3].arm_to_ground", "the machine skid has no arm"]),
        (
            "flat_drive", "steps=[{arm_jog: {seconds: 1}}, {arm_task: {name: tare}}]",
            ["steps[0].arm_jog", "steps[1].arm_task", "the machine skid has no arm"],
        ),
        ("flat_drive", "arm.tip_link=base_link", ["arm.tip_link=base_link", "the machine skid has no arm"]),
    ],
)  # fmt: skip
def test_what_asks_for_an_arm_is_refused(scenario: str, override: str, words: list[str]) -> None:
    with pytest.raises(ConfigError) as caught:
        load_scenario(scenario, ["machine=skid", override])
    for word in words:
        assert word in str(caught.value)


def test_the_bench_says_that_a_rover_has_no_arm() -> None:
    with pytest.raises(ConfigError, match="the machine skid has no arm"):
        load_arm("skid")
