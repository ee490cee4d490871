"""Fields by the names that people type, against the numbers that were written; and their units."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from mcap.writer import Writer
from nav_msgs.msg import Odometry
from synthetic import PERIOD, SyntheticRun, cdr

from sojourn_bags.definitions import typestore
from sojourn_bags.errors import UnknownFieldError
from sojourn_bags.fields import series
from sojourn_bags.plot import by_unit, draw, write_table
from sojourn_bags.reading import Bag, read_bag
from sojourn_contract.heartbeat import status_message

PERIODS = 20


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Bag:
    """Twenty periods with a little of everything."""
    run = SyntheticRun(tmp_path_factory.mktemp("fields") / "bag", "flat_drive")
    wheels = [wheel.joint for wheel in run.run.machine.wheels]
    points = np.zeros((len(wheels) + len(run.run.machine.pads), 11))
    for period in range(1, PERIODS + 1):
        stamp = period * PERIOD
        joints = {name: 0.1 * number * period for number, name in enumerate(wheels)}
        run.truth(stamp, (0.5 * period, -0.25 * period, 0.4, 0.0), joints, 1.0)
        points[: len(wheels), 3] = 0.001 * np.arange(len(wheels)) + 0.01
        points[len(wheels) + 2, 3] = 0.003  # the third pad touches
        run.contacts(stamp, points)
        if period % 5 == 0:
            values = {"soc": f"{1.0 - 0.01 * period}", "state": "normal", "correcting": "true", "reserve_wh": "3.5"}
            run.write("/power/status", stamp, status_message(stamp, "power", values))
            for role in ("drive", "arm"):
                beat = status_message(stamp, role, {"published /odom": str(period + len(role))})
                run.write("/diagnostics", stamp, beat)
            run.write(
                "/truth/loads", stamp, status_message(stamp, "loads", {"power arm": "2.5", "energy electrical": "9"})
            )
            run.write("/power/switches", stamp, status_message(stamp, "switches", {"arm": "on", "drive": "0.25"}))
    run.close(PERIODS * PERIOD)
    return read_bag(run.writer.path)


def test_number_of_a_message(bag: Bag) -> None:
    (found,) = series(bag, "/truth/odom.pose.pose.position.x")
    assert (found.name, found.unit) == ("/truth/odom.pose.pose.position.x", "m")
    np.testing.assert_allclose(found.times, 0.02 * np.arange(1, PERIODS + 1))
    np.testing.assert_allclose(found.values, 0.5 * np.arange(1, PERIODS + 1))
    assert [one.name.rpartition(".")[2] for one in series(bag, "/truth/odom.pose.pose.position")] == ["x", "y", "z"]


@pytest.mark.parametrize("which", ["wheel_middle_right_joint", "3"])
def test_joint_by_name_and_by_number(bag: Bag, which: str) -> None:
    (found,) = series(bag, f"/truth/joint_states.position[{which}]")
    assert found.name == "/truth/joint_states.position[wheel_middle_right_joint]" and found.unit == "rad"
    np.testing.assert_allclose(found.values, 0.3 * np.arange(1, PERIODS + 1))
    assert len(series(bag, "/truth/joint_states.effort")) == 6


def test_contacts_by_wheel_and_by_number(bag: Bag) -> None:
    (by_name,), (by_number,) = (series(bag, f"/truth/contacts.sinkage[{which}]") for which in ("rear_left", "4"))
    assert by_name.name == by_number.name == "/truth/contacts.sinkage[rear_left]" and by_name.unit == "m"
    np.testing.assert_allclose(by_name.values, 0.014, rtol=1e-6)
    names = [one.name.partition("[")[2].strip("]") for one in series(bag, "/truth/contacts.sinkage")]
    assert names[:2] == ["front_left", "front_right"] and len(names) == 7 and names[6] == "belly_rear_left"
    (untouched,) = series(bag, "/truth/contacts.sinkage[belly_middle]")
    assert not untouched.values.any()
    assert series(bag, "/truth/contacts.force_z[front_left]")[0].unit == "N"


def test_keys_of_statuses(bag: Bag) -> None:
    (soc,) = series(bag, "/power/status.soc")
    np.testing.assert_allclose(soc.values, [0.95, 0.9, 0.85, 0.8])
    np.testing.assert_allclose(soc.times, [0.1, 0.2, 0.3, 0.4])
    assert series(bag, "/power/status.correcting")[0].values.tolist() == [1.0] * 4
    assert series(bag, "/power/status.reserve_wh")[0].unit == "Wh"
    assert series(bag, "/power/switches.drive")[0].values.tolist() == [0.25] * 4
    assert [series(bag, f"/truth/loads.{key}")[0].unit for key in ("power arm", "energy electrical")] == ["W", "J"]
    both = series(bag, "/diagnostics.published /odom")
    assert [one.name for one in both] == [f"/diagnostics.published /odom[{role}]" for role in ("drive", "arm")]
    (arm,) = series(bag, "/diagnostics.published /odom[arm]")
    assert arm.values.tolist() == [8.0, 13.0, 18.0, 23.0]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("/truth/odm.pose", "/truth/odm is not in the bag: nearest are /truth/odom"),
        ("/truth/odom.position.x", "nearest are /truth/odom.pose.pose.position.x"),
        ("/truth/odom", "needs a field after a dot: nearest are /truth/odom.pose.pose.position.x"),
        ("/truth/joint_states.position[wheel_front]", "nearest are position\\[wheel_front_left_joint\\]"),
        ("/truth/joint_states.position[99]", "is not in the bag: nearest are position"),
        ("/power/status.state", "holds texts \\('normal'\\) and no numbers"),
        ("/power/status.sok", "nearest are /power/status.soc"),
        ("/truth/contacts.sinkages", "nearest are /truth/contacts.sinkage"),
    ],
)
def test_unknown_names_are_answered_with_the_nearest(bag: Bag, text: str, words: str) -> None:
    with pytest.raises(UnknownFieldError, match=words):
        series(bag, text)


def test_picture_has_a_panel_for_each_unit_and_the_table_every_number(bag: Bag, tmp_path: Path) -> None:
    texts = ("/truth/odom.pose.pose.position.x", "/power/status.soc", "/truth/contacts.sinkage[front_left]")
    found = [one for text in texts for one in series(bag, text)]
    assert {unit: len(group) for unit, group in by_unit(found).items()} == {"m": 2, "": 1}
    draw(found, tmp_path / "plot.png", "a title")
    assert imread(tmp_path / "plot.png").std() > 0.05
    write_table(found, tmp_path / "plot.csv")
    with (tmp_path / "plot.csv").open(newline="") as stream:
        head, *rows = csv.reader(stream)
    assert head == ["stamp [s]", f"{texts[0]} [m]", texts[1], f"{texts[2]} [m]"]
    assert len(rows) == PERIODS and rows[4][:3] == ["0.100000000", "2.5", "0.95"] and rows[3][2] == ""


def test_type_that_only_the_bag_knows(tmp_path: Path) -> None:
    """A message of another robot, with its definition in the bag; and one without, which is refused in words."""
    text = "std_msgs/Header header\nfloat64 depth\nfloat32[2] pair\n" + "=" * 80 + "\nMSG: std_msgs/Header\n"
    text += "builtin_interfaces/Time stamp\nstring frame_id\n"
    path = tmp_path / "theirs.mcap"
    header = cdr(Odometry())[4:16]  # stamp zero and an empty frame, padded to a multiple of 4
    depth = np.array([1.5, 2.5, math.pi])
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2", library="theirs")
        known = writer.register_channel(
            "/depth", "cdr", writer.register_schema("sonar/msg/Depth", "ros2msg", text.encode())
        )
        secret = writer.register_channel("/secret", "cdr", writer.register_schema("sonar/msg/Secret", "", b""))
        for number, value in enumerate(depth):
            body = np.array([value]).tobytes() + np.array([number, -number], dtype=np.float32).tobytes()
            writer.add_message(known, number * 10**9, b"\0\1\0\0" + header + b"\0" * (16 - len(header)) + body, 0)
            writer.add_message(secret, number * 10**9, b"\0\1\0\0abcd", 0)
        writer.finish()
    bag = read_bag(path)
    assert "sonar/msg/Depth" in typestore().fielddefs
    (found,) = series(bag, "/depth.depth")
    np.testing.assert_array_equal(found.values, depth)
    np.testing.assert_array_equal(found.times, [0.0, 1.0, 2.0])  # not stamped: when they were recorded
    assert series(bag, "/depth.pair[1]")[0].values.tolist() == [0.0, -1.0, -2.0]
    with pytest.raises(UnknownFieldError, match="a type that is not known"):
        series(bag, "/secret.depth")
