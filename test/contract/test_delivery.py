"""Messages that come later than their stamps: in order, within what was asked for, and the same for whoever asks."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_flight, load_scenario
from sojourn_contract.barrier import Barrier, is_due, oldest_age, stamp_due
from sojourn_contract.delivery import Delivery, Loss
from sojourn_contract.description import contract_data, delivered_by_data
from sojourn_contract.run_table import delivered, table_of
from sojourn_contract.stamps import CONTROL_PERIOD_NS
from sojourn_contract.topics import STANDARD, topic
from sojourn_machine.chance import mixed
from sojourn_machine.errors import MachineError
from sojourn_machine.sensor_timing import SensorTimingParams

PERIODS = 120
MILLISECOND = 1_000_000


@st.composite
def deliveries(draw: st.DrawFn) -> Delivery:
    every = draw(st.sampled_from([1, 2, 5, 10, 25]))
    return Delivery(
        every=every,
        phase=draw(st.integers(0, every - 1)),
        latency=draw(st.integers(0, 300)) * MILLISECOND,
        jitter=draw(st.integers(0, 200)) * MILLISECOND,
        losses=tuple(
            Loss(draw(st.integers(0, 60)) * CONTROL_PERIOD_NS, draw(st.floats(0.0, 1.0)))
            for _ in range(draw(st.integers(0, 2)))
        ),
        stream=draw(st.integers(0, 2**64 - 1)),
    )


def test_the_generator_is_the_published_one() -> None:
    """First outputs of SplitMix64 from the seed 1234567, by its authors' program."""
    state, first = 1234567, []
    for _ in range(3):
        first.append(mixed(state))
        state = (state + 0x9E3779B97F4A7C15) % 2**64
    assert first == [6457827717110365317, 3203168211198807973, 9817491932198370423]


@given(deliveries())
def test_each_leaves_in_time_and_none_overtakes(delivery: Delivery) -> None:
    last = 0
    for measured in delivery.samples(0, PERIODS):
        leaves = delivery.leaves(measured)
        assert (leaves == 0) == delivery.is_lost(measured)
        if not leaves:
            continue
        late = (leaves - measured) * CONTROL_PERIOD_NS
        assert delivery.latency <= late < delivery.latency + delivery.jitter + CONTROL_PERIOD_NS
        # as early as its own delay allows, or with the one before it
        assert leaves == max(delivery.departure(measured), last)
        last = leaves


@given(deliveries())
def test_every_message_leaves_in_one_period(delivery: Delivery) -> None:
    told = [(period, each) for period in range(1, PERIODS) for each in delivery.left_at(period)]
    assert [each for _, each in told] == list(delivery.departures(PERIODS - 1))
    assert all(delivery.leaves(each) == period for period, each in told)
    measured = [period for period in range(1, PERIODS) if delivery.measures(period)]
    assert list(delivery.samples(0, PERIODS - 1)) == measured


@given(deliveries(), st.integers(0, 40))
def test_the_newest_is_the_last_that_has_left(delivery: Delivery, age: int) -> None:
    left: list[int] = []
    for period in range(1, PERIODS):
        left += delivery.left_at(period)
        young = [each for each in left if period - each <= age]
        assert delivery.newest(period, age) == max(young, default=0)


@pytest.mark.parametrize("probability", [0.01, 0.3, 0.9])
def test_as_many_are_lost_as_was_asked_for(probability: float) -> None:
    delivery, count = Delivery(1, losses=(Loss(0, probability),), stream=7), 20_000
    lost = sum(delivery.is_lost(period) for period in range(1, count + 1))
    assert abs(lost - count * probability) < 5.0 * (count * probability * (1.0 - probability)) ** 0.5


@given(deliveries(), st.integers(0, 60))
def test_a_further_loss_changes_nothing_before_it_begins(delivery: Delivery, begin: int) -> None:
    more = replace(delivery, losses=(*delivery.losses, Loss(begin * CONTROL_PERIOD_NS, 1.0)))
    for period in delivery.samples(0, begin - 1):
        assert more.leaves(period) == delivery.leaves(period)
    assert not any(more.leaves(period) for period in delivery.samples(max(begin - 1, 0), PERIODS))


TIMED = delivered(topic("/imu/data"), "imu", SensorTimingParams(latency=0.06, jitter=0.05, dropped=0.2))


@settings(max_examples=25, deadline=None)
@given(st.data())
def test_a_barrier_gives_the_newest_in_whatever_order_topics_come(data: st.DataObject) -> None:
    """In each period of the clock; on one topic messages come in order."""
    clock, row = topic("/clock"), TIMED
    barrier: Barrier[str] = Barrier((clock, row))
    assert row.delivery is not None
    waiting = {
        clock: [period * CONTROL_PERIOD_NS for period in range(1, PERIODS)],
        row: [period * CONTROL_PERIOD_NS for period in row.delivery.departures(PERIODS)],
    }
    taken = []
    while any(waiting.values()):
        chosen = data.draw(st.sampled_from([each for each, left in waiting.items() if left]))
        stamp = waiting[chosen].pop(0)
        assert barrier.refusal(chosen, stamp) is None
        barrier.offer(chosen, stamp, f"{chosen.name}@{stamp}")
        assert barrier.refusal(chosen, stamp) is not None
        while barrier.is_complete() and barrier.period < PERIODS:
            assert not barrier.missing()
            taken.append((barrier.period, barrier.take().get(row.name)))
    assert [period for period, _ in taken] == list(range(1, PERIODS))
    for period, message in taken:
        stamp = row.delivery.newest(period, oldest_age(row)) * CONTROL_PERIOD_NS
        assert message == (f"{row.name}@{stamp}" if stamp else None)
        assert (stamp > 0) == is_due(row, period) and stamp == stamp_due(row, period)


