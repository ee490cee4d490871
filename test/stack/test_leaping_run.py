"""A run whose clock leaps: whole in its bag, kept to the contract, on time with its goals, and gone on with."""

from dataclasses import replace
from pathlib import Path

import pytest

from sojourn_bags.comparison import compare
from sojourn_bags.comparison_result import Verdict
from sojourn_bags.errors import ReplayError
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import read_bag
from sojourn_bags.recorded_run import RecordedRun
from sojourn_bags.replay_choices import ROLES_TO_REPLAY
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_contract.decoding import stamp_of
from sojourn_contract.leaps import BEGIN, landing_grid
from sojourn_contract.run_table import table_of
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topic_types import Topic
from sojourn_operator.scenario_steps import prepare_scenario
from sojourn_stack.apps import APPS
from sojourn_stack.checkpoint import load, save
from sojourn_stack.replay import replay
from sojourn_stack.run import Result, RunSpec, run
from sojourn_stack.stack import StackState

SCENARIO = str(Path(__file__).with_name("leaping.yaml"))
ROLES = ("plant", "sensors", "drive", "arm", "power", "operator", "recorder")
GRID = landing_grid(table_of(load_scenario(SCENARIO)))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Result, Path, list[StackState]]:
    """The run, its bag, and its states at every leap."""
    bag, states = tmp_path_factory.mktemp("leaping") / "bag", []

    def goes_on(state: StackState) -> bool:
        if not states or state.leaps != states[-1].leaps:
            states.append(state)
        return True

    return run(RunSpec(SCENARIO, ROLES, bag=bag), goes_on), bag, states


def test_it_leaps_while_it_waits_and_steps_while_it_drives(whole: tuple[Result, Path, list[StackState]]) -> None:
    result, _, _ = whole
    gaps = result.state.leaps.gaps
    assert len(gaps) >= 3
    for begin, end in gaps:
        assert begin % BEGIN == 0 and end % GRID == 0 and end - begin <= 120 * NANOSECONDS // CONTROL_PERIOD_NS
    assert gaps[-1][1] * CONTROL_PERIOD_NS <= 300 * NANOSECONDS
    assert [step.outcome for step in result.steps] == ["waited", "reached"]
    assert result.steps[0].end_s == pytest.approx(300.1)
    assert all(not one.refused for one in result.state.roles.values())


def test_its_bag_is_whole_and_keeps_the_contract(whole: tuple[Result, Path, list[StackState]]) -> None:
    result, folder, _ = whole
    assert result.completeness is not None and not result.completeness.gaps
    bag = read_bag(folder)
    report, _ = judge_bag(bag)
    assert report.violations == 0, "\n".join(report.lines())
    due = result.completeness.counts["/truth/odom"].due
    assert due == len(bag.topics["/truth/odom"]) < 0.2 * result.state.period


def test_a_gap_that_is_not_the_clocks_is_found(whole: tuple[Result, Path, list[StackState]]) -> None:
    """One message less where the clock has landed."""
    result, folder, _ = whole
    bag = read_bag(folder)
    odometry = bag.topics["/odom"]
    landing = result.state.leaps.gaps[0][1] * CONTROL_PERIOD_NS
    place = list(odometry.log_times).index(landing)
    without = replace_without(odometry, place)
    report, _ = judge_bag(replace(bag, topics={**bag.topics, "/odom": without}))
    assert report.violations > 0


