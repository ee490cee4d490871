"""A run whose images are made while it goes on: the same bag and the same checkpoint as if it had waited for each."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader

from sojourn_bags.completeness import RECORD
from sojourn_config.scenario import load_scenario
from sojourn_contract.codecs import encode
from sojourn_contract.topics import ROLES
from sojourn_contract.unfinished import finish_all
from sojourn_operator.scenario_steps import absent_roles
from sojourn_sensors.kinds import camera
from sojourn_stack import checkpoint
from sojourn_stack.recorder import DirectRecorder
from sojourn_stack.run import RunSpec, begun
from sojourn_stack.stack import Stack, StackState

OVERRIDES = (
    "machine=explorer_cameras",
    "drive.visual_odometry=null",
    *(f"sensors.{name}.timing.rate=0.1" for name in ("front", "rear", "belly")),  # none of these in the first 10 s
    "sensors.navcam.lens={columns: 48, rows: 32, horizontal_view_deg: 45.4}",
)
PERIODS = 120
"""In which two pairs are taken."""


def run(bag: Path) -> tuple[Stack, StackState, DirectRecorder]:
    scenario = load_scenario("flat_drive", OVERRIDES)
    roles = tuple(role for role in ROLES if role not in absent_roles(scenario))
    stack, state, said, recorder = begun(RunSpec("flat_drive", roles, OVERRIDES, bag, scenario))
    assert recorder is not None
    recorder.take(said)
    return stack, state, recorder


def messages(bag: Path) -> list[tuple[str, int, int, bytes]]:
    (file,) = bag.glob("*.mcap")
    with file.open("rb") as stream:
        return [
            (channel.topic, message.log_time, message.publish_time, message.data)
            for _, channel, message in make_reader(stream).iter_messages(log_time_order=False)
        ]


def slowly(monkeypatch: pytest.MonkeyPatch, may_end: threading.Event) -> None:
    begin = camera.begun

    def begun_slowly(make: Callable[[], Any]) -> Any:
        def made() -> Any:
            assert may_end.wait(60.0)
            return make()

        return begin(made)

    monkeypatch.setattr(camera, "begun", begun_slowly)


def test_the_bag_is_that_of_a_run_that_waits_for_each_image(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """However long they take, and though the recorder is behind for that long."""
    for name in ("waits", "goes_on"):
        may_end = threading.Event()
        stack, state, recorder = run(tmp_path / name)
        with monkeypatch.context() as patch:
            if name == "goes_on":
                slowly(patch, may_end)
            for _ in range(PERIODS):
                state, said = stack.step(state)
                if name == "waits":
                    finish_all()
                recorder.take(said)
            behind = len(recorder._behind)
            assert behind == 0 if name == "waits" else behind > 60
            may_end.set()
            recorder.take(stack.farewells(state))
            assert not recorder.finish().gaps
    one, other = messages(tmp_path / "waits"), messages(tmp_path / "goes_on")
    images = [data for topic, *_, data in one if topic.endswith("/image")]
    assert len(images) >= 4 and len(set(images)) == len(images)
    assert one == other


def test_a_bag_has_its_account_where_no_image_could_be_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The recorder is behind with both when the first is found out."""
    begin, may_end = camera.begun, threading.Event()

    def fails() -> Any:
        assert may_end.wait(60.0)
        raise RuntimeError("no light")

    stack, state, recorder = run(tmp_path / "bag")
    monkeypatch.setattr(camera, "begun", lambda make: begin(fails))
    for _ in range(PERIODS):
        state, said = stack.step(state)
        recorder.take(said)
    may_end.set()
    with pytest.raises(RuntimeError, match="no light"):
        recorder.finish()
    (file,) = (tmp_path / "bag").glob("*.mcap")
    with file.open("rb") as stream:
        assert RECORD in [record.name for record in make_reader(stream).iter_metadata()]


def test_a_checkpoint_waits_for_what_is_unfinished(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    may_end = threading.Event()
    stack, state, recorder = run(tmp_path / "bag")
    slowly(monkeypatch, may_end)
    for _ in range(PERIODS):
        state, said = stack.step(state)
        recorder.take(said)
    threading.Timer(0.05, may_end.set).start()
    checkpoint.save(state, tmp_path / "file")
    goes_on = checkpoint.load(tmp_path / "file")
    for _ in range(PERIODS):
        (state, said), (goes_on, again) = stack.step(state), stack.step(goes_on)
        assert [encode(*one) for one in again] == [encode(*one) for one in said]
    recorder.finish()