def test_a_lost_message_is_refused() -> None:
    delivery = TIMED.delivery
    assert delivery is not None
    lost = next(period for period in range(1, PERIODS) if delivery.is_lost(period))
    barrier: Barrier[str] = Barrier((TIMED,))
    assert "lost" in (barrier.refusal(TIMED, lost * CONTROL_PERIOD_NS) or "")
    assert "lost" in (barrier.refusal(TIMED, CONTROL_PERIOD_NS + 1) or "")


def test_the_table_follows_and_both_sides_have_the_same() -> None:
    told = ["sensors.hazcam.timing={rate: 5.0, phase: 0.04, latency: 0.1}", "sensors.joint_timing={dropped: 0.1}"]
    table = table_of(load_scenario("flat_drive", told))
    assert table.rows == table_of(load_flight("flat_drive", told)).rows
    row = table.topic("/hazcam/points")
    assert (row.every, row.pace) == (10, 10) and row.max_age_s == pytest.approx(3.0 / 5.0 + 0.1)
    changed = {row.name for row in table if row != STANDARD.get(row.name)}
    assert changed == {"/hazcam/points", "/joint_states", "/clock"}
    assert set(table.topic("/clock").subscribers) == {"drive", "arm"}
    data = contract_data(table)["topics"]
    assert all(delivered_by_data(topic(name), data[name]).delivery == table.topic(name).delivery for name in data)


@pytest.mark.parametrize("key", ["imu.timing={latency: 0.1}", "imu.faults={a: {dead: true}}"])
def test_both_sides_wait_for_the_same_or_the_run_is_refused(key: str) -> None:
    with pytest.raises(ConfigError, match="not as it is believed"):
        load_scenario("flat_drive", [f"belief.sensors.{key}"])
    believed = load_scenario("flat_drive", [f"sensors.{key}", "belief.battery.capacity_ah=20"])
    assert believed.belief is not None


def test_a_slow_bus_does_not_slow_the_power_manager() -> None:
    table = table_of(load_scenario("flat_drive", ["sensors.bus.timing={rate: 1.0, latency: 0.3}"]))
    row = table.topic("/bus/state")
    assert (row.every, row.pace) == (50, 5)
    assert Barrier((table.topic("/clock"), row)).stride == 5


@pytest.mark.parametrize(
    ("timing", "words"),
    [
        (
            "{rate: 7.0}",
            r"rate 7: allowed is a divisor of .* 50 Hz, the nearest are 6\.25 and 7\.14286",
        ),
        ("{rate: 0.0}", "rate"),
        ("{rate: 60.0}", "rate"),
        ("{rate: fast}", "rate"),
        ("{phase: 0.03}", r"phase 0\.03: allowed is a multiple of 0\.02 s"),
        ("{rate: 5.0, phase: 0.2}", r"phase 0\.2: allowed is 0\.18 s at most"),
        ("{latency: -1.0}", "latency"),
        ("{jitter: 3.0}", "jitter"),
        ("{dropped: 1.0}", "dropped"),
        ("{lateness: 1.0}", "lateness"),
        ("soon", "timing"),
    ],
)
def test_a_timing_that_cannot_be_is_refused_in_words(timing: str, words: str) -> None:
    for sensor in ("hazcam.timing", "joint_timing"):
        if sensor == "joint_timing" and "rate: 5.0" in timing:
            continue
        with pytest.raises((ConfigError, MachineError), match=words):
            load_scenario("flat_drive", [f"sensors.{sensor}={timing}"])


@given(deliveries(), st.integers(0, 60))
def test_a_clock_that_stops_takes_no_message_away_and_no_stamp_goes_on(delivery: Delivery, stops: int) -> None:
    begin = stops * CONTROL_PERIOD_NS
    stopped = replace(delivery, losses=(*delivery.losses, Loss(begin, 1.0, frozen=True)))
    measured = delivery.samples(0, PERIODS)
    assert [stopped.comes(each) for each in measured] == [delivery.leaves(each) for each in measured]
    told = [each for each in measured if stopped.comes(each)]
    before = [each for each in told if each * CONTROL_PERIOD_NS < begin]
    good = before or told[:1]
    if not good:  # nothing is heard of it
        return
    assert stopped.stands_at == good[-1]
    assert [stopped.stamped(each) for each in told] == good + (len(told) - len(good)) * good[-1:]
    assert [each for each in measured if stopped.leaves(each)] == good
    row = replace(topic("/imu/data"), delivery=stopped)
    stamps = [stopped.stamped(each) * CONTROL_PERIOD_NS for each in told]
    assert list(row.all_heard_at(stamps)) == [stopped.comes(each) * CONTROL_PERIOD_NS for each in told]


def test_a_barrier_waits_for_no_message_of_a_clock_that_has_stopped_and_takes_none() -> None:
    faults = [Loss(10 * CONTROL_PERIOD_NS, 1.0, frozen=True)]
    row = delivered(topic("/imu/data"), "imu", SensorTimingParams(), faults)
    barrier: Barrier[str] = Barrier((topic("/clock"), row))
    heard = []
    for period in range(1, 40):
        barrier.offer(topic("/clock"), period * CONTROL_PERIOD_NS, "")
        stamp = min(period, 9) * CONTROL_PERIOD_NS
        if not barrier.repeats(row, stamp):
            assert barrier.refusal(row, stamp) is None
            barrier.offer(row, stamp, f"of {period}")
        assert barrier.is_complete()
        heard.append(barrier.take().get(row.name))
    assert heard[:9] == [f"of {period}" for period in range(1, 10)]
    last = 9 + oldest_age(row)  # it counts until it is too old
    assert set(heard[9:last]) == {"of 9"} and set(heard[last:]) == {None}
