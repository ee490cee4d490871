"""Replays one role of a bag: the candidate hears what the run's node heard, and its answers are compared.

with run_configuration(bag) as configuration:
    result = replay(bag, "drive", NodeCandidate(DriveNode), configuration, ReplaySettings(domain=7))
result.comparison.verdict, result.answers["/odom"]
"""

from collections.abc import Mapping
from dataclasses import dataclass

from sojourn_bags.candidate import Candidate
from sojourn_bags.comparison import compare, stamps_of
from sojourn_bags.comparison_result import Comparison
from sojourn_bags.messages import Messages
from sojourn_bags.reading import Bag
from sojourn_bags.replay_choices import PREFIX
from sojourn_bags.replay_harness import Listener, ReplayHarness, ReplaySettings
from sojourn_bags.replay_script import ReplayScript, script_of
from sojourn_bags.run_configuration import RunConfiguration


@dataclass(frozen=True)
class Replay:
    """What came of a replay.

    Args:
        script: what was played. answers: what the candidate said, by topic. comparison: of the recorded answers with
            these.
    """

    script: ReplayScript
    answers: Mapping[str, Messages]
    comparison: Comparison


def replay(
    bag: Bag,
    role: str,
    candidate: Candidate,
    configuration: RunConfiguration,
    settings: ReplaySettings,
    listener: Listener | None = None,
) -> Replay:
    """Replay a bag through a candidate.

    Args:
        role: whom it stands in for. settings: where, and how long to wait. listener: gets all that is said.

    Raises:
        ReplayError: the bag cannot be replayed through this role. UnansweredError: the candidate does not answer.
        OtherContractError, IncompleteConfigError: of the bag.
    """
    script = script_of(bag, role)
    answers = play(script, candidate, configuration, settings, listener)
    if script.cut_off:
        answers = {name: _up_to(messages, script.end) for name, messages in answers.items()}
    return Replay(script, answers, compare(script.recorded, answers))


def play(
    script: ReplayScript,
    candidate: Candidate,
    configuration: RunConfiguration,
    settings: ReplaySettings,
    listener: Listener | None = None,
) -> dict[str, Messages]:
    """Play a script to a candidate and return its answers by topic, uncompared; arguments and errors as of `replay`."""
    with ReplayHarness(script, settings, listener) as harness:
        return harness.run(candidate, configuration.parameters(script.participants, settings.timeout_s))


def _up_to(messages: Messages, end: int) -> Messages:
    """Messages stamped `end` [ns] or earlier: what follows, the bag does not know."""
    chosen = [index for index, stamp in enumerate(stamps_of(messages)) if stamp <= end]
    return Messages(
        messages.topic,
        messages.type,
        [messages.log_times[index] for index in chosen],
        [messages.data[index] for index in chosen],
    )


__all__ = ["PREFIX", "Replay", "play", "replay"]
