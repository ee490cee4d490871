"""Fields followed message by message are those that are read from the whole bag; layouts and CSV."""

import csv
import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sojourn_bags.fields import series
from sojourn_bags.reading import Bag
from sojourn_console.bag_feed import BagFeed
from sojourn_console.errors import GoalError, LayoutError
from sojourn_console.gate import GuardedServer
from sojourn_console.layouts import layouts_file, read_layouts, save_layout
from sojourn_console.page import SLOW, Page
from sojourn_console.panels.telemetry_panel import EVERY, TelemetryPanel
from sojourn_console.telemetry import DRAWN, FieldCurve, Telemetry, aligned, as_csv
from sojourn_console.world import World

FIELDS = (
    "/odom.pose.pose.position",
    "/joint_states.velocity[wheel_front_left_joint]",
    "/truth/contacts.sinkage",
    "/drive/status.energy_used_wh",
    "/battery_state.percentage",
)


@pytest.fixture(scope="module")
def telemetry(reference: Bag, world: World) -> Telemetry:
    telemetry = Telemetry(world.table, world.attachments)
    for field in FIELDS:
        telemetry.follow(field)
    player = BagFeed(reference, world.table)
    player.want((), telemetry.topics)
    while player.is_playing:
        player.advance(0.7)
        telemetry.hear(player.poll())
        assert not [one for one in telemetry.update().values() if "not in the bag" not in one]
    return telemetry


@pytest.mark.parametrize("field", FIELDS)
def test_a_field_is_that_of_the_bag(reference: Bag, telemetry: Telemetry, field: str) -> None:
    found = {curve.name: curve for curve in telemetry.curves(field)}
    expected = series(reference, field)
    assert {one.name for one in expected} <= found.keys()
    for one in expected:
        curve = found[one.name]
        assert curve.unit == one.unit
        assert (curve.times == one.times).all() and (curve.values == one.values).all()


def test_fields_of_a_topic_are_listed(reference: Bag, world: World) -> None:
    telemetry = Telemetry(world.table, world.attachments)
    telemetry.asked = "/odom"
    player = BagFeed(reference, world.table)
    player.want({"/odom"}, ())
    telemetry.hear(player.poll())
    telemetry.update()
    assert "twist.twist.linear.x" in telemetry.names_of("/odom") and not telemetry.names_of("/plan")


def test_what_there_is_not_is_told(reference: Bag, world: World) -> None:
    telemetry = Telemetry(world.table, world.attachments)
    with pytest.raises(GoalError, match="no such topic"):
        telemetry.follow("/odometry.x")
    with pytest.raises(GoalError, match="a field is missing"):
        telemetry.follow("/odom")
    telemetry.follow("/odom.twist.twist.linaer.x")
    player = BagFeed(reference, world.table)
    player.want((), telemetry.topics)
    telemetry.hear(player.poll())
    (problem,) = telemetry.update().values()
    assert "twist.twist.linear.x" in problem  # the nearest that there is
    telemetry.forget("/odom.twist.twist.linaer.x")
    assert not telemetry.fields and not telemetry.topics


@given(st.integers(2, 5000), st.floats(0.0, 50.0))
def test_thinning_keeps_extremes_and_the_last(count: int, since: float) -> None:
    times = np.linspace(0.0, 100.0, count)
    values = np.sin(times) + 5.0 * (np.arange(count) == count - 1)
    curve = FieldCurve("a", "m", times, values)
    own, kept = aligned([curve], since)
    shown = times >= since
    assert len(own) <= DRAWN + 3
    assert kept[-1] == values[-1] and own[-1] == times[-1]
    assert kept.min() == pytest.approx(values[shown].min(), abs=1e-12) and own[0] >= since


def test_csv_has_a_line_a_time_and_no_value_where_there_is_none() -> None:
    one = FieldCurve("/a.x", "m", np.array([0.0, 0.02, 0.04]), np.array([1.0, 1.5, 0.1 + 0.2]))
    other = FieldCurve("/b.y", "", np.array([0.02]), np.array([7.0]))
    rows = list(csv.reader(io.StringIO(as_csv([one, other]))))
    assert rows[0] == ["time [s]", "/a.x [m]", "/b.y"]
    assert rows[1] == ["0", "1.0", ""] and rows[2] == ["0.02", "1.5", "7.0"]
    assert float(rows[3][1]) == 0.1 + 0.2


def test_layouts_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    file = layouts_file()
    assert file.parent == tmp_path / "sojourn" and read_layouts(file) == {}
    save_layout(file, "wheels", FIELDS)
    save_layout(file, "power", ("/battery_state.voltage #",))
    assert read_layouts(file) == {"wheels": FIELDS, "power": ("/battery_state.voltage #",)}
    with pytest.raises(LayoutError, match="allowed are 1 to 40"):
        save_layout(file, "../x", FIELDS)
    with pytest.raises(LayoutError, match="nothing to keep"):
        save_layout(file, "empty", ())
    file.write_text("[1]", encoding="utf-8")
    with pytest.raises(LayoutError, match="object of lists"):
        read_layouts(file)
    file.write_text("{", encoding="utf-8")
    with pytest.raises(LayoutError, match="cannot be read"):
        read_layouts(file)


def test_a_field_is_a_plot_or_a_number_and_not_both(reference: Bag, world: World) -> None:
    """The plot of one that was asked for as a number stood still, and never went on when asked for again."""
    page = Page(GuardedServer("telemetry", 9170), world, BagFeed(reference, world.table))
    try:
        (panel,) = (one for one in page._tabs if isinstance(one, TelemetryPanel))
        field, feed = "/battery_state.percentage", page.bench.feed
        assert isinstance(feed, BagFeed)

        def shown(as_number: bool) -> tuple[bool, bool]:
            """Whether it is drawn, and in the table."""
            panel._follow(field, as_number)
            for _ in range(2 * EVERY * SLOW):
                feed.advance(0.05)
                page.look()
            return field in panel._plots, field in panel._table.content

        assert [shown(as_number) for as_number in (False, True, False)] == [(True, False), (False, True), (True, False)]
    finally:
        page.close()
