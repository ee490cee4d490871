"""Goals from the page: as messages, refused where they cannot be, stopped, paused, and who may send them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from deaf_feed import DeafFeed

from sojourn_console.control import Control
from sojourn_console.desk import CommandDesk
from sojourn_console.draft import Draft
from sojourn_console.errors import GoalError
from sojourn_console.gate import GuardedServer
from sojourn_console.goal_words import foresight_rows
from sojourn_console.model import BasePose, RunScene
from sojourn_console.page import Page
from sojourn_console.panels.head import HeadPanel, head_html
from sojourn_console.panels.panel import table_html
from sojourn_console.world import World
from sojourn_contract.codecs import encode
from sojourn_contract.errors import RefusedMessageError
from sojourn_contract.topics import topic
from sojourn_machine.params import FloatArray
from sojourn_operator.goal_messages import QUESTION

MOVING = RunScene(statuses={"/drive/status": {"state": "moving"}, "/arm/status": {"state": "moving"}})


def drive_tells(state: str, stamp: int) -> RunScene:
    """A scene in which the drive is in a state with the goal of a stamp [ns]."""
    return RunScene(statuses={"/drive/status": {"state": state, "goal_stamp": str(stamp)}})


def test_drafts_are_the_messages_of_their_topics() -> None:
    place = Draft("drive", ((2.0, 1.0, 0.7),), yaw=math.pi / 2)
    name, goal = place.message(7)
    assert (name, goal.frame, goal.stamp) == ("/goal_pose", "map", 7)
    assert goal.position == pytest.approx([2.0, 1.0, 0.7])
    assert goal.orientation == pytest.approx([0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5)])
    route = Draft("route").with_point((1.0, 0.0, 0.0)).with_point((2.0, 1.0, 0.0))
    name, way = route.message(7)
    assert name == "/waypoints" and [tuple(pose.position[:2]) for pose in way.poses] == [(1.0, 0.0), (2.0, 1.0)]
    arm = Draft("arm").with_point((1.1, 0.0, -0.2)).with_point((1.2, 0.0, -0.2))
    name, tip = arm.message(7)
    assert (name, tip.frame) == ("/arm/goal_pose", "base_link") and tip.position == pytest.approx([1.2, 0.0, -0.2])
    task = Draft("task", task="tare", values={"seconds": "2"})
    assert task.message(7)[1].status[0].values == (("seconds", "2"),)
    for draft in (place, route, arm, task):
        assert encode(topic(draft.message(7)[0]), draft.message(7)[1])
    assert encode(topic("/drive/question"), place.question(7))
    assert route.length == pytest.approx(math.sqrt(2.0)) and route.without_last().points == ((1.0, 0.0, 0.0),)
    assert route.moved(0, (5.0, 5.0, 0.0)).points[0] == (5.0, 5.0, 0.0)


def test_what_cannot_be_sent_is_told(world: World) -> None:
    Draft("drive", ((1.0, 0.0, 0.0),)).check(world.ground)
    with pytest.raises(GoalError, match=r"\(999.00, 0.00\): it is off the map: allowed is x from"):
        Draft("route", ((1.0, 0.0, 0.0), (999.0, 0.0, 0.0))).check(world.ground)
    with pytest.raises(GoalError, match="click on the ground"):
        Draft("drive").check(world.ground)
    with pytest.raises(GoalError, match="task: none is chosen"):
        Draft("task").check(world.ground)
    with pytest.raises(GoalError, match="ways alone"):
        Draft("arm", ((1.0, 0.0, 0.0),)).question(0)


def test_a_place_far_away_becomes_a_route_over_the_map(world: World) -> None:
    """Round a wall that the drive has found, on its ground, and nowhere where there is no way."""
    start, draft = (0.0, 0.0, 0.3), Draft("drive", ((6.0, 0.0, 0.0),), yaw=0.5)
    wall = np.array([(3.0, y) for y in np.arange(-2.0, 2.01, 0.2)])
    level = replace(world.site, heights=np.zeros((10, 20)), zones=())

    def heights(places: FloatArray) -> FloatArray:
        return places[:, 0] + 1.0

    routed = draft.over(level.with_found(wall), start, heights)
    assert routed.kind == "route" and routed.yaw == 0.5 and len(routed.points) > 1
    assert routed.points[-1] == (6.0, 0.0, 7.0) and max(abs(y) for _, y, _ in routed.points) > 2.5
    assert draft.over(level, start, heights).points == ((6.0, 0.0, 7.0),)
    with pytest.raises(GoalError, match="over the map: no route to"):
        replace(draft, points=((999.0, 0.0, 0.0),)).over(level, start, heights)
    with pytest.raises(GoalError, match="click on the ground"):
        Draft("arm", ((1.0, 0.0, 0.0),)).over(level, start, heights)


def test_a_stop_goes_to_both_without_a_stamp(feed: DeafFeed) -> None:
    desk = CommandDesk(feed)
    assert desk.stop() == ("drive", "arm")
    assert [(name, message.stamp) for name, message in feed.said] == [("/cmd_vel", 0), ("/arm/stop", 0)]
    feed.deaf = {"/arm/stop"}
    assert desk.stop() == ("drive",)  # a machine without an arm is stopped all the same
    feed.deaf = {"/arm/stop", "/cmd_vel"}
    with pytest.raises(GoalError, match="nobody acts"):
        desk.stop()


def test_a_route_goes_on_after_a_pause_without_what_was_passed(feed: DeafFeed) -> None:
    desk = CommandDesk(feed)
    stamp = desk.send(Draft("route", ((1.0, 0.0, 0.0), (2.0, 0.0, 0.0), (3.0, 0.0, 0.0))))
    assert stamp == feed.now and feed.said[-1][1].stamp == stamp
    at = BasePose(np.array([1.1, 0.1, 0.5]), np.array([0.0, 0.0, 0.0, 1.0]))
    driving = replace(drive_tells("moving", stamp), pose=at)
    desk.look(driving)
    assert desk.pause(driving) == "drive paused"
    assert feed.said[-1][0] == "/cmd_vel" and not feed.said[-1][1].linear.any()
    feed.now += 1
    assert desk.resume(drive_tells("stopped", stamp)) == "drive goes on"
    name, way = feed.said[-1]
    assert name == "/waypoints" and [pose.position[0] for pose in way.poses] == [2.0, 3.0]
    assert way.stamp == feed.now
    assert desk.resume(drive_tells("moving", feed.now)) == "nothing is paused"


def test_a_pause_that_is_pressed_twice_is_one(feed: DeafFeed) -> None:
    """A second stop is told as a new command, after which nothing went on."""
    desk = CommandDesk(feed)
    stamp = desk.send(Draft("drive", ((1.0, 0.0, 0.0),)))
    assert [desk.pause(drive_tells("moving", stamp)) for _ in range(2)] == ["drive paused"] * 2
    assert [name for name, _ in feed.said] == ["/goal_pose", "/cmd_vel"]
    assert desk.resume(drive_tells("stopped", stamp)) == "drive goes on"


def test_a_goal_that_is_over_neither_pauses_nor_goes_on_for_another(feed: DeafFeed) -> None:
    """Pause said "drive paused" of a sequence's goal, and Resume sent the rover to the old one."""
    desk = CommandDesk(feed)
    stamp = desk.send(Draft("drive", ((1.0, 0.0, 0.0),)))
    desk.look(drive_tells("moving", stamp))
    desk.look(drive_tells("reached", stamp))
    assert "paused" not in desk.pause(drive_tells("reached", stamp))
    other = drive_tells("moving", 0)
    with pytest.raises(GoalError, match=r"not the last that was sent from here: allowed is STOP or Cancel"):
        desk.pause(other)
    assert desk.resume(other) == "nothing is paused" and len(feed.said) == 1


