"""scripts/replay: what cannot be replayed is said in one sentence before anything starts."""

from pathlib import Path

import pytest

from sojourn_bringup.replay import main
from sojourn_config.command_errors import UsageError

BAG = str(Path(__file__).parents[1] / "replay" / "short_goals")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("/nowhere", "--node", "drive"), "/nowhere cannot be read as a bag"),
        ((__file__, "--node", "drive"), "cannot be read as a bag: it is no MCAP file"),
        ((BAG, "--node", "camera"), "role 'camera' is unknown, allowed is one of plant, sensors, drive, arm, power"),
        ((BAG, "--exec", "true", "--role", "recorder"), "--role: role 'recorder' is unknown"),
        ((BAG, "--exec", "true"), "--exec needs --role"),
        ((BAG,), "give either --node ROLE or --exec COMMAND --role ROLE"),
        ((BAG, "--node", "drive", "--exec", "true", "--role", "drive"), "give either --node ROLE or --exec COMMAND"),
        ((BAG, "--exec", "a 'b", "--role", "drive"), "the command cannot be read"),
    ],
)
def test_bad_usage_is_one_sentence(arguments: tuple[str, ...], words: str) -> None:
    with pytest.raises(UsageError, match=words) as caught:
        main(arguments)
    assert "\n" not in str(caught.value)
