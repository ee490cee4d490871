"""What a role of a run in real time acted on, as its heartbeats tell it, from a made-up bag."""

from pathlib import Path

import pytest
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from synthetic import CHANNELS, PERIOD, SyntheticRun, cdr

from sojourn_bags.completeness import RECORD
from sojourn_bags.definitions import RUN_RECORD
from sojourn_bags.errors import ReplayError
from sojourn_bags.heard_script import heard_script_of
from sojourn_bags.provenance import run_attachment
from sojourn_bags.reading import Bag, read_bag
from sojourn_contract.heard import ACTED, HEARD, LOST, TOOK
from sojourn_contract.heartbeat import RUNNING, Counters, heartbeat_message
from sojourn_contract.topics import STANDARD

ROLES = ("plant", "sensors", "drive", "recorder")
HEARS = [row for row in STANDARD.inputs_of("drive", ROLES) if row.publisher != "all"]
PERIODS = 5
TOLD = {
    ACTED: f"{PERIOD}*{PERIODS}",
    **{HEARD + row.name: f"{LOST}*{PERIODS}" for row in HEARS if not row.is_event},
    f"{TOOK}/goal_pose": f"{2 * PERIOD}:0",
}
"""What the drive tells of these periods: it heard nothing but a goal."""


def heard_bag(folder: Path, told: dict[str, str]) -> Bag:
    """Of a run in real time in which somebody sends a goal, and the drive tells this."""
    run = SyntheticRun(folder / "bag", "flat_drive")
    for period in range(1, PERIODS + 1):
        stamp = period * PERIOD
        if period == 2:
            run.write("/goal_pose", 0, PoseStamped(), log_time=stamp)
        run.write("/odom", stamp, Odometry())
    beat = heartbeat_message("drive", RUNNING, stamp, Counters(), extra=told)
    run.writer.write(CHANNELS["/diagnostics"], stamp, stamp, cdr(beat))
    record = {"participants": ",".join(ROLES), "lockstep": "false"}
    attached = run_attachment(record)
    run.writer._writer.add_attachment(0, 0, attached.name, attached.media_type, attached.data)
    run.writer.close({RUN_RECORD: record, RECORD: {"complete": "true"}})
    return read_bag(run.writer.path)


def test_a_goal_stands_in_the_period_in_which_it_was_taken(tmp_path: Path) -> None:
    periods = heard_script_of(heard_bag(tmp_path, TOLD), "drive").periods
    assert [period.at for period in periods] == [number * PERIOD for number in range(1, PERIODS + 1)]
    assert [len(period.goals) for period in periods] == [0, 1, 0, 0, 0]
    assert all(set(period.inputs) == {row.name for row in HEARS if not row.is_event} for period in periods)


@pytest.mark.parametrize(
    ("said", "instead"),
    [
        (f"{TOOK}/goal_pose", f"{TOOK}/nowhere"),
        (f"{TOOK}/goal_pose", f"{TOOK}/odom"),
        (f"{HEARD}/imu/data", f"{HEARD}/imu/datb"),
        (f"{HEARD}/imu/data", "ieard /imu/data"),
    ],
)
def test_what_no_role_like_it_hears_is_named(said: str, instead: str, tmp_path: Path) -> None:
    """A bit of the heartbeat was another: the replay ended in UnknownTopicError, or in a KeyError of the app's."""
    told = {instead if key == said else key: text for key, text in TOLD.items()}
    with pytest.raises(ReplayError, match="is not what it hears, so that it cannot be replayed"):
        heard_script_of(heard_bag(tmp_path, told), "drive")
