"""A bag played: time goes on, jumps and steps, and each message comes once."""

import pytest

from sojourn_bags.reading import Bag
from sojourn_console.bag_feed import STEP_NS, BagFeed
from sojourn_console.errors import GoalError
from sojourn_console.world import World
from sojourn_contract.values import Header


@pytest.fixture
def player(reference: Bag, world: World) -> BagFeed:
    player = BagFeed(reference, world.table)
    player.want({"/drive/status"}, {"/odom"})
    return player


def test_every_message_of_what_is_wanted_in_full_comes_once(reference: Bag, player: BagFeed) -> None:
    found = []
    while player.is_playing:
        player.advance(0.11)
        found += player.poll()
    odometry = [heard.data for heard in found if heard.row.name == "/odom"]
    assert odometry == reference["/odom"].data
    assert [heard.time for heard in found] == sorted(heard.time for heard in found)
    assert found[-1].row.name in ("/odom", "/drive/status") and not player.poll()


def test_of_all_others_the_newest_comes(reference: Bag, player: BagFeed) -> None:
    player.jump(player.end)
    statuses = [heard for heard in player.poll() if heard.row.name == "/drive/status"]
    assert [heard.data for heard in statuses] == [reference["/drive/status"].data[-1]]


def test_a_jump_back_begins_anew(player: BagFeed) -> None:
    player.jump(player.end)
    late = player.poll()
    assert player.has_jumped() and not player.has_jumped()
    player.jump(player.begin + 2_000_000_000)
    early = player.poll()
    assert player.has_jumped()
    assert max(heard.time for heard in early) <= player.begin + 2_000_000_000 < max(heard.time for heard in late)


def test_speed_and_steps(player: BagFeed) -> None:
    player.speed = 5.0
    player.advance(0.2)
    assert player.now == player.begin + 1_000_000_000
    player.step()
    assert not player.is_playing and player.now == player.begin + 1_000_000_000 + STEP_NS
    player.advance(10.0)
    player.step(-1)
    assert player.now == player.begin + 1_000_000_000
    player.jump(-5)
    assert player.now == player.begin


def test_nothing_is_commanded(player: BagFeed) -> None:
    assert "played" in player.refusal()
    with pytest.raises(GoalError, match="/arm/stop"):
        player.send("/arm/stop", Header(0))
