"""Range finders and line scanners as sensors of a machine: messages, night, faults, timing, what is refused."""

import math
from array import array
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import LaserScan, Range

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.codecs import decode, encode
from sojourn_contract.codecs.ros_library import message_of, serialised
from sojourn_contract.conformance.numbers import NumberRule
from sojourn_contract.conformance.observation import Observation
from sojourn_contract.run_table import row_named, table_of
from sojourn_contract.values import Odometry, Serialised
from sojourn_machine.mounting import mounting
from sojourn_sensors.app import SensorsApp
from sojourn_sensors.kinds.lidar import SCAN, LineScanner
from sojourn_sensors.kinds.range_finder import ROW, RangeFinder
from sojourn_sensors.sensor import Sensor, Truth
from sojourn_stack.apps import make_apps
from sojourn_stack.stack import Stack

FINDER = "sensors.altimeter={{kind: range_finder, link: hazcam_link, nearest: 0.1, range: 60.0, noise: 0.0{more}}}"
SCANNER = (
    "sensors.line={{kind: lidar, link: hazcam_link, columns: 181, rows: 1, horizontal_view_deg: 180.0, "
    "vertical_view_deg: 0.0, nearest: 0.1, range: 60.0, noise: 0.0{more}}}"
)
HEIGHT = 0.45
"""Of base_link [m]."""


def told(table: str, more: str = "") -> str:
    return table.format(more=f", {more}" if more else "")


def sensor(table: str, *overrides: str, more: str = "") -> tuple[Any, Truth]:
    """On the explorer, and a truth of it on flat ground."""
    app = SensorsApp(load_scenario("flat_drive", [told(table, more), *overrides]))
    (one,) = (each for each in app.sensors if isinstance(each, RangeFinder | LineScanner))
    pose = np.array([0.0, 0.0, HEIGHT]), np.array([0.0, 0.0, 0.0, 1.0])
    odometry = Odometry(0, "map", "base_link", *pose, np.zeros(3), np.zeros(3))
    return one, replace(app._at_rest(), odometry=odometry, stamp=10**9)


def said(one: Sensor[Any, Any, Any], truth: Truth) -> Any:
    """Its message."""
    reading = one.step(one.initial_state(truth), truth, 0.02)[1]
    ((_, message),) = one.messages(truth.stamp, reading)
    return message_of(message)


def to_ground(one: Sensor[Any, Any, Any], ray: Any) -> float:
    """Distance along a direction of the sensor's link to level ground [m]."""
    turn, place = mounting(one.site.scenario.urdf_xml, one.params.link)
    down = -float((turn @ ray)[2])
    return float((place[2] + HEIGHT) / down) if down > 0.0 else math.inf


def test_a_range_finder_reads_how_far_the_ground_is_along_its_link_by_day_and_night() -> None:
    for overrides in ((), ("sun.elevation_deg=-30",)):
        one, truth = sensor(FINDER, *overrides, more="radiation: radar, target_reflectance: 0.3")
        message = said(one, truth)
        assert isinstance(message, Range) and message.header.frame_id == "hazcam_link"
        assert message.radiation_type == Range.INFRARED, "the message knows no radar"
        assert message.range == pytest.approx(to_ground(one, np.array([1.0, 0.0, 0.0])), abs=0.03)
        assert (message.min_range, message.max_range) == pytest.approx((0.1, 60.0))


def test_a_cone_reads_less_than_its_axis() -> None:
    axis, cone = (said(*sensor(FINDER, more=more)) for more in ("", "field_of_view_deg: 20.0"))
    assert cone.range < axis.range - 0.01 and cone.field_of_view == pytest.approx(math.radians(20.0))


def test_ultrasound_is_told_where_there_is_air() -> None:
    sound = "radiation: ultrasound, target_reflectance: 0.5"
    assert said(*sensor(FINDER, "body=earth", more=sound)).radiation_type == Range.ULTRASOUND
    with pytest.raises(ConfigError, match="has no air, which the sensor altimeter of explorer needs"):
        load_scenario("flat_drive", [told(FINDER, sound), "body=moon"])


def test_a_line_scanner_says_a_scan_from_right_to_left() -> None:
    one, truth = sensor(SCANNER)
    message = said(one, truth)
    assert isinstance(message, LaserScan) and message.header.frame_id == "hazcam_link"
    angles = message.angle_min + message.angle_increment * np.arange(len(message.ranges))
    assert np.degrees(angles) == pytest.approx(np.linspace(-90.0, 90.0, 181), abs=1e-4)
    assert math.degrees(message.angle_max) == pytest.approx(90.0) and message.scan_time == pytest.approx(0.1)
    expected = np.array([to_ground(one, np.array([math.cos(a), math.sin(a), 0.0])) for a in angles])
    ranges = np.array(message.ranges)
    with np.errstate(invalid="ignore"):
        from_ground = np.abs(ranges - expected) < 0.02 + 0.02 * ranges
    assert from_ground.sum() > 60
    heard = np.isfinite(ranges)
    assert ((np.array(message.intensities) > 0.0) == heard).all()


def test_a_line_scanner_sees_the_machine_and_what_is_too_far_is_infinite() -> None:
    one, truth = sensor(SCANNER.replace("hazcam_link", "base_link").replace("range: 60.0", "range: 3.0"))
    message = said(one, truth)
    high = truth.odometry._replace(position=np.array([0.0, 0.0, 50.0]))
    aloft = said(one, replace(truth, odometry=high))
    near, far = np.array(message.ranges), np.array(aloft.ranges)
    assert np.isposinf(far).any() and not np.isnan(far).any()
    seen = np.isfinite(far)
    assert seen.any(), "nothing but the machine is there"
    assert near[seen] == pytest.approx(far[seen])


