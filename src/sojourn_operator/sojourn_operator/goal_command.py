"""What scripts/goal does once its words are read."""

import argparse

from sojourn_config import command_line
from sojourn_config.command_errors import CommandError, UsageError
from sojourn_contract.heartbeat import status_message
from sojourn_contract.topics import topic
from sojourn_contract.values import UPRIGHT, Message, Path, PoseStamped
from sojourn_operator.foresight_words import foresight_lines
from sojourn_operator.goal_messages import (
    QUESTION,
    drive_goal,
    place_message,
    pose_message,
    question_message,
    route_goal,
)
from sojourn_operator.goal_sending import DONE, GOALS, INTERRUPTED, GoalClient
from sojourn_operator.steps.step import REACHED


def _drive_goal(given: argparse.Namespace) -> PoseStamped | Path:
    """Where to drive."""
    if given.command == "drive":
        return drive_goal(0, (given.x, given.y), given.yaw, given.frame, given.z)
    if len(given.points) % 2:
        raise UsageError(f"points: {len(given.points)} numbers, allowed is an even count: X Y for each point")
    return route_goal(0, list(zip(given.points[::2], given.points[1::2], strict=True)), given.yaw, given.frame)


def _goal(given: argparse.Namespace) -> Message:
    """What was asked for, as a message."""
    if given.command in ("drive", "route"):
        return _drive_goal(given)
    if given.command == "task":
        return status_message(0, given.name, dict(_key_and_value(text) for text in given.values))
    if given.command == "power":
        return status_message(0, "request", {given.load: given.switch})
    if given.command == "here":
        return place_message(0, (given.x, given.y), given.yaw, given.within)
    return pose_message(0, given.frame, (given.x, given.y, given.z), UPRIGHT)


def _key_and_value(text: str) -> tuple[str, str]:
    key, found, value = text.partition("=")
    if not found or not key:
        raise UsageError(f"{text!r}: allowed is KEY=VALUE")
    return key, value.replace(",", " ")


def _ask(client: GoalClient, goal: PoseStamped | Path, timeout_s: float) -> int:
    """Ask what it would take to drive; 0 if the goal is allowed."""
    client.send("drive", QUESTION, question_message(goal))
    answer = client.answer(timeout_s)
    if answer is None:
        raise CommandError(f"the drive did not answer within {timeout_s:g} s of wall time")
    command_line.say("\n".join(foresight_lines(answer)))
    return 0 if answer.get("asked_state") == "allowed" else 1


def _drive_over(given: argparse.Namespace) -> int:
    """Drive over the map of a scenario; 0 if the goal was reached, or with --dry-run is allowed."""
    if given.frame != "map":
        raise UsageError(f"--over: a route over the map ends in map, not in {given.frame}")
    # here: no other goal needs a map, nor the tenth of a second in which all of it loads
    from sojourn_flight.planning.global_route import NoRouteError
    from sojourn_operator.far_goal import drive_far, route_words, site_of
    from sojourn_operator.route_client import RouteClient

    site = site_of(given.over, given.set)
    with GoalClient(given.domain, given.namespace) as client:
        who, name = GOALS["route"]
        client.sender_to(who, topic(name))  # a stack that is starting is waited for
        driver = RouteClient(client, given.timeout, client.has_link())
        if given.dry_run:
            try:
                points = site.route(driver.here(), (given.x, given.y))
            except NoRouteError as error:
                return _told("refused", str(error))
            command_line.say(route_words(points))
            return _ask(client, route_goal(0, points, given.yaw), given.timeout)
        goal = given.x, given.y
        outcome, reason = drive_far(driver, site, goal, given.yaw, command_line.say)
    return _told(outcome, reason)


def _told(outcome: str, reason: str) -> int:
    """Say how a goal ended; the exit status for it."""
    command_line.say(f"{outcome}{': ' + reason if reason else ''}")
    if outcome == "interrupted":
        return INTERRUPTED
    return 0 if outcome in (REACHED, DONE) else 1


def _fail(given: argparse.Namespace) -> int:
    """Let something fail, or be well again; 0 if whose it is says so."""
    # here: no other goal needs the faults of all machines, nor the time in which they load
    from sojourn_operator.fault_sending import CAME, WENT, answer_of, fault_event, message_of

    event = fault_event(given, (_key_and_value(text) for text in given.values))
    with GoalClient(given.domain, given.namespace) as client:
        client.hear_from(event.fault.role)
        before = dict(client.beats)
        client.send(*GOALS["fault"], message_of(event))
        role = event.fault.role
        outcome, reason = client.watch(role, lambda: answer_of(event, before, client.beats), given.timeout)
    command_line.say(f"{outcome}: {reason}")
    return 0 if outcome in (CAME, WENT) else 1


def run(given: argparse.Namespace) -> int:
    """Send a goal; 0 only if it was reached (a stop: if drive and arm stand; a dry run: if it is allowed; a switch: if
    it is done).
    """
    if given.command == "fault":
        return _fail(given)
    if given.command == "cancel":
        with GoalClient(given.domain, given.namespace) as client:
            gone = client.cancel("" if given.number is None else str(given.number))
        command_line.say(
            f"cancelled: {', '.join(gone)}" if gone else "nothing of it waits: what has begun to leave goes its way"
        )
        return 0 if gone else 1
    if given.command == "drive" and given.over is not None:
        return _drive_over(given)
    if given.command == "drive" and given.set:
        raise UsageError("--set: allowed with --over alone, for the scenario whose map it is")
    message = None if given.command == "stop" else _goal(given)
    with GoalClient(given.domain, given.namespace) as client:
        if message is None:
            stands, words = client.halt()
            command_line.say(words)
            return 0 if stands else 1
        if isinstance(message, PoseStamped | Path) and given.command in ("drive", "route") and given.dry_run:
            return _ask(client, message, given.timeout)
        who, name = GOALS[given.command]
        client.send(who, name, message)
        outcome, reason = client.follow(given.command, given.timeout)
    return _told(outcome, reason)