def test_what_another_goal_has_taken_over_does_not_go_on(feed: DeafFeed) -> None:
    desk = CommandDesk(feed)
    stamp = desk.send(Draft("drive", ((1.0, 0.0, 0.0),)))
    desk.pause(drive_tells("moving", stamp))
    desk.look(drive_tells("moving", stamp + 1))
    said = len(feed.said)
    for scene in (drive_tells("reached", stamp + 1), drive_tells("refused", stamp + 2)):
        with pytest.raises(GoalError, match="commanded otherwise since it was paused: allowed is to send a goal"):
            desk.resume(scene)
    assert len(feed.said) == said


def test_a_drive_that_was_not_sent_from_here_is_not_told_to_rest(feed: DeafFeed) -> None:
    """Pause told in green that nothing was under way while a sequence drove on; the arm pauses all the same."""
    desk = CommandDesk(feed)
    with pytest.raises(GoalError, match=r"^drive: the goal under way is not .* allowed is STOP or Cancel$"):
        desk.pause(drive_tells("moving", 7))
    with pytest.raises(GoalError, match=r"^arm paused; drive: the goal under way"):
        desk.pause(MOVING)
    assert [name for name, _ in feed.said] == ["/arm/task"]


def test_a_goal_of_which_the_drive_has_not_told_yet_is_not_paused(feed: DeafFeed) -> None:
    desk = CommandDesk(feed)
    stamp = desk.send(Draft("drive", ((1.0, 0.0, 0.0),)))
    for before in (RunScene(), drive_tells("reached", 3), drive_tells("moving", 3)):
        with pytest.raises(GoalError, match="it has not told yet of the goal that was sent last: allowed is STOP"):
            desk.pause(before)
    assert desk.pause(drive_tells("moving", stamp)) == "drive paused"


