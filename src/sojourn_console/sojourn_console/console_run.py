"""Serves the page until it is told to stop: the work of scripts/console."""

import argparse
import getpass
from pathlib import Path

import rich

from sojourn_bags.errors import BagsError
from sojourn_bags.reading import read_bag
from sojourn_config.command_line import say
from sojourn_config.errors import ConfigError
from sojourn_console.bag_feed import BagFeed
from sojourn_console.console import LATEST
from sojourn_console.errors import ConsoleError
from sojourn_console.feed import Feed
from sojourn_console.gate import GuardedServer
from sojourn_console.live_feed import LiveFeed
from sojourn_console.page import Page
from sojourn_console.world import World, world_named, world_of_bag, world_of_run
from sojourn_contract.errors import UnknownFieldNameError
from sojourn_contract.stop_flag import StopFlag

ADDRESS = "the console is at"
"""Before the address, for who starts the console for others."""

HEARD = "the run is heard"


def run(given: argparse.Namespace) -> int:
    """Serve until Ctrl-C. Raises ConsoleError, ConfigError."""
    stop = StopFlag().install()
    rich.get_console().quiet = True  # viser would print its address, without the token
    world, feed = _bag(given.bag) if given.bag is not None else _live(given)
    server = GuardedServer("Sojourn", given.port)
    try:
        page = Page(server, world, feed, given.limits, given.who or getpass.getuser())
    except (ConfigError, UnknownFieldNameError) as error:
        server.stop()
        feed.close()
        raise ConsoleError(str(error)) from error
    say(f"{ADDRESS} {server.address}")
    told = False

    def goes_on() -> bool:
        nonlocal told
        stamp = page.bench.scene.stamp
        if stamp and not told:
            told = True
            say(f"{HEARD}, from {stamp * 1e-9:.2f} s on")
        return not stop.is_set

    try:
        page.run(goes_on)
    finally:
        page.close()
    return 0


def _bag(path: Path) -> tuple[World, Feed]:
    try:
        bag = read_bag(path)
        world = world_of_bag(bag)
    except BagsError as error:
        raise ConsoleError(str(error)) from error
    return world, BagFeed(bag, world.table)


def _live(given: argparse.Namespace) -> tuple[World, Feed]:
    if given.scenario is not None:
        world = world_named(given.scenario, given.set)
    else:
        world = world_of_run(given.run_dir or LATEST)
    return world, LiveFeed(given.domain, given.namespace, world.table)
