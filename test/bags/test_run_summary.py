"""Summary and report of a made-up run whose numbers are known in closed form."""

import json
import math
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from geometry_msgs.msg import TwistStamped
from matplotlib.image import imread
from nav_msgs.msg import Odometry
from synthetic import PERIOD, SyntheticRun

from sojourn_bags.completeness import RECORD, account
from sojourn_bags.definitions import RUN_RECORD
from sojourn_bags.description import Run
from sojourn_bags.errors import IncompleteConfigError, UnknownTopicInBagError
from sojourn_bags.goals import refused_velocities
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.report import write_report
from sojourn_bags.summary import summarise, unsent_words, write_summary
from sojourn_config.scenario import load_scenario
from sojourn_contract.topics import TOPICS

RADIUS, YAW_END = 6.0, 1.5
HEIGHT = 0.5
DRIVE_PERIODS, PERIODS = 400, 1000
POWER = 90.0
SINK = 0.031
STAMPS = {"drive": 50 * PERIOD, "unfold": 450 * PERIOD, "place": 600 * PERIOD, "stow": 850 * PERIOD}
GOAL_OFF, ARM_OFF = 0.2, 0.003


def end_pose() -> tuple[float, float, float, float]:
    """Where the arc ends: x, y, z, yaw."""
    return RADIUS * math.sin(YAW_END), RADIUS * (1.0 - math.cos(YAW_END)), HEIGHT, YAW_END


def tip_by_hand(urdf: str, joints: dict[str, float]) -> np.ndarray:
    """Tip of the arm in map at the end pose, with a fixed base: another route than the summary's."""
    model = pinocchio.buildModelFromXML(urdf)
    data = model.createData()
    configuration = pinocchio.neutral(model)
    for name, angle in joints.items():
        joint = model.joints[model.getJointId(name)]
        if joint.nq == 1:
            configuration[joint.idx_q] = angle
    pinocchio.framesForwardKinematics(model, data, configuration)
    x, y, z, yaw = end_pose()
    turn = pinocchio.rpy.rpyToMatrix(0.0, 0.0, yaw)
    return turn @ data.oMf[model.getFrameId("arm_tip_link")].translation + np.array([x, y, z])


def make_run(
    folder: Path,
    goal_off: float = GOAL_OFF,
    arm_off: float = ARM_OFF,
    drive_state: str = "reached",
    frame: str = "map",
) -> Path:
    """An arc of known length, then three goals of the arm; the goals are off by known distances."""
    run = SyntheticRun(folder, "lunar_sample")
    names = [wheel.joint for wheel in run.run.machine.wheels] + list(run.run.resolved["arm"]["joint_names"])
    unfolded = dict(zip(names[6:], run.run.resolved["arm"]["named_poses"]["unfold"], strict=True))
    x, y, z, yaw = end_pose()
    tip = tip_by_hand(run.run.urdf, unfolded)
    target = tip + np.array([0.0, arm_off, 0.0])
    if frame == "base_link":
        target = pinocchio.rpy.rpyToMatrix(0.0, 0.0, yaw).T @ (target - np.array([x, y, z]))
    contacts = np.zeros((8, 11))
    for period in range(1, PERIODS + 1):
        stamp = period * PERIOD
        angle = YAW_END * min(1.0, (period - 1) / DRIVE_PERIODS)
        pose = (RADIUS * math.sin(angle), RADIUS * (1.0 - math.cos(angle)), HEIGHT, angle)
        arm = unfolded if 500 < period <= 850 else dict.fromkeys(unfolded, 0.1)
        run.truth(stamp, pose, {**dict.fromkeys(names, 0.0), **arm}, 4.0)
        contacts[:6, 3] = SINK if period == 300 else 0.01
        contacts[6:, 3] = 0.2  # pads are no wheels
        run.contacts(stamp, contacts)
        if period % 5 == 0:
            run.electrical(stamp, POWER, 0.8 - 1e-5 * period)
        if period % 50 == 0:
            drive = "moving" if period <= DRIVE_PERIODS else drive_state
            run.status(
                "/drive/status",
                stamp,
                drive,
                STAMPS["drive"],
                "blocked by a rock" if drive != "reached" else "",
            )
            sent = [stamp_ for name, stamp_ in STAMPS.items() if name != "drive" and stamp_ <= stamp]
            if sent:
                run.status(
                    "/arm/status",
                    stamp,
                    "reached" if stamp >= sent[-1] + 100 * PERIOD else "moving",
                    sent[-1],
                )
        if stamp == STAMPS["drive"]:
            run.goal("/waypoints", stamp, [(1.0, 0.0, 0.0), (x, y + goal_off, 0.0)])
        elif stamp == STAMPS["place"]:
            run.goal("/arm/goal_pose", stamp, [tuple(float(value) for value in target)], frame)
        elif stamp in (STAMPS["unfold"], STAMPS["stow"]):
            run.named_pose(stamp, "unfold" if stamp == STAMPS["unfold"] else "stow")
    run.close(PERIODS * PERIOD)
    return run.writer.path


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> Bag:
    """A run in which every goal is met."""
    return read_bag(make_run(tmp_path_factory.mktemp("good") / "bag"))


