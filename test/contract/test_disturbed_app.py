"""Messages between nodes that are lost, late, repeated or corrupted: what an app hears is what arrives."""

from dataclasses import dataclass
from dataclasses import replace as changed
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_contract.app import Answer, App, Period
from sojourn_contract.disturbances import check_disturbances
from sojourn_contract.disturbed_app import DisturbedState, disturbed
from sojourn_contract.errors import DisturbanceError
from sojourn_contract.kept_data import Kept
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topics import STANDARD
from sojourn_contract.values import Imu, PoseStamped
from sojourn_machine.disturbance import FOR_EVER, Disturbance

IMU, GOAL = "/imu/data", "/goal_pose"
SECOND = NANOSECONDS // CONTROL_PERIOD_NS
MAX_AGE = STANDARD.topic(IMU).max_age_s


@dataclass(frozen=True)
class Heard:
    """What the app below has been given: (stamp, imu) and (stamp, goal)."""

    readings: tuple[tuple[int, Any], ...] = ()
    goals: tuple[tuple[int, Any], ...] = ()
    from_kept: Any = None


class Listener(App[Heard]):
    """Of the drive's role; it keeps how much it has heard."""

    role = "drive"

    def __init__(self) -> None:
        pass

    def initial_state(self) -> Heard:
        return Heard()

    def step(self, state: Heard, period: Period) -> tuple[Heard, Answer]:
        readings = state.readings
        if IMU in period.inputs:
            readings = (*readings, (period.stamp, period.inputs[IMU]))
        goals = (*state.goals, *((period.stamp, goal) for _, goal in period.goals))
        return changed(state, readings=readings, goals=goals), Answer()

    def to_keep(self, state: Heard) -> dict[str, int]:
        return {"heard": len(state.readings)}

    def started_again(self, state: Heard, stamp: int, kept: Kept | None) -> Heard:
        return changed(state, from_kept=(stamp, kept))


def imu(stamp: int) -> Imu:
    number = stamp / NANOSECONDS
    return Imu(stamp, "base_link", np.array([0.0, 0.0, 0.0, 1.0]), np.full(3, 1e-3 * number), np.array([0.0, 0.0, 1.6]))


def goal(stamp: int) -> PoseStamped:
    return PoseStamped(stamp, "map", np.array([stamp / NANOSECONDS, 0.0, 0.0]))


def heard(
    disturbances: list[Disturbance], periods: int = 100, goals_at: tuple[int, ...] = ()
) -> tuple[DisturbedState[Heard], dict[int, list[str]]]:
    """The state after so many periods, and refusals by stamp."""
    app = disturbed(Listener(), STANDARD, disturbances)
    state, refused = app.initial_state(), dict[int, list[str]]()
    for period in range(1, periods + 1):
        stamp = period * CONTROL_PERIOD_NS
        goals = [(GOAL, goal(stamp))] if period in goals_at else []
        state, answer = app.step(state, Period(stamp, {IMU: imu(stamp)}, goals))
        refused[stamp] = [reason for _, reason in answer.refusals]
    return state, refused


def meeting(effect: Any, topic: str = IMU, begin: int = 0, end: int = FOR_EVER, **words: Any) -> Disturbance:
    return Disturbance(effect, topic, "", begin, end, **words)


def test_an_app_that_nothing_concerns_is_itself() -> None:
    app = Listener()
    assert disturbed(app, STANDARD, []) is app
    assert disturbed(app, STANDARD, [meeting("lost", "/arm_command")]) is app
    assert disturbed(app, STANDARD, [Disturbance("restarted", "", "arm", 0)]) is app


@settings(max_examples=60)
@given(
    begin=st.integers(0, 60),
    length=st.integers(1, 60),
    probability=st.floats(0.05, 1.0),
    delay=st.integers(1, 40),
    effect=st.sampled_from(("lost", "late", "both")),
    stream=st.integers(0, 2**63),
)
def test_what_is_heard_is_the_newest_that_has_arrived_and_is_young(
    begin: int, length: int, probability: float, delay: int, effect: str, stream: int
) -> None:
    first, last = begin * CONTROL_PERIOD_NS, (begin + length) * CONTROL_PERIOD_NS
    late = meeting(
        "late", begin=first, end=last, probability=probability, delay=delay * CONTROL_PERIOD_NS, stream=stream
    )
    lost = meeting("lost", begin=first, end=last, probability=probability, stream=stream + 1)
    chosen = {"lost": [lost], "late": [late], "both": [lost, late]}[effect]
    readings = dict(heard(chosen)[0].app.readings)
    arrived = list[tuple[int, int]]()
    for period in range(1, 101):  # in plain words: when does each arrive, if it does
        sent = period * CONTROL_PERIOD_NS
        if lost in chosen and lost.meets(sent):
            continue
        at = sent + late.delay if late in chosen and late.meets(sent) else sent
        arrived.append((max([at, *(before for before, _ in arrived)]), sent))
    for stamp, reading in readings.items():
        there = [sent for at, sent in arrived if at <= stamp]
        newest = there[-1] if there else None
        if newest is not None and stamp - newest > MAX_AGE * NANOSECONDS:
            newest = None
        assert (None if reading is None else reading.stamp) == newest


