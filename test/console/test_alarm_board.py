"""Alarms and log on the page: judged, shown, heard, acknowledged; and what cannot be."""

import base64
import io
import re
import wave

import numpy as np
import pytest

from sojourn_bags.reading import Bag
from sojourn_console import alarm_board
from sojourn_console.alarm_board import AlarmBoard
from sojourn_console.alarm_sound import RATE, sound_html, sound_of
from sojourn_console.bag_feed import BagFeed
from sojourn_console.errors import AlarmError
from sojourn_console.panels.alarms import alarms_html, band_html, log_html
from sojourn_console.world import World
from sojourn_operator.alarms.params import AlarmParams, Severity
from sojourn_operator.alarms.watch import Watch

LIMITS = {
    "moves": {"field": "/drive/status.state", "critical": {"equals": "moving"}, "help": "<it> moves"},
    "far": {"field": "/odom.pose.pose.position.x", "warning": {"above": 0.05}},
}


@pytest.fixture
def board(world: World) -> AlarmBoard:
    limits = {name: AlarmParams.model_validate(values) for name, values in LIMITS.items()}
    return AlarmBoard(Watch(limits, world.table), "Ada")


def played(board: AlarmBoard, reference: Bag, world: World) -> BagFeed:
    """To its end, until nothing is left to be judged."""
    feed = BagFeed(reference, world.table)
    feed.want((), board.topics)
    feed.jump(feed.end)
    worst = board.hear(feed.poll())
    assert board.behind  # a bag at once is more than a look
    while board.behind:
        worst = max(worst, board.hear([]))
    assert worst is Severity.CRITICAL
    return feed


def test_what_is_the_matter_is_shown_until_it_is_acknowledged(board: AlarmBoard, reference: Bag, world: World) -> None:
    played(board, reference, world)
    assert [alarm.key for alarm in board.open] == ["moves", "far"]
    words = alarms_html(board)
    assert "&lt;it&gt; moves" in words and "over, not acknowledged" in words and "active" in words
    band = band_html(board.open)
    assert "CRITICAL" in band and "moves and 1 more" in band and "animation" in band
    assert "moves" in board.acknowledge("moves") and "by Ada" in board.acknowledge("far")
    assert [alarm.key for alarm in board.shown] == ["far"]  # it is still so
    assert not board.open and band_html(board.open) == ""
    with pytest.raises(AlarmError, match="acknowledge: there is no alarm"):
        board.acknowledge()
    assert "acknowledged critical moves" in log_html(board, "operator")
    board.clear()
    assert not board.shown and not board.log


def test_one_that_is_not_shown_is_refused_by_name(board: AlarmBoard, reference: Bag, world: World) -> None:
    played(board, reference, world)
    with pytest.raises(AlarmError, match="tilt: allowed is moves or far"):
        board.acknowledge("tilt")
    assert "2 alarms acknowledged" in board.acknowledge()


def test_the_log_is_of_everything_and_has_an_end(
    board: AlarmBoard, reference: Bag, world: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed = played(board, reference, world)
    assert {"alarm", "goal"} <= {event.kind for event in board.log}
    assert "drive" in log_html(board, "goal") and "drive/status.state" not in log_html(board, "goal")
    feed.jump(feed.end)
    broken = replace_data(feed)
    board.hear([broken])
    assert board.log[-1].kind == "contract" and broken.row.name in board.log[-1].text
    board.log.clear()
    monkeypatch.setattr(alarm_board, "KEPT", 3)
    short = AlarmBoard(board._watch, "Ada")
    for _ in range(5):
        short.hear([broken])
    assert len(short.log) == 3


def replace_data(feed: BagFeed):
    """A message of a topic of the log that nobody can read."""
    one = next(heard for heard in feed.poll() if heard.row.name == "/drive/status")
    return one._replace(data=one.data[:9])


def test_sounds_are_tones_of_their_pitch() -> None:
    for severity, pitch in ((Severity.WARNING, 660.0), (Severity.CRITICAL, 880.0)):
        with wave.open(io.BytesIO(sound_of(severity))) as sound:
            assert sound.getframerate() == RATE
            samples = np.frombuffer(sound.readframes(sound.getnframes()), dtype="<i2")
        spectrum = np.abs(np.fft.rfft(samples))
        assert np.fft.rfftfreq(len(samples), 1.0 / RATE)[spectrum.argmax()] == pytest.approx(pitch, abs=6.0)
    assert sound_html(Severity.WATCH, 1) == ""
    words = sound_html(Severity.CRITICAL, 2)
    assert words != sound_html(Severity.CRITICAL, 3)  # so that the browser plays it again
    found = re.search(r'base64,([^"]+)"', words)
    assert found is not None and base64.b64decode(found[1]) == sound_of(Severity.CRITICAL)
