"""A run over a link is the same without middleware and in many processes."""

from pathlib import Path

from programs import LAYOUTS, PATIENT
from test_same_everywhere import records
from verdicts import require_same

LINK = (
    "link={light_time_s: 1.1, up: {bit_s: 600.0}, down: {bit_s: 64000.0, loss: 0.2}, "
    "windows: [{kind: times, from_s: 3.0, to_s: 60.0}], telemetry: [{topic: /drive/status}, {topic: /imu/data}]}"
)
OVER_A_LINK = (
    "flat_drive",
    *PATIENT,
    "--set",
    LINK,
    "--set",
    "steps=[{drive_to: {x: -0.95, y: 0.0}, timeout_s: 40.0}]",
)


def test_a_run_over_a_link_is_the_same_in_all_layouts(tmp_path: Path) -> None:
    bags = records(tmp_path, {name: ((*OVER_A_LINK, *options), {}) for name, options in LAYOUTS.items()}, 0)
    require_same(bags["direct"], bags["processes"])
    assert len(bags["direct"].topics["/goal_pose"]) == 1 and len(bags["direct"].topics["/earth/imu/data"]) > 10