def test_a_goal_on_its_way_over_the_link_is_none_that_was_sent_without_a_stamp(feed: DeafFeed) -> None:
    """As long as the Earth does not know it the machine has no stamp for it; a sequence's goals have none either."""
    desk = CommandDesk(feed)
    stamp = desk.send(Draft("drive", ((1.0, 0.0, 0.0),)))
    feed.machine_stamp = lambda name, stamp: "0"
    with pytest.raises(GoalError, match="it has not told yet"):
        desk.pause(drive_tells("moving", 0))
    feed.machine_stamp = lambda name, stamp: "77"
    with pytest.raises(GoalError, match="it has not told yet"):
        desk.pause(drive_tells("moving", stamp))
    assert desk.pause(drive_tells("moving", 77)) == "drive paused"


def test_a_goal_that_goes_on_beside_a_refused_one_is_paused_and_cancelled(feed: DeafFeed) -> None:
    """While the drive tells of another's goal that it has refused it still drives to the one before."""
    desk = CommandDesk(feed)
    stamp = desk.send(Draft("drive", ((1.0, 0.0, 0.0),)))
    desk.look(drive_tells("moving", stamp))
    refused = drive_tells("refused", stamp + 5)
    desk.look(refused)
    assert desk.pause(refused) == "drive paused"
    assert desk.resume(refused) == "drive goes on"
    desk.look(drive_tells("moving", feed.now))
    assert desk.cancel(refused) == "goal of drive cancelled"


def test_a_route_goes_on_beside_one_from_here_that_was_refused(feed: DeafFeed) -> None:
    """Pause took the refused one for the last that was sent, and the route for somebody else's."""
    desk = CommandDesk(feed)
    stamp = desk.send(Draft("route", ((1.0, 0.0, 0.0), (2.0, 0.0, 0.0))))
    desk.look(drive_tells("moving", stamp))
    feed.now += 1
    refused = drive_tells("refused", desk.send(Draft("drive", ((900.0, 0.0, 0.0),))))
    desk.look(replace(refused, pose=BasePose(np.array([1.1, 0.1, 0.5]), np.array([0.0, 0.0, 0.0, 1.0]))))
    assert desk.pause(refused) == "drive paused"
    feed.now += 1
    desk.send(Draft("drive", ((900.0, 0.0, 0.0),)))
    desk.look(refused := drive_tells("refused", feed.now))
    assert desk.resume(refused) == "drive goes on"
    assert [pose.position[0] for pose in feed.said[-1][1].poses] == [2.0]


def test_a_goal_goes_on_beside_two_from_here_that_were_refused(feed: DeafFeed) -> None:
    """Of the first of two within a second nothing is told."""
    desk = CommandDesk(feed)
    stamp = desk.send(Draft("drive", ((1.0, 0.0, 0.0),)))
    for _ in range(2):
        feed.now += 1
        desk.send(Draft("drive", ((900.0, 0.0, 0.0),)))
    desk.look(drive_tells("refused", feed.now))
    desk.look(driving := drive_tells("moving", stamp))  # of which nothing was told before
    assert desk.pause(driving) == "drive paused"
    assert desk.resume(drive_tells("stopped", stamp)) == "drive goes on"
    assert feed.said[-1][1].position[0] == 1.0


