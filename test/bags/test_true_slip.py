"""Slip in reports: as the contacts have it while the machine or the wheel moves, none where both stand."""

import array
from pathlib import Path

import numpy as np
import pytest
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState
from synthetic import FIELDS, PERIOD, SyntheticRun

from sojourn_bags.description import Run
from sojourn_bags.page.page import write_page
from sojourn_bags.reading import Bag, read_bag
from sojourn_bags.report import write_report
from sojourn_bags.true_slip import STANDING, true_slip

PHASES = {"stands": (0.0, 0.0), "spins": (0.5, 0.0), "slides": (0.0, 0.02), "drives": (0.5, 0.05)}
"""Rate of the wheels [rad/s] and speed of the machine [m/s], ten periods each."""


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Bag:
    run = SyntheticRun(tmp_path_factory.mktemp("slip") / "bag", "flat_drive")
    wheels = [wheel.joint for wheel in run.run.machine.wheels]
    contacts = np.zeros((8, len(FIELDS)))
    contacts[:, FIELDS.index("slip_ratio")], contacts[:, FIELDS.index("slip_angle")] = -0.81, 0.4
    for period in range(1, 10 * len(PHASES) + 1):
        rate, speed = list(PHASES.values())[(period - 1) // 10]
        stamp = period * PERIOD
        run.truth(stamp, (0.0, 0.0, 0.4, 0.0), dict.fromkeys(wheels, 0.1 * period), 0.0)
        odometry = Odometry(child_frame_id="base_link")
        odometry.twist.twist.linear.y = speed
        run.write("/truth/odom", stamp + 1, odometry)
        state = JointState(name=wheels, velocity=array.array("d", [rate] * len(wheels)))
        state.position = state.effort = array.array("d", [0.1 * period] * len(wheels))
        run.write("/truth/joint_states", stamp + 1, state)
        run.contacts(stamp + 1, contacts)
        if period % 5 == 0:
            run.electrical(stamp, 10.0, 0.8)
    run.close(10 * len(PHASES) * PERIOD)
    return read_bag(run.writer.path)


@pytest.mark.parametrize(("field", "value"), [("slip_ratio", -0.81), ("slip_angle", 0.4)])
def test_what_stands_does_not_slip(bag: Bag, field: str, value: float) -> None:
    slip = true_slip(bag, Run.of_bag(bag), field)
    assert slip.shape == (40, 6)
    for number, (name, (rate, speed)) in enumerate(PHASES.items()):
        expected = 0.0 if max(0.131 * rate, speed) < STANDING else value
        assert slip[10 * number + 2 : 10 * number + 8] == pytest.approx(np.full((6, 6), expected)), name


def test_page_and_picture_draw_by_one_rule(bag: Bag, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: dict[str, list[str]] = {"page": [], "picture": []}
    for where, module in (("page", "sojourn_bags.page.motion"), ("picture", "sojourn_bags.report")):
        monkeypatch.setattr(
            f"{module}.true_slip",
            lambda bag, run, field, where=where: asked[where].append(field) or true_slip(bag, run, field),
        )
    write_page(bag, tmp_path / "report.html", judged=False)
    write_report(bag, tmp_path / "report.png")
    assert asked["page"] == ["slip_ratio", "slip_angle"] and asked["picture"] == ["slip_ratio"]
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "0 where it stands" in page
    assert 'content="width=device-width, initial-scale=1"' in page and "@media (max-width: 700px)" in page
