"""A feed to a domain: what it refuses to say, and why. What it hears of a run is in test/system/test_console.py."""

import pytest

from domains import own_domain
from sojourn_bringup.instance import RoleTokens
from sojourn_console.errors import GoalError
from sojourn_console.live_feed import ROLE, LiveFeed
from sojourn_contract.topics import STANDARD
from sojourn_contract.values import Header


def test_only_one_console_of_a_domain_commands() -> None:
    with own_domain() as domain, RoleTokens(domain, "", (ROLE,)):
        feed = LiveFeed(domain, "", STANDARD)
        try:
            assert "is a console with the control here: this one looks on" in feed.refusal()
            with pytest.raises(GoalError, match="looks on"):
                feed.send("/arm/stop", Header(0))
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