def test_a_goal_that_is_refused_after_all_is_not_under_way(feed: DeafFeed) -> None:
    """As one is whose battery does not last any more."""
    desk = CommandDesk(feed)
    stamp = desk.send(Draft("drive", ((1.0, 0.0, 0.0),)))
    desk.look(drive_tells("moving", stamp))
    assert desk.pause(drive_tells("refused", stamp)) == "there is nothing under way"


def test_the_arm_pauses_by_itself(feed: DeafFeed) -> None:
    desk = CommandDesk(feed)
    arm = RunScene(statuses={"/arm/status": {"state": "moving"}})
    assert desk.pause(arm) == "arm paused"
    assert desk.resume(arm) == "arm goes on"
    assert [message.status[0].name for _, message in feed.said] == ["pause", "resume"]


def test_a_stop_says_who_does_not_hear_it(world: World, feed: DeafFeed) -> None:
    page = Page(GuardedServer("stop", 8920), world, feed)
    try:
        head = page._head[0]
        assert isinstance(head, HeadPanel) and head._stop() == "stop sent to drive and arm"
        feed.deaf = {"/arm/stop"}
        assert head._stop() == "stop sent to drive, not to the arm: nobody acts on it"
        feed.deaf = {"/cmd_vel"}
        assert head._stop() == "stop sent to arm, not to the drive: nobody acts on it"
    finally:
        page.close()


def test_what_was_paused_in_a_run_does_not_go_on_in_the_next(world: World, feed: DeafFeed) -> None:
    page = Page(GuardedServer("again", 8910), world, feed)
    try:
        desk = page.bench.desk
        stamp = desk.send(Draft("drive", ((1.0, 0.0, 0.0),)))
        assert desk.pause(drive_tells("moving", stamp)) == "drive paused"
        feed.has_jumped = lambda: True
        page.look()
        said = len(feed.said)
        assert desk.resume(page.bench.scene) == "nothing is paused" and len(feed.said) == said
    finally:
        page.close()


def test_cancel_ends_what_is_under_way_alone(feed: DeafFeed) -> None:
    desk = CommandDesk(feed)
    desk.send(Draft("drive", ((1.0, 0.0, 0.0),)))
    assert desk.cancel(RunScene(statuses={"/drive/status": {"state": "moving"}})) == "goal of drive cancelled"
    assert feed.said[-1][0] == "/cmd_vel" and desk.driven is None
    assert desk.cancel(RunScene()) == "there is no goal under way"
    assert desk.cancel(MOVING) == "goal of drive and arm cancelled"


def test_one_page_commands_at_a_time() -> None:
    control = Control().claimed_by(1)
    assert control.claimed_by(1) == control
    with pytest.raises(GoalError, match="page 1 has it: press “Take control”"):
        control.claimed_by(2)
    assert control.taken_by(2).holder == 2
    assert control.without(2) == control and control.without(1).holder is None


def test_a_goal_that_is_refused_whatever_it_is_is_told_in_the_drives_own_words() -> None:
    """What the contract says before them is of the message that asked."""
    refusal = RefusedMessageError(QUESTION, "header", "a goal now", "none while the arm is out: stow it first")
    rows = foresight_rows({"asked_state": "refused", "asked_reason": str(refusal)})
    assert rows == [("rehearsal", "refused: the arm is out: stow it first")]


def test_a_goal_whose_charge_nobody_has_judged_says_so() -> None:
    """Asked before the battery was heard it was allowed without a word on it."""
    answer = {"asked_state": "allowed", "asked_length_m": "3.0", "asked_time_s": "60", "asked_energy_wh": "1.5"}
    unknown = [value for name, value in foresight_rows(answer) if name == "charge at the end"]
    assert len(unknown) == 1 and unknown[0].startswith("not known: the drive has not heard of a battery")
    assert ("charge at the end", "81.2%") in foresight_rows({**answer, "asked_charge_at_end": "0.812"})


def test_words_of_the_page_escape_what_others_say() -> None:
    answer = {"asked_state": "refused", "asked_reason": "<b>too far</b>", "asked_length_m": "3.0"}
    words = table_html(foresight_rows(answer))
    assert "&lt;b&gt;too far" in words and "3.00 m" in words
    scene = RunScene(statuses={"/drive/status": {"state": "refused", "reason": "<script>"}}, charge=0.5)
    words = head_html(scene, "flat_drive", "explorer")
    assert "<script>" not in words and "50.0 %" in words and "not heard" in head_html(RunScene(), "a", "b")
