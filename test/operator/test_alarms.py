"""Alarms: levels, persistence, hysteresis, latching, acknowledgement; the log; usual limits; a run's bag."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from sojourn_bags.reading import Bag, read_bag
from sojourn_bringup.alarms import main
from sojourn_bringup.alarms_bag import watched_bag
from sojourn_config.command_errors import UsageError
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract import named_fields
from sojourn_contract.errors import UnknownFieldNameError
from sojourn_contract.heartbeat import ENDED, STALLED, Counters, Heartbeat, heartbeat_message, status_message
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topic_types import ROLES
from sojourn_contract.topics import STANDARD
from sojourn_contract.values import BatteryState, Message, PoseStamped, TwistStamped
from sojourn_operator.alarms.beats import Beats
from sojourn_operator.alarms.engine import AlarmEngine, AlarmState
from sojourn_operator.alarms.narrator import Narrator
from sojourn_operator.alarms.params import AlarmParams, Severity
from sojourn_operator.alarms.usual import tip_over_angle, usual_limits
from sojourn_operator.alarms.watch import Watch, limits_of
from sojourn_operator.goal_messages import drive_goal, stop_messages

REFERENCE = Path(__file__).parents[1] / "replay" / "short_goals"
CHARGE = "/battery_state"
WATCH, WARNING, CRITICAL, NONE = Severity.WATCH, Severity.WARNING, Severity.CRITICAL, Severity.NONE


def engine(**values: object) -> AlarmEngine:
    limits = {"watch": {"below": 0.5}, "warning": {"below": 0.4}, "critical": {"below": 0.2}, **values}
    return AlarmEngine({"charge": AlarmParams.model_validate({"field": f"{CHARGE}.percentage", **limits})}, STANDARD)


def fed(one: AlarmEngine, values: list[float], state: AlarmState | None = None, begin: int = 0) -> list[AlarmState]:
    """States after each of these, one a second."""
    states = [state or one.initial_state()]
    for second, value in enumerate(values, begin):
        message = BatteryState(second * NANOSECONDS, percentage=value)
        states.append(one.step(states[-1], CHARGE, message)[0])
    return states[1:]


def active(states: list[AlarmState]) -> list[Severity]:
    return [state.alarms["charge"].active for state in states]


def test_levels_rise_and_fall_with_the_value() -> None:
    states = fed(engine(), [0.6, 0.45, 0.3, 0.1, 0.45, 0.6])
    assert active(states) == [NONE, WATCH, WARNING, CRITICAL, WATCH, NONE]


def test_it_has_to_hold_so_long() -> None:
    states = fed(engine(persistence_s=2.0), [0.1, 0.6, 0.1, 0.1, 0.1, 0.6])
    assert active(states) == [NONE, NONE, NONE, NONE, CRITICAL, NONE]


def test_it_is_over_only_beyond_the_hysteresis() -> None:
    states = fed(engine(hysteresis=0.05), [0.49, 0.52, 0.56, 0.52])
    assert active(states) == [WATCH, WATCH, NONE, NONE]


def test_it_stays_at_its_worst_until_it_is_acknowledged() -> None:
    one = engine()
    *_, state = fed(one, [0.1, 0.6])
    (shown,) = state.shown
    assert (shown.active, shown.worst, state.worst) == (NONE, CRITICAL, CRITICAL)
    state, events = one.acknowledge(state, 5, "anna")
    assert not state.shown and [event.who for event in events] == ["anna"]


def test_acknowledged_while_it_lasts_it_goes_by_itself_and_comes_again_when_worse() -> None:
    one = engine()
    *_, state = fed(one, [0.45])
    state, _ = one.acknowledge(state, 1, "anna", ["charge"])
    assert state.shown and state.worst is NONE  # seen, and still there
    *_, worse = fed(one, [0.3], state, 2)
    assert (worse.worst, worse.shown[0].acknowledged) == (WARNING, "")
    *_, over = fed(one, [0.6], state, 2)
    assert not over.shown
    with pytest.raises(KeyError):
        one.acknowledge(over, 3, "anna", ["charge"])


def test_one_that_is_not_latched_goes_by_itself() -> None:
    assert not fed(engine(latched=False), [0.1, 0.6])[-1].shown


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=30), st.floats(0.0, 0.2))
def test_no_level_is_missed_or_invented(values: list[float], hysteresis: float) -> None:
    states = fed(engine(hysteresis=hysteresis), values)
    for value, level in zip(values, active(states), strict=True):
        sure = CRITICAL if value < 0.2 else WARNING if value < 0.4 else WATCH if value < 0.5 else NONE
        possible = CRITICAL if value < 0.2 + hysteresis else WARNING if value < 0.4 + hysteresis else (
            WATCH if value < 0.5 + hysteresis else NONE)  # fmt: skip
        assert sure <= level <= possible
    worst = max(active(states))
    assert states[-1].worst == worst


def test_texts_are_compared_and_a_key_that_is_not_there_is_told_once() -> None:
    limits = {
        "state": AlarmParams.model_validate(
            {"field": "/drive/status.state", "warning": {"equals": ["failed", "stopped"]}, "watch": {"contains": "ov"}}
        ),
        "typo": AlarmParams.model_validate({"field": "/drive/status.sip", "watch": {"above": 1.0}}),
    }
    one = AlarmEngine(limits, STANDARD)
    state, told = one.initial_state(), []
    for second, word in enumerate(("idle", "moving", "stopped")):
        state, events = one.step(state, "/drive/status", status_message(second, "drive", {"state": word, "slip": "0"}))
        told += [(event.who, event.severity) for event in events]
    assert told == [("typo", NONE), ("state", WATCH), ("state", WARNING)]


def test_what_a_field_may_be_meant_for_is_not_looked_for_where_another_role_has_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It took a twelfth of the page's time: a heartbeat of one role has not what another tells, second for second."""
    monkeypatch.setattr(named_fields, "get_close_matches", lambda *_: pytest.fail("looked for"))
    limits = {"slow": AlarmParams.model_validate({"field": "/diagnostics.detail[plant]", "watch": {"contains": "x"}})}
    one, message = AlarmEngine(limits, STANDARD), heartbeat_message("drive", "running", NANOSECONDS, Counters())
    assert one.step(one.initial_state(), "/diagnostics", message) == (one.initial_state(), [])