@settings(max_examples=40)
@given(
    goals_at=st.lists(st.integers(1, 90), unique=True, max_size=6).map(tuple),
    probability=st.floats(0.1, 1.0),
    delay=st.integers(1, 60),
    stream=st.integers(0, 2**63),
)
def test_every_goal_is_given_lost_or_on_its_way(
    goals_at: tuple[int, ...], probability: float, delay: int, stream: int
) -> None:
    lost = meeting("lost", GOAL, probability=probability, stream=stream)
    late = meeting("late", GOAL, delay=delay * CONTROL_PERIOD_NS)
    twice = meeting("twice", GOAL, begin=SECOND * CONTROL_PERIOD_NS)
    state, _ = heard([lost, late, twice], goals_at=goals_at)
    given_at = [(stamp, each.stamp) for stamp, each in state.app.goals]
    waiting = [each.stamp for _, each in state.ways[GOAL].coming]
    for period in goals_at:
        stamp = period * CONTROL_PERIOD_NS
        times = 0 if lost.meets(stamp) else 2 if twice.meets(stamp) else 1
        assert sum(sent == stamp for _, sent in given_at) + waiting.count(stamp) == times
    assert all(at == sent + late.delay for at, sent in given_at)


@settings(max_examples=60)
@given(stream=st.integers(0, 2**63))
def test_a_corrupted_reading_is_another_one_or_is_refused(stream: int) -> None:
    begin = SECOND * CONTROL_PERIOD_NS
    state, refused = heard([meeting("corrupted", begin=begin, stream=stream)], 80)
    found = {stamp: _bits(imu(stamp), reading) for stamp, reading in state.app.readings}
    for stamp, bits in found.items():
        if bits is None:
            assert len(refused[stamp]) == 1 and IMU in refused[stamp][0]
        else:
            assert not refused[stamp] and (bits == 0 or stamp >= begin)
    met = [bits for stamp, bits in found.items() if stamp >= begin]
    assert set(met) <= {1, None}


@given(by=st.integers(-100, 100).filter(bool), begin=st.integers(1, 60))
def test_a_clock_that_is_off_is_refused_or_makes_readings_older(by: int, begin: int) -> None:
    shift = by * CONTROL_PERIOD_NS
    state, refused = heard([meeting("shifted", begin=begin * CONTROL_PERIOD_NS, shift=shift)], 80)
    may_be = -MAX_AGE * NANOSECONDS <= shift <= 0
    for stamp, reading in state.app.readings:
        if stamp < begin * CONTROL_PERIOD_NS:
            assert reading.stamp == stamp and not refused[stamp]
        elif may_be:
            assert reading.stamp == stamp + shift and not refused[stamp]
        else:
            (told,) = refused[stamp]
            assert told.startswith(f"{IMU}.header.stamp = {(stamp + shift) / NANOSECONDS:.3f} s: allowed is ")
            assert told.endswith("at most" if by > 0 else "or later")
            assert reading is None


def _bits(sent: Imu, heard: Imu | None) -> int | None:
    """How many bits of its numbers are others, and whether its frame is; None for one that was refused."""
    if heard is None:
        return None
    arrays = [(one, other) for one, other in zip(heard, sent, strict=True) if isinstance(one, np.ndarray)]
    assert all(np.isfinite(one).all() for one, _ in arrays)
    words = [word for one, other in arrays for word in (one.view(np.uint64) ^ other.view(np.uint64)).tolist()]
    return sum(int(word).bit_count() for word in words) + (heard.frame != sent.frame)


