"""A feed to a domain: what it refuses to say, and why. What it hears of a run is in test/system/test_console.py."""

from collections import deque
from time import monotonic, sleep
from typing import Any

import numpy as np
import pytest
import rclpy
from rclpy.context import Context

from domains import own_domain
from sojourn_bringup.instance import RoleInUseError, RoleTokens
from sojourn_console.errors import GoalError
from sojourn_console.live_feed import CLOCK, ROLE, LiveFeed
from sojourn_contract import qos
from sojourn_contract.codecs import decode, encode
from sojourn_contract.heartbeat import status_message
from sojourn_contract.onlookers import Onlookers
from sojourn_contract.stamps import CONTROL_PERIOD_NS, NANOSECONDS
from sojourn_contract.topic_types import Topic
from sojourn_contract.topics import STANDARD
from sojourn_contract.types import message_class
from sojourn_contract.values import Clock, Header
from sojourn_operator.goal_messages import drive_goal, stop_messages
from sojourn_studies.hostile_messages import whole

PATIENCE_S = 300.0
"""Wall time after which a test gives up."""


def test_only_one_console_of_a_domain_commands_and_everyone_stops(monkeypatch: pytest.MonkeyPatch) -> None:
    """The one that looks on has the control as soon as the other is gone."""
    goal, (_, stop) = drive_goal(0, (1.0, 0.0), None), stop_messages(0)[0]
    with own_domain() as domain:
        with RoleTokens(domain, "", (ROLE,)):
            feed = LiveFeed(domain, "", STANDARD)
            feed.now = NANOSECONDS
            assert "is a console with the control here: this one looks on, and can stop" in feed.refusal()
            for name, message in (("/goal_pose", goal), ("/cmd_vel", stop._replace(linear=np.array([0.1, 0.0, 0.0])))):
                with pytest.raises(GoalError, match="looks on"):
                    feed.send(name, message)
            with pytest.raises(GoalError, match="nobody acts on it"):  # not refused: nobody is there
                feed.send("/cmd_vel", stop)
        try:
            later = feed._claimed_at + 1.5
            monkeypatch.setattr("sojourn_console.live_feed.monotonic", lambda: later)
            assert not feed.refusal()
            with pytest.raises(RoleInUseError), RoleTokens(domain, "", (ROLE,)):
                pass
        finally:
            feed.close()


def test_what_comes_late_over_a_link_is_no_new_run() -> None:
    """A status of three minutes ago, alone between two words of the clock; a clock that begins anew is one."""
    with own_domain() as domain:
        feed = LiveFeed(domain, "", STANDARD)
        try:
            clock, status = STANDARD.topic(CLOCK), STANDARD.topic("/drive/status")
            feed._waiting[status.name] = deque()
            feed._waiting[CLOCK].append(encode(clock, Clock(300 * NANOSECONDS)))
            assert not feed.poll() and feed.now == 300 * NANOSECONDS
            feed._waiting[status.name].append(encode(status, status_message(90 * NANOSECONDS, "drive", {})))
            assert [one.time for one in feed.poll()] == [90 * NANOSECONDS]
            assert not feed.has_jumped() and feed.now == 300 * NANOSECONDS
            feed._waiting[CLOCK].append(encode(clock, Clock(NANOSECONDS)))
            feed.poll()
            assert feed.has_jumped() and feed.now == NANOSECONDS
        finally:
            feed.close()


class Speaker:
    """A node of a run in lock-step that says the time, a pose and joints, and tells onlookers."""

    role = "plant"

    def __init__(self, domain: int) -> None:
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=domain)
        node = rclpy.create_node("sojourn_plant", context=self._context, enable_rosout=False)
        self.create_publisher = node.create_publisher
        self.get_subscriptions_info_by_topic = node.get_subscriptions_info_by_topic
        self.resolve_topic_name = node.resolve_topic_name
        self._rows = {name: STANDARD.topic(name) for name in (CLOCK, "/odom", "/joint_states")}
        self._messages = {name: decode(row, whole(row)) for name, row in self._rows.items()}
        self._senders = {name: self._sender(row) for name, row in self._rows.items()}
        self._onlookers = Onlookers(self, self._rows, self._senders)
        self.stamp = 0
        self.aloud_at = 0
        """When something was sent on its own topic last."""

    def step(self) -> None:
        """Say what is said in a period."""
        self.stamp += CONTROL_PERIOD_NS
        self._onlookers.look({name: sender.get_subscription_count() for name, sender in self._senders.items()})
        for name, row in self._rows.items():
            message = self._messages[name]._replace(stamp=self.stamp)
            if not self._onlookers.takes(name, message):
                self.aloud_at = self.stamp
                self._senders[name].publish(encode(row, message))

    def close(self) -> None:
        rclpy.shutdown(context=self._context)

    def _sender(self, row: Topic) -> Any:
        return self.create_publisher(message_class(row.type), row.name.lstrip("/"), qos.profile(row, lockstep=True))


def test_of_what_it_wants_in_full_nothing_is_missing() -> None:
    """Also where a run that goes many times as fast as its clock tells it thirty times a second."""
    heard = {"/odom": list[int](), "/joint_states": list[int]()}
    with own_domain() as domain:
        speaker, feed = Speaker(domain), LiveFeed(domain, "", STANDARD)
        try:
            feed.want({"/joint_states"}, {"/odom"})
            end = monotonic() + PATIENCE_S
            while len(heard["/odom"]) < 2000 and monotonic() < end:
                speaker.step()
                sleep(0.001)
                for one in feed.poll():
                    heard[one.row.name].append(one.time)
        finally:
            feed.close()
            speaker.close()
    odometry, joints = ([stamp for stamp in of if stamp > speaker.aloud_at] for of in heard.values())
    assert odometry == list(range(odometry[0], odometry[-1] + 1, CONTROL_PERIOD_NS)) and len(odometry) > 100
    assert 0 < len(joints) < len(odometry) and joints == sorted(set(joints))


def test_a_run_that_has_fallen_silent_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    with own_domain() as domain:
        feed = LiveFeed(domain, "", STANDARD)
        try:
            heard_at = feed._heard_at
            monkeypatch.setattr("sojourn_console.live_feed.monotonic", lambda: heard_at + 12.0)
            assert not feed.silence()  # none has been heard yet: that is told by itself
            feed.now = 33 * NANOSECONDS
            assert feed.silence() == "nothing is heard of the run for 12 s: what is shown is of 33.0 s"
            monkeypatch.setattr("sojourn_console.live_feed.monotonic", lambda: heard_at + 1.0)
            assert not feed.silence()
        finally:
            feed.close()


def test_nothing_is_said_where_no_run_is_heard_nor_on_topics_of_others() -> None:
    with own_domain() as domain:
        feed = LiveFeed(domain, "", STANDARD)
        try:
            feed.want({"/odom"}, {"/drive/status"})
            assert not feed.is_heard and not feed.poll() and not feed.has_jumped()
            with pytest.raises(GoalError, match="no run is heard yet"):
                feed.send("/arm/stop", Header(0))
            with pytest.raises(GoalError, match="/odom: allowed is a topic on which operators speak"):
                feed.send("/odom", Header(0))
        finally:
            feed.close()
        with RoleTokens(domain, "", (ROLE,)):  # it has let go of the control
            pass