def test_a_field_that_no_topic_has_is_refused() -> None:
    with pytest.raises(UnknownFieldNameError, match="percentage"):
        AlarmEngine(
            {"x": AlarmParams.model_validate({"field": f"{CHARGE}.percent", "watch": {"above": 1.0}})}, STANDARD
        )


def test_who_waits_for_a_keeper_of_time_that_has_ended_is_no_alarm() -> None:
    """Every run in real time ended with a critical alarm for each of its nodes, in its bag and on every page."""
    limits = {"roles": AlarmParams.model_validate({"field": "/diagnostics.state", "critical": {"equals": STALLED}})}
    watch = Watch(limits, STANDARD)

    def worst(*beats: tuple[str, str]) -> Severity:
        state = watch.initial_state()
        for second, (role, word) in enumerate(beats, 1):
            message = heartbeat_message(role, word, second * NANOSECONDS, Counters())
            state, _ = watch.step(state, "/diagnostics", message)
        return state.alarms.worst

    assert worst(("plant", "running"), ("plant", ENDED), ("drive", STALLED), ("drive", ENDED)) is Severity.NONE
    assert worst(("drive", ENDED), ("arm", STALLED)) is Severity.CRITICAL
    assert worst(("plant", ENDED), ("plant", "running"), ("drive", STALLED)) is Severity.CRITICAL


def test_the_log_has_what_nodes_goals_and_contract_say_each_once() -> None:
    narrator = Narrator(STANDARD)
    state, lines = narrator.initial_state(), []
    counters = Counters()
    beats = [heartbeat_message("drive", "running", second * NANOSECONDS, counters) for second in (1, 2)]
    counters.count_refused("/cmd_vel", "too old")
    beats.append(heartbeat_message("drive", STALLED, 3 * NANOSECONDS, counters, "waits for sensors"))
    beats += [heartbeat_message("plant", "running", second * NANOSECONDS, Counters()) for second in range(4, 9)]
    for beat in beats:
        state, events = narrator.step(state, "/diagnostics", beat)
        lines += [(event.kind, event.who, event.text) for event in events]
    assert lines == [
        ("node", "drive", "running"),
        ("node", "drive", "stalled: waits for sensors"),
        ("contract", "drive", "refused 1 on /cmd_vel: too old"),
        ("node", "plant", "running"),
        ("node", "drive", "has been silent for 3 s"),
    ]
    said = []
    for second, word in enumerate(("moving", "moving", "reached")):
        message = status_message(second, "drive", {"state": word, "reason": "there" if word == "reached" else ""})
        state, events = narrator.step(state, "/drive/status", message)
        said += [event.text for event in events]
    assert said == ["moving", "reached: there"]


def test_where_the_clock_leaps_nobody_is_silent() -> None:
    """Each leap was told as the silence of all but the first to beat after it."""
    beats = [
        ("/diagnostics", heartbeat_message(role, "running", second * NANOSECONDS, Counters()))
        for second in (60, 1260, 2460, 3660, 4860)
        for role in ("plant", "sensors", "drive", "arm", "power")
    ]
    assert [text for _, text in told(*beats)] == ["running"] * 5


