"""A feed to a domain: what it refuses to say, and why. What it hears of a run is in test/system/test_console.py."""

from collections import deque

import numpy as np
import pytest

from domains import own_domain
from sojourn_bringup.instance import RoleInUseError, RoleTokens
from sojourn_console.errors import GoalError
from sojourn_console.live_feed import CLOCK, ROLE, LiveFeed
from sojourn_contract.codecs import encode
from sojourn_contract.heartbeat import status_message
from sojourn_contract.stamps import NANOSECONDS
from sojourn_contract.topics import STANDARD
from sojourn_contract.values import Clock, Header
from sojourn_operator.goal_messages import drive_goal, stop_messages


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
