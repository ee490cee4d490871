"""The reference bags: which there are, and how each is recorded."""

from dataclasses import dataclass
from pathlib import Path

from sojourn_config.paths import repository_root


@dataclass(frozen=True)
class ReferenceBag:
    """A reference bag.

    Args:
        name: of its scenario in test/replay, and of its folder there. overrides: KEY=VALUE texts over it.
        outcomes: how its steps must end. roles: to whose topics it is thinned, () where it holds all.
    """

    name: str
    overrides: tuple[str, ...]
    outcomes: tuple[str, ...]
    roles: tuple[str, ...] = ()


UNFOLDED = "arm.named_poses={stow: [0.0, -0.95, 1.85, -0.9, 0.0], unfold: [0.0, -1.0, 1.9, -0.9, 0.0]}"
"""The arm of the explorer stands unfolded when the run begins, so that the bag is short."""
RARE_CLOUDS = "sensors.hazcam.timing.rate=2.0"
"""Clouds are half of a small bag."""
KALMAN = "power_manager.estimator=kalman"
WEAK_BUS = "arm.power_limit=60"
LITTLE_POWER = "power_manager.load_limits={arm: 20.0}"
OBSTACLE = "arm.obstacles=[[4.0, 1.0, 2.0, 0.5]]"
SMALL_IMAGES = (
    "sensors.navcam.lens.columns=128",
    "sensors.navcam.lens.rows=128",
    "drive.visual_odometry.corners=60",
    "drive.visual_odometry.window=11",
    "drive.visual_odometry.search=10",
    "drive.visual_odometry.least_points=8",
)


def _theme(name: str, roles: tuple[str, ...], outcomes: str, *overrides: str) -> ReferenceBag:
    return ReferenceBag(f"themes/{name}", overrides, tuple(outcomes.split()), roles)


REFERENCES = (
    ReferenceBag(
        "short_goals",
        # a load is shed in the middle of the run, and the drive's power is limited
        (
            "power_manager.shed_soc_first=0.2562",
            "power_manager.derate_start_voltage=27.95",
            "power_manager.derate_stop_voltage=26.0",
        ),
        ("reached", "reached", "refused"),
    ),
)
"""With all topics, for every role."""
THEMES = (
    _theme("skid", ("drive",), "reached done done jogged"),
    _theme("omni", ("drive",), "done jogged"),
    _theme("articulated", ("drive",), "done done done refused"),
    _theme("tracked", ("drive",), "done jogged"),
    _theme("lrv", ("drive",), "done refused"),
    _theme("by_hand", ("drive",), "done done jogged jogged done done"),
    _theme("faults", ("drive",), "done"),
    _theme("interlock", ("drive", "arm", "power"), "done done jogged done done done done"),
    _theme("puma", ("arm",), "reached done done done done done jogged reached done done done done done"),
    _theme("scara", ("arm",), "done done jogged done"),
    _theme("arm_tasks", ("arm",), "reached " * 9 + "done reached", UNFOLDED),
    _theme("servicer", ("arm",), "reached done done done jogged done"),
    _theme("low_charge", ("power",), "done done done done waited"),
    _theme("solar", ("power",), "waited done done done waited done waited"),
    _theme("night", ("power",), "waited done waited"),
    _theme("detour", ("drive",), "done"),
    _theme("sight", ("drive",), "done", *SMALL_IMAGES),
    _theme("steered", ("drive",), "waited jogged", "sensors.hazcam.timing.rate=0.5"),
    _theme("wrong_words", ("drive", "arm", "power"), "done " * 57),
    _theme("restarts", ("drive",), "done done done"),
    _theme("loose", ("drive",), "done", "drive.slip_policy.slow=0.15", "drive.slip_policy.another_way=0.3"),
    _theme("astern", ("drive",), "done", "drive.slip_policy.slow=0.1", "drive.slip_policy.another_way=0.15"),
    _theme("keep_out", ("drive",), "done done done done", RARE_CLOUDS),
    _theme("closed", ("drive",), "done done jogged", RARE_CLOUDS),
    _theme("cylindrical", ("arm",), "done done done jogged done done", "arm.secondary_task=manipulability"),
    _theme("table", ("arm",), "done " * 7, "arm.urdf=dh/puma560.yaml", "arm.secondary_task=centred", WEAK_BUS),
    _theme("redundant", ("arm",), "done done done jogged done", "arm.secondary_task=clear", OBSTACLE),
    _theme("drill", ("arm",), "reached done done reached done", UNFOLDED),
    _theme("gripper", ("arm",), "done done reached done done reached", UNFOLDED),
    _theme("touch", ("arm",), "reached " + "done " * 13 + "waited " + "done " * 6, UNFOLDED),
    _theme("arm_faults", ("arm",), "done done done done", UNFOLDED),
    _theme("arm_again", ("arm",), "done done done", UNFOLDED, RARE_CLOUDS, LITTLE_POWER),
    _theme("round", ("arm",), "waited done done done done done"),
    _theme(
        "strings", ("power",), "waited done waited done waited jogged waited jogged waited waited done waited", KALMAN
    ),
    _theme("dust", ("power",), "waited"),
)
"""Of what one bag cannot show: a kind of mobility, a limit, a refusal, a task, a fault."""


def references_folder() -> Path:
    """Where they stand."""
    return repository_root() / "test" / "replay"


def default_reference() -> Path:
    """The bag that is played to a candidate where no other is named."""
    return references_folder() / REFERENCES[0].name