def test_a_driver_with_a_clock_of_its_own_changes_no_time() -> None:
    """All nodes were silent from its first word on, and a stop was told of a time in half a century."""
    late = 1_790_000_000
    strange = [status_message(late * NANOSECONDS, "lidar", {"temperature": "3"}),
               heartbeat_message("lidar", "running", late * NANOSECONDS, Counters())]  # fmt: skip
    beats = [
        ("/diagnostics", heartbeat_message(role, "running", second * NANOSECONDS, Counters()))
        for second in range(1, 9)
        for role in ("plant", "drive")
    ]
    heard = [one for number, beat in enumerate(beats) for one in (beat, ("/diagnostics", strange[number % 2]))]
    assert told(*heard, STOP) == [(1.0, "running"), (1.0, "running"), (1.0, "running"), (8.0, STANDS)]


@given(st.lists(st.tuples(st.sampled_from(ROLES), st.integers(1, 3600)), max_size=60))
def test_who_beats_with_the_last_is_not_silent(order: list[tuple[str, int]]) -> None:
    """Whatever the leaps; and who has missed a beat has missed no more than there have been since."""
    beats, now, times = Beats(), 0, dict[str, int]()
    for role, leap in order:
        now += leap * NANOSECONDS
        beats = beats.after(Heartbeat(role, "running", "", now, {}, {}, {}))
        times[role] = now
    for role, stamp in times.items():
        later = len({one for one in beats.stamps.values() if one > stamp})
        missed = beats.missed[role]
        assert (missed == 0) == (stamp == now) and later <= missed <= len(order)
        assert beats.silent(missed)[role] == (now - stamp) / NANOSECONDS and role not in beats.silent(missed + 1)


def told(*heard: tuple[str, Message]) -> list[tuple[float, str]]:
    """What the log says of these, with its time [s]."""
    watch = Watch({}, STANDARD)
    state, log = watch.initial_state(), []
    for name, message in heard:
        state, events = watch.step(state, name, message)
        log += [(event.stamp / NANOSECONDS, event.text) for event in events]
    return log


def twist(second: float, forward: float = 0.05) -> tuple[str, TwistStamped]:
    return "/cmd_vel", TwistStamped(
        round(second * NANOSECONDS), "base_link", np.array([forward, 0.0, 0.0]), np.zeros(3)
    )


STOP, ARM_STOP = stop_messages(0)
STANDS = "/cmd_vel: 0.00 m/s, 0.00 rad/s"
DRIVES = "/cmd_vel: 0.05 m/s, 0.00 rad/s"


def test_a_stop_is_in_the_log_at_its_time() -> None:
    """It has no stamp, and after any velocity none was there: it counted as one more of the stream."""
    assert told(twist(100.0), STOP, twist(500.0), STOP, ARM_STOP) == [
        (100.0, DRIVES), (100.0, STANDS), (500.0, DRIVES), (500.0, STANDS), (500.0, "/arm/stop: sent"),
    ]  # fmt: skip
    assert told(STOP) == [(0.0, STANDS)]


def test_velocities_that_come_often_are_one_command_until_they_are_zero() -> None:
    stream = [twist(100.0 + 0.1 * number) for number in range(5)]
    zeros = [twist(100.5 + 0.1 * number, 0.0) for number in range(5)]
    assert told(*stream, *zeros, twist(101.0)) == [(100.0, DRIVES), (100.5, STANDS), (101.0, DRIVES)]


def test_a_stop_after_a_goal_is_told_though_another_came_shortly_before() -> None:
    goal: tuple[str, PoseStamped] = ("/goal_pose", drive_goal(round(100.5 * NANOSECONDS), (1.0, 0.0), None))
    assert [text for _, text in told(twist(100.0, 0.0), goal, STOP)][::2] == [STANDS, STANDS]


def test_velocities_of_a_run_that_was_started_anew_are_told() -> None:
    assert told(twist(500.0), twist(5.0)) == [(500.0, DRIVES), (5.0, DRIVES)]


def test_the_tip_over_angle_is_that_at_which_gravity_leaves_the_wheels() -> None:
    scenario = load_scenario("flat_drive", ["machine=skid", "steps=[]"])
    import pinocchio as pin

    model = pin.buildModelFromXML(scenario.urdf_xml, pin.JointModelFreeFlyer())
    data = model.createData()
    centre = pin.centerOfMass(model, data, pin.neutral(model))
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    wheels = np.array([data.oMi[model.getJointId(wheel.joint)].translation for wheel in scenario.machine.wheels])
    ground = wheels[:, 2].min() - scenario.machine.wheels[0].radius
    height = centre[2] - ground
    angles = [brentq(lambda tilt, reach=reach: height * np.tan(tilt) - reach, 0.0, 1.5) for reach in (
        wheels[:, 1].max() - centre[1], centre[1] - wheels[:, 1].min(),
        wheels[:, 0].max() - centre[0], centre[0] - wheels[:, 0].min())]  # fmt: skip
    assert tip_over_angle(scenario) == pytest.approx(min(angles), rel=1e-9)