def test_without_power_nothing_is_measured() -> None:
    one, truth = sensor(FINDER)
    ((_, message),) = one.messages(0, one.step_without_power(one.initial_state(truth), truth, 0.02)[1])
    assert math.isnan(message_of(message).range)
    one, truth = sensor(SCANNER)
    ((_, scan),) = one.messages(0, one.step_without_power(one.initial_state(truth), truth, 0.02)[1])
    assert len(message_of(scan).ranges) == len(message_of(scan).intensities) == 0


@pytest.mark.parametrize("table", [FINDER, SCANNER])
def test_readings_are_the_same_for_the_same_seed_and_over_the_wire(table: str) -> None:
    noisy = "dropped: 0.2, noise_per_metre: 0.01"
    first, again, other = (said(*sensor(table, *overrides, more=noisy)) for overrides in ((), (), ("seed=5",)))
    row = row_named("/line/scan" if table is SCANNER else "/altimeter/range")
    assert row is not None and first == again != other
    back = decode(row, encode(row, serialised(first)))
    assert isinstance(back, Serialised) and message_of(back) == first


@pytest.mark.parametrize(("table", "row"), [(FINDER, ROW), (SCANNER, SCAN)])
def test_infinite_distances_are_what_the_row_says_and_other_infinities_are_not(table: str, row: Any) -> None:
    one, truth = sensor(table)
    good = said(one, truth)
    field = "ranges" if row is SCAN else "range"
    for value in (math.inf, -math.inf):
        assert not _judged(row, good, field, value)
    assert _judged(row, good, field, 6000.0)
    assert _judged(row, said(one, truth), "intensities" if row is SCAN else "max_range", math.inf)


def _judged(row: Any, message: Any, field: str, value: float) -> Any:
    """What is found in a message with another number in a field."""
    setattr(message, field, [value] * 3 if isinstance(getattr(message, field), array) else value)
    return NumberRule(row).judge(Observation(row, message, 0, 0, 0))


def messages_of(table: str, more: str, periods: int = 130) -> dict[int, Any]:
    """What is said in a run of a standing machine, by stamp [periods]."""
    scenario, roles = load_scenario("flat_drive", [told(table, more)]), ("plant", "sensors")
    stack = Stack(make_apps(scenario, roles), roles, table_of(scenario))
    state, _ = stack.begin()
    heard = {}
    for _ in range(periods):
        state, told_now = stack.step(state)
        heard |= {
            message.stamp // 20_000_000: message_of(message)
            for row, message in told_now
            if row.name in ("/altimeter/range", "/line/scan")
        }
    return heard


def test_timing_is_that_of_its_table() -> None:
    assert list(messages_of(FINDER, "")) == list(range(5, 131, 5))
    assert list(messages_of(FINDER, "timing: {rate: 2.0, latency: 0.1}")) == [25, 50, 75, 100, 125]
    assert messages_of(SCANNER, "timing: {rate: 25.0}")[2].scan_time == pytest.approx(0.04)
    assert not messages_of(SCANNER, "faults: {broken: {dead: true}}")


def test_faults_are_on_distances_and_stay_distances() -> None:
    sound, off = (messages_of(FINDER, more)[50].range for more in ("", "faults: {off: {bias: 0.5}}"))
    assert off - sound == pytest.approx(0.5, abs=1e-5)
    assert messages_of(FINDER, "faults: {gone: {scale: -1.0}}")[50].range == -math.inf
    scans = {
        more: messages_of(SCANNER, more)[50]
        for more in ("", "faults: {off: {bias: 0.5}}", "faults: {window: {dust: 0.5}}")
    }
    whole, biased, dusty = (np.array(scan.ranges) for scan in scans.values())
    heard = np.isfinite(whole) & np.isfinite(biased)
    assert biased[heard] - whole[heard] == pytest.approx(np.full(heard.sum(), 0.5), abs=1e-5)
    assert 0.2 < np.isfinite(dusty).sum() / np.isfinite(whole).sum() < 0.8
    stuck = messages_of(FINDER, "noise_per_metre: 0.05, faults: {held: {stuck: true, after: 1.0}}")
    assert stuck[45].range == stuck[60].range == stuck[125].range != stuck[40].range


def test_one_kind_of_rows_alone_is_in_the_table_of_a_run() -> None:
    names = [row.name for row in table_of(load_scenario("flat_drive", [told(SCANNER)]))]
    assert "/line/scan" in names and "/line/points" not in names


@pytest.mark.parametrize(
    ("override", "words"),
    [
        (told(FINDER).replace("hazcam_link", "tail_link"), "tail_link"),
        (told(FINDER, "timing: {rate: 7.0}"), "a divisor of the control rate"),
        (told(FINDER).replace("nearest: 0.1", "nearest: 60.0"), "less than range"),
        (told(FINDER, "radiation: radar"), "no target_reflectance: needed with radiation = radar"),
        (told(SCANNER).replace("columns: 181", "columns: 4097"), "columns"),
    ],
)
def test_what_cannot_be_is_said_before_the_run(override: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        load_scenario("flat_drive", [override])


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("{dust: 0.2}", "no lens"),
        ("{of: range, bias: 1.0}", "no quantity: there is one alone"),
        ("{bias: [1.0, 2.0]}", "one number"),
    ],
)
def test_a_fault_that_no_distance_can_have_is_said_before_the_run(fault: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        SensorsApp(load_scenario("flat_drive", [told(FINDER, f"faults: {{odd: {fault}}}")]))
