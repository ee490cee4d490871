"""A sensor whose clock has stopped: its messages come, nobody acts on them, and the judge says so; one record in each
layout.
"""

from collections.abc import Iterator

import numpy as np
import pytest
from programs import PATIENT, SHORT_RUN, Program
from verdicts import require_same

from domains import domain_to_keep
from sojourn_bags.comparison import stamps_of
from sojourn_bags.judging import judge_bag
from sojourn_bags.reading import Bag, read_bag

STOPS_S = 1.0
OPTIONS = [
    *("--set", "steps=[{drive_to: {x: 1.0, y: 0.0}}]"),
    *("--set", f"sensors.imu.faults={{clock: {{frozen_stamp: true, after: {STOPS_S}}}}}"),
]
LAYOUTS = {"direct": ("--direct",), "composed": ("--composed",)}


@pytest.fixture(scope="module")
def bags(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Bag]]:
    base = tmp_path_factory.mktemp("frozen")
    programs: list[Program] = []
    try:
        for name, options in LAYOUTS.items():
            given = [str(SHORT_RUN), *PATIENT, "--domain", str(domain_to_keep()), *OPTIONS, *options]
            programs.append(Program("start", [*given, "--run-dir", str(base / name)], base / f"{name}.log"))
        for program in programs:
            assert program.wait() == 1, program.text  # the goal fails, as with a dead sensor
        yield {name: read_bag(base / name) for name in LAYOUTS}
    finally:
        for program in programs:
            program.end()


def test_the_record_is_the_same_in_both_layouts(bags: dict[str, Bag]) -> None:
    require_same(bags["direct"], bags["composed"])


def test_values_go_on_while_the_stamp_stays(bags: dict[str, Bag]) -> None:
    imu = bags["direct"]["/imu/data"]
    filed, stamps = np.array(imu.log_times), np.array(stamps_of(imu))
    assert len(imu) == len(bags["direct"]["/clock"])
    late = filed >= round(STOPS_S * 1e9)
    assert np.array_equal(stamps[~late], filed[~late])
    assert set(stamps[late]) == {round(STOPS_S * 1e9) - 20_000_000}
    assert len(np.unique(imu.column("linear_acceleration.z")[late])) > 2


def test_the_drive_acts_on_none_of_them_and_says_so(bags: dict[str, Bag]) -> None:
    last = bags["direct"]["/drive/status"].statuses()[-1]
    assert "no usable /imu/data for" in str(last)


def test_the_judge_finds_the_stamps_and_that_nothing_else_is_missing(bags: dict[str, Bag]) -> None:
    """Of the odometry it may find that a machine which is stopped without a gyro jumps, as with one that is dead."""
    report, _ = judge_bag(bags["direct"])
    found = {(group.topic, group.rule) for group in report.groups}
    assert ("/imu/data", "stamp") in found
    assert not {rule for _, rule in found} & {"answer", "counter", "heartbeat", "rate"}
