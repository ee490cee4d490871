"""A goal over the map from orbit, of somebody on Earth: planned from where the link has told that the rover stands."""

from collections.abc import Callable
from pathlib import Path

import pytest
from programs import PATIENT, Program

LINK = "light_time_s: 0.4, up: {bit_s: 6000.0}, down: {bit_s: 64000.0}"
OPEN = "windows: [{kind: times, from_s: 0.0, to_s: 3600.0}]"
STATUS, ODOMETRY = "{topic: /drive/status}", "{topic: /odom, priority: 2}"


@pytest.mark.parametrize("told", [(STATUS, ODOMETRY), (STATUS,)])
def test_it_is_reached_where_the_link_tells_of_the_rover_and_else_it_is_said(
    told: tuple[str, ...], start: Callable[..., Program], domain: int, tmp_path: Path
) -> None:
    link = f"link={{{LINK}, {OPEN}, telemetry: [{', '.join(told)}]}}"
    waiting = ("--set", link, "--set", "steps=[]", "--set", "duration_limit_s=3600")
    place = ("--domain", domain, "--run-dir", tmp_path / "run")
    start("start", "flat_drive", *PATIENT, *waiting, "--realtime", "--composed", *place)
    far = ("drive", "0.6", "0.0", "--over", "flat_drive", "--domain", domain, "--timeout", 400)
    goal = start("goal_client", *far)
    assert (goal.wait() == 0) == (ODOMETRY in told), goal.text
    if ODOMETRY in told:
        assert "over the map: " in goal.text and "reached" in goal.text
    else:
        assert "the link takes no /odom to the Earth" in goal.text