def test_its_recorder_waits_for_what_is_lost(whole: tuple[Result, Path, list[StackState]], tmp_path: Path) -> None:
    """What the plant says in the second period after the last landing comes late. It was taken for another leap, and
    filed under a later period.
    """
    result, folder, _ = whole
    bag, table, late = read_bag(folder), table_of(load_scenario(SCENARIO)), list[tuple[Topic, bytes]]()
    lost = (result.state.leaps.gaps[-1][1] + 2) * CONTROL_PERIOD_NS
    messages = (each for name, each in bag.topics.items() if name != "/tf")
    said = sorted(
        (place, at, each.topic, data)
        for each in messages
        for place, at, data in zip(each.places, each.log_times, each.data, strict=True)
    )
    recording = RecordedRun(SCENARIO, (), ROLES).open(tmp_path / "late", lambda name, reason: pytest.fail(reason))

    def take(row: Topic, data: bytes) -> None:
        recording.take(row, stamp_of(row.name, data), data)
        while recording.collect():
            pass
        while recording.write_period():
            pass

    for _, at, name, data in said:
        row = table.topic(name)
        if at == lost and row.publisher == "plant":
            late.append((row, data))
            continue
        take(row, data)
        if at >= lost + 8 * CONTROL_PERIOD_NS:
            while late:
                take(*late.pop(0))
    recording.finish({})
    found = read_bag(tmp_path / "late")
    assert compare(bag.topics, found.topics).verdict is Verdict.IDENTICAL
    assert all(found[name].log_times == messages.log_times for name, messages in bag.topics.items())


def replace_without(messages, place):  # type: ignore[no-untyped-def]
    """Messages of a topic without one of them."""
    fields = {name: list(getattr(messages, name)) for name in ("log_times", "data", "places")}
    for values in fields.values():
        del values[place]
    return replace(messages, **fields)


@pytest.mark.parametrize("role", ROLES_TO_REPLAY)
def test_its_bag_is_replayed_through_each_role(role: str, whole: tuple[Result, Path, list[StackState]]) -> None:
    """Played are the periods that the run had, and the answers are those of the run."""
    result, folder, _ = whole
    replayed = replay(read_bag(folder), role, APPS[role].of(load_scenario(SCENARIO)))
    assert replayed.comparison.verdict is Verdict.IDENTICAL
    assert len(replayed.script.steps) < 0.2 * result.state.period
    assert replayed.comparison.matched == sum(len(messages) for messages in replayed.script.recorded.values()) > 100


def test_a_bag_that_does_not_tell_where_its_clock_leapt_is_not_replayed(
    whole: tuple[Result, Path, list[StackState]],
) -> None:
    bag = read_bag(whole[1])
    without = replace(bag, topics={name: each for name, each in bag.topics.items() if name != "/clock"})
    with pytest.raises(ReplayError, match="lacks /clock, which tells where the clock of this run leapt"):
        replay(without, "power", APPS["power"].of(load_scenario(SCENARIO)))


@pytest.mark.parametrize("number", [2])
def test_it_is_gone_on_with_from_a_leap(
    whole: tuple[Result, Path, list[StackState]], number: int, tmp_path: Path
) -> None:
    result, _, states = whole
    save(states[number], tmp_path / "kept")
    rest = run(RunSpec(SCENARIO, ROLES, bag=tmp_path / "rest", begin=load(tmp_path / "kept")))
    assert rest.state.leaps == result.state.leaps
    assert rest.completeness is not None and not rest.completeness.gaps
    unbroken, bag = read_bag(whole[1]), read_bag(tmp_path / "rest")
    for name, messages in bag.topics.items():
        earlier = unbroken.topics[name]
        known = {(at, str(earlier.decode(index))) for index, at in enumerate(earlier.log_times)}
        told = {(at, str(messages.decode(index))) for index, at in enumerate(messages.log_times)}
        assert told <= known, name


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("leaps.longest_s=30", r"leaps: longest_s = 30: allowed is 60 or more, after which every topic"),
        ("leaps.longest_s=-1", r"leaps\.longest_s = -1"),
        ("leaps.longest=60", r"leaps\.longest = 60: unknown key.*longest_s"),
        ("sensors.imu.timing={rate: 25.0}", r"/imu/data.*heard later than it is measured"),
    ],
)
def test_what_lets_no_clock_leap_is_said_before_the_run(override: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        prepare_scenario(SCENARIO, [override])


def test_a_run_leaps_where_its_scenario_asks_for_it_alone() -> None:
    assert table_of(load_scenario(SCENARIO)).longest_leap == 2 * GRID
    ends = iter(range(450))
    spec = RunSpec(SCENARIO, ROLES[:-1], ("leaps=null",))
    state = run(spec, lambda state: next(ends, None) is not None).state
    assert state.period > 400 and not state.leaps.gaps and not state.roles["plant"].app.leaps.rest.periods