def test_numbers_of_a_good_run(good: Bag, tmp_path: Path) -> None:
    found = summarise(good, wall_time_s=8.0)
    assert found["all_met"] and found["complete"], found["verdict"]
    assert found["scenario"] == "lunar_sample" and found["seed"] == 20
    assert found["sim_time_s"] == pytest.approx(20.0)
    assert found["real_time_factor"] == pytest.approx(2.5)
    assert found["distance_m"] == pytest.approx(RADIUS * YAW_END, rel=1e-5)
    assert found["goal_error_m"] == pytest.approx(GOAL_OFF, abs=1e-9)
    assert found["arm_error_m"] == pytest.approx(ARM_OFF, abs=1e-9)
    assert found["energy_wh"] == pytest.approx(POWER * 20.0 / 3600.0, rel=1e-5)
    assert found["soc_start"] == pytest.approx(0.79995, abs=1e-6)
    assert found["soc_end"] == pytest.approx(0.79, abs=1e-6)
    assert found["max_sinkage_m"] == pytest.approx(SINK, rel=1e-6)
    assert found["max_tilt_deg"] == pytest.approx(0.0, abs=1e-5)
    assert [goal["outcome"] for goal in found["goals"]] == ["reached"] * 4
    assert found["messages"]["/truth/odom"] == {"published": PERIODS, "recorded": PERIODS}
    assert found["verdict"].startswith("Every goal was met: the rover drove 9.0 m and stopped 0.20 m from the goal")
    write_summary(found, tmp_path / "summary.json")
    assert json.loads((tmp_path / "summary.json").read_text()) == found


def test_goal_in_base_link_is_the_same_place(tmp_path: Path) -> None:
    found = summarise(read_bag(make_run(tmp_path / "bag", frame="base_link")))
    assert found["arm_error_m"] == pytest.approx(ARM_OFF, abs=1e-9)
    assert found["wall_time_s"] is None and found["real_time_factor"] is None


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"goal_off": 0.31}, "1 of 4 goals not met: drive along 2 points"),
        ({"arm_off": 0.0052}, "reached, 5.2 mm off."),
        ({"drive_state": "refused"}, "refused (blocked by a rock)"),
        (
            {"drive_state": "moving"},
            "Under way when the record ended, 1 of 4 goals: drive along 2 points to (5.98, ",
        ),
    ],
)
def test_goal_that_was_not_met_is_named(options: dict[str, float], words: str, tmp_path: Path) -> None:
    found = summarise(read_bag(make_run(tmp_path / "bag", **options)))  # type: ignore[arg-type]
    assert not found["all_met"]
    assert words in found["verdict"]


def test_steps_that_were_never_sent_and_a_roll_over_fail_the_run(tmp_path: Path) -> None:
    run = SyntheticRun(tmp_path / "bag", "lunar_sample")
    run.truth(PERIOD, (0.0, 0.0, 0.0, 0.0), {"wheel_front_left_joint": 0.0}, 0.0)
    tipped = Odometry(child_frame_id="base_link")
    tipped.pose.pose.orientation.x, tipped.pose.pose.orientation.w = math.sin(0.8), math.cos(0.8)
    run.write("/truth/odom", 2 * PERIOD, tipped)
    run.close(2 * PERIOD)
    found = summarise(read_bag(tmp_path / "bag"))
    assert not found["all_met"]
    assert found["steps_not_sent"] == 4
    assert found["max_tilt_deg"] == pytest.approx(math.degrees(1.6), abs=1e-4)
    assert found["verdict"].startswith("The rover rolled over: it tilted by 92 degrees.")
    assert found["verdict"].endswith(" 4 steps of the scenario were never sent.")
    assert found["energy_wh"] is None and found["max_sinkage_m"] is None and found["soc_end"] is None