def test_readings_that_come_twice_are_refused_once_each() -> None:
    state, refused = heard([meeting("twice")], 20)
    assert [reading.stamp for _, reading in state.app.readings] == [stamp for stamp, _ in state.app.readings]
    assert all(len(words) == 1 and "each message once" in words[0] for words in refused.values())


def test_a_node_that_is_silent_or_slow_is_so_to_all_that_hear_it() -> None:
    state, _ = heard([Disturbance("lost", "", "sensors", SECOND * CONTROL_PERIOD_NS)], 100)
    assert state.app.readings[-1][1] is None and state.app.readings[SECOND - 2][1] is not None
    state, _ = heard([Disturbance("late", "", "sensors", 0, delay=2 * CONTROL_PERIOD_NS)], 100)
    assert all(each is None or at - each.stamp == 2 * CONTROL_PERIOD_NS for at, each in state.app.readings)


def test_a_node_that_is_restarted_knows_what_it_kept_and_no_more() -> None:
    at = 70 * CONTROL_PERIOD_NS
    state, _ = heard([Disturbance("restarted", "", "drive", at)], 100)
    stamp, kept = state.app.from_kept
    assert stamp == at and at - kept.stamp <= NANOSECONDS // 5
    assert kept.values == {"heard": kept.stamp // CONTROL_PERIOD_NS}
    assert state.app.readings[0][0] == at and state.restarts == 1


def test_a_node_that_is_killed_is_deaf_and_begins_anew_with_what_it_kept_before() -> None:
    begin, end = 60 * CONTROL_PERIOD_NS, 80 * CONTROL_PERIOD_NS
    killed = Disturbance("killed", "", "drive", begin, end)
    dead, _ = heard([killed], 79, goals_at=(59, 60, 79))
    assert [at for at, _ in dead.app.goals] == [59 * CONTROL_PERIOD_NS] and dead.restarts == 0
    back, _ = heard([killed], 100, goals_at=(59, 60, 79, 80))
    stamp, kept = back.app.from_kept
    assert stamp == end and kept.stamp < begin and begin - kept.stamp <= NANOSECONDS // 5
    assert kept.values == {"heard": kept.stamp // CONTROL_PERIOD_NS}
    assert back.app.readings[0][0] == end and [at for at, _ in back.app.goals] == [end]


def test_a_node_that_is_killed_for_good_does_not_begin_anew() -> None:
    begin = 60 * CONTROL_PERIOD_NS
    state, _ = heard([Disturbance("killed", "", "drive", begin)], 100, goals_at=(59, 60, 99))
    assert state.app.from_kept is None and state.restarts == 0 and len(state.app.goals) == 1


@given(begin=st.integers(0, 90), end=st.integers(0, 90))
def test_a_node_that_is_never_killed_does_not_begin_anew(begin: int, end: int) -> None:
    """It was restarted at the end of a fault that never came, and its goal was lost."""
    killed = Disturbance("killed", "", "drive", begin * CONTROL_PERIOD_NS, end * CONTROL_PERIOD_NS)
    assert killed.begins_anew == (killed.end if begin < end else None)
    state, _ = heard([killed], 100)
    assert state.restarts == (begin < end)
    if begin >= end:
        assert state.app.from_kept is None and len(state.app.readings) == 100


def test_nothing_is_heard_of_a_node_while_it_is_dead() -> None:
    begin, end = 40 * CONTROL_PERIOD_NS, 80 * CONTROL_PERIOD_NS
    state, _ = heard([Disturbance("killed", "", "sensors", begin, end)], 100)
    newest = {at: None if reading is None else reading.stamp for at, reading in state.app.readings}
    for at, stamp in newest.items():
        last = begin - CONTROL_PERIOD_NS if begin <= at < end else at
        assert stamp == (last if at - last <= MAX_AGE * NANOSECONDS else None)


@pytest.mark.parametrize(
    ("disturbance", "words"),
    [
        (meeting("lost", "/imu"), r"topic /imu is none.*did you mean /imu/data"),
        (meeting("lost", "/truth/odom"), r"topic /truth/odom is none"),
        (meeting("lost", "/operator/tick"), r"topic /operator/tick is none"),
        (Disturbance("lost", "", "nobody", 0), r"node nobody says nothing"),
    ],
)
def test_a_disturbance_of_what_is_not_there_is_refused(disturbance: Disturbance, words: str) -> None:
    with pytest.raises(DisturbanceError, match=words):
        check_disturbances([disturbance], STANDARD)
