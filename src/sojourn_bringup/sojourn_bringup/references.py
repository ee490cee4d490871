"""The reference bags: which there are, and how each is recorded."""

from dataclasses import dataclass
from pathlib import Path

from sojourn_config.paths import repository_root


@dataclass(frozen=True)
class ReferenceBag:
    """A reference bag.

    Args:
        name: of its scenario in test/replay, and of its folder there. overrides: KEY=VALUE texts over it.
        outcomes: how its steps must end.
    """

    name: str
    overrides: tuple[str, ...]
    outcomes: tuple[str, ...]


REFERENCES = (
    ReferenceBag(
        "short_goals",
        # a load is shed in the middle of the run, and the drive's power is limited
        (
            "power_manager.shed_soc_first=0.2562",
            "power_manager.derate_start_voltage=27.95",
            "power_manager.derate_stop_voltage=26.0",
        ),
        ("reached", "reached", "refused"),
    ),
)


def references_folder() -> Path:
    """Where they stand."""
    return repository_root() / "test" / "replay"


def default_reference() -> Path:
    """The bag that is played to a candidate where no other is named."""
    return references_folder() / REFERENCES[0].name