@pytest.mark.parametrize("name", ["flat_drive", "tracked_course", "omni_course", "puma560_course", "mars_sol"])
def test_the_usual_limits_are_of_fields_that_the_run_has_in_order(name: str) -> None:
    scenario = load_scenario(name)
    limits = usual_limits(scenario)
    AlarmEngine(limits, STANDARD)
    assert ("tilt" in limits) == (scenario.driving is not None)
    charge = limits["charge"]
    assert charge.watch.below > charge.warning.below > charge.critical.below
    first = next(iter(scenario.power.all_stores.values()))
    assert limits["current"].critical.below < -first.discharge_current_limit * first.cells_parallel


@pytest.fixture(scope="module")
def bag() -> Bag:
    return read_bag(REFERENCE)


def test_a_bag_gives_the_same_log_each_time_and_no_critical_alarm(bag: Bag) -> None:
    _, state, log = watched_bag(bag)
    _, again, once_more = watched_bag(bag)
    assert log == once_more and state.alarms == again.alarms
    assert max(event.severity for event in log) < CRITICAL
    texts = [event.line() for event in log]
    assert any("drive: reached" in text for text in texts) and any("arm: refused" in text for text in texts)
    assert [event.stamp for event in log] == sorted(event.stamp for event in log)


def test_of_a_bag_that_is_cut_off_the_status_is_1_and_a_sentence_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (whole,) = REFERENCE.rglob("*.mcap")
    cut, data = tmp_path / "cut.mcap", whole.read_bytes()
    cut.write_bytes(data[: len(data) - 40])
    assert main(["--bag", str(whole)]) == 0
    said = capsys.readouterr()
    assert main(["--bag", str(cut)]) == 1
    told = capsys.readouterr()
    assert told.out == said.out and not said.err
    assert told.err.strip() == f"{cut} is cut off, so this holds as far as it goes (scripts/recover mends it)"


def test_limits_of_a_file_go_over_those_of_the_machine(bag: Bag, tmp_path: Path) -> None:
    file = tmp_path / "limits.yaml"
    file.write_text("alarms:\n  charge: null\n  fast: {field: /odom.twist.twist.linear.x, critical: {above: 0.01}}\n")
    watch, state, _ = watched_bag(bag, file)
    assert "charge" not in watch.engine.limits
    assert state.alarms.worst is CRITICAL
    assert main(["--bag", str(REFERENCE), "--limits", str(file)]) == 1
    (status, *_) = watch.message(state).status
    assert (status.name, status.level, dict(status.values)["limit"]) == ("fast", 2, "above 0.01")
    file.write_text("alarms: {fast: {field: /odom.twist.twist.linear.x, critical: {abov: 0.01}}}\n")
    with pytest.raises(ConfigError, match="above"):
        watched_bag(bag, file)


@pytest.mark.parametrize(
    ("field", "said"),
    [
        ("/odom.nonsense", "Odometry has no such field; the nearest: /odom.pose"),
        ("/nonsens.x", "/nonsens is no topic of the contract"),
        ("/battery_state.percentag", "the nearest: /battery_state.percentage"),
    ],
)
def test_limits_of_a_field_that_there_is_not_are_not_shown(field: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "limits.yaml"
    file.write_text(f"alarms: {{a: {{field: {field}, watch: {{above: 1.0}}}}}}\n")
    with pytest.raises(UsageError, match=said):
        main(["--show-limits", "--scenario", "flat_drive", "--limits", str(file)])


def test_limits_of_a_key_that_comes_only_when_needed_are_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "limits.yaml"
    file.write_text("alarms: {a: {field: /drive/status.asked_tilt_margin_deg, watch: {below: 1.0}}}\n")
    assert main(["--show-limits", "--scenario", "flat_drive", "--limits", str(file)]) == 0
    assert "asked_tilt_margin_deg" in capsys.readouterr().out


def test_a_machine_brings_alarms_of_its_own(tmp_path: Path) -> None:
    from sojourn_config.new_machine import main as new_machine

    assert new_machine(["mine", "--folder", str(tmp_path)]) == 0
    own = tmp_path / "mine" / "alarms.yaml"
    own.write_text("alarms:\n  sun: {field: /sun_direction.vector.z, watch: {below: 0.1}}\n", encoding="utf-8")
    scenario = load_scenario(str(tmp_path / "mine" / "flat.yaml"))
    limits = limits_of(scenario)
    assert {"sun", "tilt", "charge"} <= set(limits)
    assert any(name.endswith("alarms.yaml") for name in scenario.files)  # so that a bag carries it
    assert Watch(limits, STANDARD).topics
