"""Sequences on the page: written, checked, carried out with the machine's answers, held, ended; and what cannot be."""

import json

import pytest
from deaf_feed import DeafFeed

from sojourn_config.yaml_file import parse_yaml
from sojourn_console.draft import Draft
from sojourn_console.errors import SequenceError
from sojourn_console.feed import FeedMessage
from sojourn_console.panels.sequence import history_html, problems_html
from sojourn_console.sequence_board import SequenceBoard, with_step
from sojourn_console.world import World
from sojourn_contract.codecs import encode
from sojourn_contract.heartbeat import status_message
from sojourn_operator.sequence.runner import ABORTED, ENDED, RUNNING

TWO = (
    "steps:\n  - drive_to: {x: 0.2, y: 0.0}\n  - drive_to: {x: 0.4, y: 0.0}\n    when: /drive/status.state == reached\n"
)


@pytest.fixture
def board(world: World, feed: DeafFeed) -> SequenceBoard:
    return SequenceBoard(world, feed, "Ada")


def drive_says(board: SequenceBoard, world: World, feed: DeafFeed, state: str) -> None:
    """Of the goal that was sent last; a second later the page looks."""
    feed.now += 1_000_000_000
    row, stamp = world.table.topic("/drive/status"), feed.said[-1][1].stamp
    values = {"state": state, "goal_stamp": str(stamp), "reason": ""}
    board.hear([FeedMessage(row, encode(row, status_message(feed.now, "drive", values)), feed.now)])


def test_each_step_begins_after_the_machines_answer(board: SequenceBoard, world: World, feed: DeafFeed) -> None:
    assert board.describe() == "none has begun" and not board.topics
    assert board.begin(TWO) == "2 steps begin"
    assert "/drive/status" in board.topics
    board.hear([])
    assert [name for name, _ in feed.said] == ["/goal_pose"]
    drive_says(board, world, feed, "moving")
    assert len(feed.said) == 1 and board.state.phase == RUNNING
    drive_says(board, world, feed, "reached")
    board.hear([])
    assert len(feed.said) == 2 and feed.said[1][1].position[0] == 0.4
    drive_says(board, world, feed, "reached")
    assert board.state.phase == ENDED and not board.is_under_way and not board.topics
    assert [(entry.who, entry.outcome) for entry in board.history] == [("sequence", "reached")] * 2
    assert json.loads(board.as_json())["history"][0]["what"] == "drive to (0.20, 0.00)"
    board.begin("steps:\n  - wait_s: 5.0\n")
    assert len(board.history) == 2  # what was done before stays


def test_an_end_that_is_told_between_two_looks_is_not_missed(
    board: SequenceBoard, world: World, feed: DeafFeed
) -> None:
    """Of a fast stack a refusal beside a goal that goes on comes and goes within one look."""
    board.begin(TWO)
    board.hear([])
    row, stamp = world.table.topic("/drive/status"), feed.said[-1][1].stamp
    heard = []
    for second, (state, goal) in enumerate((("refused", stamp), ("moving", 3), ("moving", 3)), 1):
        values = {"state": state, "goal_stamp": str(goal), "reason": "too far"}
        time = feed.now + second * 1_000_000_000
        heard.append(FeedMessage(row, encode(row, status_message(time, "drive", values)), time))
    feed.now += 3_000_000_000
    board.hear(heard)
    assert [(entry.outcome, entry.reason) for entry in board.history] == [("refused", "too far")]


def test_an_operators_words(board: SequenceBoard, world: World, feed: DeafFeed) -> None:
    with pytest.raises(SequenceError, match="no sequence is under way"):
        board.hold()
    board.begin(TWO)
    board.hear([])
    with pytest.raises(SequenceError, match="abort it first"):
        board.begin(TWO)
    board.hold()
    drive_says(board, world, feed, "reached")
    board.hear([])
    assert len(feed.said) == 1 and "held by Ada" in board.describe()
    board.resume()
    board.hear([])
    assert len(feed.said) == 2
    board.skip()
    assert feed.said[-1][0] == "/cmd_vel" and board.state.phase == ENDED
    board.begin(TWO)
    board.hear([])
    board.abort()
    assert board.state.phase == ABORTED and feed.said[-1][0] == "/cmd_vel"
    words = history_html(board.history)
    assert "✗ Ada: drive to (0.20, 0.00): aborted" in words and "✓ Ada: hold: done" in words


def test_bad_files_are_told_line_by_line(board: SequenceBoard) -> None:
    for text, words in {
        "steps:\n  - drive_to: {x: 0.2, speed: 3}\n": r"mine.yaml:2: steps\[0\].drive_to.speed",
        "steps:\n  - drive_to: {x: 999.0, y: 0.0}\n": r"mine.yaml:2: .*999",
        "steps:\n  - wait_s: 1.0\n    when: /battery_state.charg > 0.3\n": "mine.yaml:3: .*charg",
        "steps: [": "not a YAML document",
        "": "allowed is a table",
    }.items():
        with pytest.raises(SequenceError, match=words) as refused:
            board.begin(text, "mine.yaml")
        assert not board.is_under_way
        assert "<div>" in problems_html(str(refused.value))
    assert "&lt;" in problems_html("<")


def test_what_nobody_hears_ends_it(board: SequenceBoard, feed: DeafFeed) -> None:
    feed.deaf = {"/goal_pose", "/cmd_vel"}
    board.begin(TWO)
    board.hear([])
    assert board.state.phase == ABORTED and "nobody acts on it" in board.history[-1].reason


def test_goals_of_the_scene_become_steps(board: SequenceBoard) -> None:
    text = ""
    for draft in (
        Draft("drive", ((1.0, 0.5, 0.0),), yaw=0.5),
        Draft("route", ((1.0, 0.0, 0.0), (2.0, 0.25, 0.0))),
        Draft("arm", ((1.1, 0.0, -0.2),)),
        Draft("task", task="tare", values={"seconds": "2"}),
    ):
        text = with_step(text, draft.step())
    config = board.check(text)
    assert [step.kind for step in config.steps] == ["drive_to", "drive_route", "arm_to", "arm_task"]
    assert config.steps[0].action.yaw == 0.5 and config.steps[3].action.texts == {"seconds": "2"}
    scenario = parse_yaml(board.as_scenario(with_step(text, {"wait_s": 1.0, "hold": True})), "scenario")
    assert len(scenario.data["steps"]) == 5 and "hold" not in scenario.data["steps"][4]
