"""Bench of one control period: where its time goes, by role and by layer, in microseconds and in the yardstick Y.

The roles run in one process without middleware, and each is timed by itself; what the period takes besides is the
stack's own. The codecs and the middleware are timed apart, with the messages of the same periods.
"""

import os
import statistics
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import rclpy
from rclpy.experimental import EventsExecutor

from sojourn_bags.recorded_run import RecordedRun
from sojourn_config.collector import settle_collector
from sojourn_config.ros_environment import ros_variables
from sojourn_config.scenario import load_scenario
from sojourn_contract import qos
from sojourn_contract.app import Answer, Period
from sojourn_contract.closed_node import ClosedNode
from sojourn_contract.codecs import decode, encode
from sojourn_contract.run_table import table_of
from sojourn_contract.topic_table import TopicTable
from sojourn_contract.topics import ROLES
from sojourn_contract.types import message_class
from sojourn_operator.scenario_steps import absent_roles
from sojourn_stack.apps import make_apps
from sojourn_stack.recorder import DirectRecorder
from sojourn_stack.stack import Said, Stack
from sojourn_studies.bench_step import Yardstick

WARM_PERIODS = 150
"""Periods before the first that counts: every kernel has been loaded by then."""


class Stopwatch:
    """Wall time of calls by name [s], since the last `lap`."""

    def __init__(self) -> None:
        self.spent: dict[str, float] = {}

    def timing(self, name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        """A call that is timed under a name."""

        def timed(*given: Any) -> Any:
            begin = time.perf_counter()
            try:
                return call(*given)
            finally:
                self.spent[name] = self.spent.get(name, 0.0) + time.perf_counter() - begin

        return timed

    def lap(self) -> dict[str, float]:
        """What has been spent, and begin anew."""
        spent, self.spent = self.spent, {}
        return spent


def bench_period(name: str, periods: int, domain: int) -> dict[str, float]:
    """Where a period of a scenario goes, the median of so many.

    Args:
        periods: that count. domain: ROS domain for the middleware.
    """
    scenario, watch, yardstick = load_scenario(name), Stopwatch(), Yardstick()
    table, roles = table_of(scenario), tuple(role for role in ROLES if role not in absent_roles(scenario))
    apps = make_apps(scenario, roles)
    for role, app in apps.items():
        app.warm_up()
        app.step = watch.timing(f"app of {role}", _eager(app.step))  # type: ignore[method-assign]
        app.check = watch.timing("checks", app.check)  # type: ignore[method-assign]
    stack = Stack(apps, roles, table)
    settle_collector()
    with tempfile.TemporaryDirectory(prefix="sojourn-bench-") as folder:
        recorder = DirectRecorder(Path(folder) / "bag", RecordedRun(name, (), roles, loaded=scenario))
        record = watch.timing("recorder, with encoding", recorder.take)
        state, said = stack.begin()
        laps, spoken, units = [], [], []
        for number in range(WARM_PERIODS + periods):
            watch.lap()
            begin = time.perf_counter()
            record(said)
            state, said = stack.step(state)
            whole = time.perf_counter() - begin
            if number >= WARM_PERIODS:
                laps.append({**watch.lap(), "period": whole})
                spoken.append(said)
            if number % 100 == 0:
                units.append(yardstick.microseconds())
        recorder.finish()
    unit = statistics.median(units)
    spent = {name: _median(laps, name) for name in sorted({name for lap in laps for name in lap}, key=_place)}
    spent["the stack's own"] = spent["period"] - sum(value for name, value in spent.items() if name != "period")
    spent |= _codecs(spoken, table, roles)
    spent["middleware, published and taken in one process"] = _middleware(spoken, domain)
    return {
        f"{name} [{sign}]": value / scale for name, value in spent.items() for sign, scale in (("us", 1.0), ("Y", unit))
    }


def _eager(step: Callable[[Any, Period], tuple[Any, Answer]]) -> Callable[[Any, Period], tuple[Any, Answer]]:
    """The same step, with its messages made at once: they count as the app's."""

    def made(state: Any, period: Period) -> tuple[Any, Answer]:
        memory, answer = step(state, period)
        return memory, Answer(list(answer.messages), answer.refusals, answer.errors, answer.finished)

    return made


def _median(laps: Sequence[Mapping[str, float]], name: str) -> float:
    """Of a name over all periods [us]; a role that acts in some of them only counts by its mean."""
    values = [lap.get(name, 0.0) for lap in laps]
    rare = sum(1 for value in values if value) < len(values)
    return (statistics.fmean(values) if rare else statistics.median(values)) * 1e6


def _place(name: str) -> tuple[int, str]:
    return (0 if name == "period" else 1, name)


def _codecs(spoken: Sequence[Sequence[Said]], table: TopicTable, roles: Sequence[str]) -> dict[str, float]:
    """Mean time of a period [us]: each message encoded once, and decoded once for each role that takes it."""
    takers = {row.name: 0 for said in spoken for row, _ in said}
    for role in roles:
        for row in table.inputs_of(role, roles) if role != "recorder" else ():
            if row.name in takers:
                takers[row.name] += 1
    begin = time.perf_counter()
    encoded = [(row, encode(row, message)) for said in spoken for row, message in said]
    middle = time.perf_counter()
    for row, data in encoded:
        for _ in range(takers[row.name]):
            decode(row, data)
    end = time.perf_counter()
    return {
        "encode, each message once": (middle - begin) / len(spoken) * 1e6,
        "decode, by each role that takes it": (end - middle) / len(spoken) * 1e6,
    }


def _middleware(spoken: Sequence[Sequence[Said]], domain: int) -> float:
    """Mean time of a period [us]: its messages published as bytes and taken as such by one listener each."""
    os.environ.update(ros_variables(domain, False))
    rclpy.init(args=[])
    node, taken = ClosedNode("bench_period"), [0]

    def take(_: bytes) -> None:
        taken[0] += 1

    try:
        executor = EventsExecutor()
        executor.add_node(node)
        rows = {row.name: row for said in spoken for row, _ in said if not row.is_event}
        senders = {
            name: node.create_publisher(message_class(row.type), name, qos.profile(row, True))
            for name, row in rows.items()
        }
        for name, row in rows.items():
            node.create_subscription(message_class(row.type), name, take, qos.profile(row, True), raw=True)
        periods = [
            [(senders[row.name], encode(row, message)) for row, message in said if row.name in rows] for said in spoken
        ]
        begin = time.perf_counter()
        sent = 0
        for period in periods:
            for sender, data in period:
                sender.publish(data)
            sent += len(period)
            while taken[0] < sent:
                executor.spin_once(timeout_sec=1.0)
        return (time.perf_counter() - begin) / len(spoken) * 1e6
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