def test_over_a_link_nobody_says_that_a_step_was_not_sent() -> None:
    """The bag is the machine's: what the link lost is not in it either."""
    far = Run.of_scenario(load_scenario("flat_drive", ["link={light_time_s: 1.3}"]))
    assert (
        unsent_words(1, far) == "1 step of the scenario was never heard by the machine: not sent, or lost on the way."
    )
    assert unsent_words(0, far) == ""


def test_a_bag_with_other_counts_than_its_recorder_wrote_is_not_complete(tmp_path: Path) -> None:
    """The recorder's word for it was believed, whatever was read."""
    run = SyntheticRun(tmp_path / "bag", "lunar_sample")
    for period in range(1, 11):
        run.truth(period * PERIOD, (0.0, 0.0, 0.5, 0.0), {}, 0.0)
    wrote = {**run.writer.recorded(), "/clock": 12, "/odom": 3}
    account_of_more = account(TOPICS, wrote, wrote, 10 * PERIOD).as_record() | {"complete": "true"}
    run.writer.close({RUN_RECORD: {"participants": "plant,recorder"}, RECORD: account_of_more})
    bag = read_bag(tmp_path / "bag")
    assert not bag.whole and "/clock (10 of 12)" in bag.misfit and "/odom (0 of 3)" in bag.misfit
    summary = summarise(bag)
    assert not summary["complete"] and f"The record is not complete: {bag.misfit}." in summary["verdict"]


def test_report_draws_the_run(good: Bag, tmp_path: Path) -> None:
    path = tmp_path / "report.png"
    write_report(good, path)
    picture = imread(path)
    assert picture.shape[0] > 1000 and picture.shape[1] > 1500
    # The track is there, in its own colour, on the upper left; and so is each of the other panels on its
    # place.
    rows, columns = picture.shape[:2]
    near = np.abs(picture[..., :3] - np.array([0.0, 0x50 / 255, 0xB5 / 255])).max(axis=2) < 0.02
    assert near[: rows // 2, : columns // 2].sum() > 500
    ink = picture[..., :3].min(axis=2) < 0.9
    for row in range(4):
        for column in range(2):
            panel = ink[row * rows // 4 : (row + 1) * rows // 4, column * columns // 2 : (column + 1) * columns // 2]
            assert panel.mean() > 0.01


def test_report_of_a_bag_without_truth_or_scenario_says_what_is_missing(good: Bag, tmp_path: Path) -> None:
    lacking = Bag(good.path, True, {"/clock": good["/clock"]}, good.attachments, good.records)
    with pytest.raises(UnknownTopicInBagError, match="/truth/odom"):
        write_report(lacking, tmp_path / "report.png")
    with pytest.raises(IncompleteConfigError, match=r"no configuration\.json attached"):
        summarise(Bag(good.path, True, good.topics, {}, good.records))


def test_velocities_by_hand_that_were_refused_are_goals_that_were_not_met(tmp_path: Path) -> None:
    """Each once for as long as the same is said of it; a goal that is refused with the same stamp is none of them."""
    run = SyntheticRun(tmp_path / "bag", "lunar_sample")
    said = {1: "", 2: "too fast", 3: "too fast", 4: "", 5: "the tool has met something", 6: "too fast"}
    for second, why in said.items():
        stamp = second * 50 * PERIOD
        run.truth(stamp, (0.0, 0.0, 0.0, 0.0), {"wheel_front_left_joint": 0.0}, 0.0)
        if second != 5:
            run.write("/cmd_vel", stamp - 10 * PERIOD, TwistStamped())
        sent = stamp - 10 * PERIOD
        run.status("/drive/status", stamp, "refused" if why else "moving", sent, why)
    run.close(300 * PERIOD)
    found = refused_velocities(read_bag(tmp_path / "bag"))
    assert [(one.goal.what, one.reason, one.end_s) for one in found] == [
        ("drive by hand", "too fast", 2.0),
        ("drive by hand", "too fast", 6.0),
    ]
    assert [one.goal.effect_s for one in found] == [1.8, 5.8] and not any(one.met for one in found)
    summary = summarise(read_bag(tmp_path / "bag"))
    assert not summary["all_met"] and "drive by hand: refused (too fast)" in summary["verdict"]
