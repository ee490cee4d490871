"""Every rover drives its course in lock-step: a square, a step of 0.1 m if it can, 10 degrees; on tracks 15."""

import json
from pathlib import Path

import numpy as np
import pytest
from programs import chosen, demos, with_long

from sojourn_bags.machine import euler_angles, poses_of
from sojourn_bags.reading import Bag, read_bag
from sojourn_bringup.demonstration import scenario_of
from sojourn_config.machine_reader import machine_config
from sojourn_config.paths import available
from sojourn_config.scenario import load_scenario

DRIVEN_AS_EXPLORER = {"explorer_isotope", "explorer_night", "explorer_solar"}
"""They are fed and warmed otherwise, and drive its course to the last bit."""
ROVERS = [name for name in available("machines") if machine_config(name).stands_on and name not in DRIVEN_AS_EXPLORER]
LONG = {"articulated", "explorer_cameras", "lunokhod", "micro", "skid"}
"""Drive their courses when all tests run; what is particular to each is asked of it by shorter tests as well."""
SLOPE_DEG = {"tracked": 15.0}
"""Where it is not 10."""


@pytest.fixture(scope="module")
def runs(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[int, str, Path]]:
    options = {rover: ["--machine", rover, "--direct"] for rover in chosen(request, "rover")}
    return demos(options, tmp_path_factory.mktemp("courses"))


def track(bag: Bag) -> tuple[np.ndarray, np.ndarray]:
    """True places, (n, 3) [m], and pitch, nose up [degree]."""
    poses = poses_of(bag, "/truth/odom")
    return poses[:, :3], -np.degrees(euler_angles(poses[:, 3:])[:, 1])


@pytest.mark.parametrize("rover", with_long(ROVERS, LONG))
def test_course(rover: str, runs: dict[str, tuple[int, str, Path]]) -> None:
    status, said, folder = runs[rover]
    assert status == 0, said
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert summary["all_met"] and summary["complete"] and not summary["rolled_over"]
    places, pitch = track(read_bag(folder))
    scenario = load_scenario(scenario_of(None, rover), [f"machine={rover}"])
    # the square: as many metres to the east and to the north as asked, and back
    corners = np.array([
        (point.x, point.y)
        for step in scenario.config.steps[:4]
        for point in getattr(step.action, "points", (step.action,))
        if hasattr(point, "x")
    ])  # fmt: skip
    side = corners[:, 1].max()
    assert places[:, 1].max() > 0.8 * side
    features = {feature.kind: feature for feature in scenario.terrain.features}
    ahead = places[:, 0] > features["ramp"].x + 0.2 * features["ramp"].length
    assert np.percentile(pitch[ahead], 90) > 0.8 * SLOPE_DEG.get(rover, 10.0), "nowhere on the slope with all wheels"
    lengths = [abs(wheel.x) for wheel in scenario.steering.wheels]
    if "step" in features:
        step = features["step"]
        assert step.height == pytest.approx(0.1)
        assert places[-1, 0] - max(lengths) > step.x + step.length, "its last wheel is not over the step"
    assert places[-1, 2] - places[0, 2] > 0.4 * features["ramp"].height


def test_who_is_not_asked_for_the_step_cannot_climb_it_by_the_data_sheet() -> None:
    from sojourn_analysis.vehicle.step_climbing import highest_step
    from sojourn_studies.datasheet_of_rover import subject_of

    for rover in ROVERS:
        course = load_scenario(scenario_of(None, rover), [f"machine={rover}"])
        if any(feature.kind == "step" for feature in course.terrain.features):
            continue
        side = subject_of(rover, "moon", "lunar_nominal").side()
        assert side is not None, f"{rover} has no reason to leave the step out"
        assert highest_step(side, 0.8, course.gravity, highest=0.3) < 0.1
