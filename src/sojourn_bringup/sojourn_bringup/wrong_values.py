"""Values with which no role starts, and the words that say so: what no recorded run can show, for none begins.

They stand in test/replay/wrong_values.yaml: a scenario, KEY=VALUE texts over it, and what must be said of them, each a
part of the refusal. Several values of one start are several problems of it, told all at once.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import yaml

from sojourn_bringup.references import references_folder
from sojourn_config.errors import ConfigError
from sojourn_config.scenario import load_scenario
from sojourn_machine.errors import MachineError
from sojourn_operator.scenario_steps import absent_roles
from sojourn_stack.apps import APPS


@dataclass(frozen=True)
class WrongValues:
    """A start that must be refused.

    Args:
        scenario: by its name. values: KEY=VALUE texts over it. says: parts of the refusal.
    """

    scenario: str
    values: tuple[str, ...]
    says: tuple[str, ...]

    @property
    def name(self) -> str:
        """By which it is told."""
        return f"{self.scenario} with {', '.join(self.values)}"


def wrong_values() -> Iterator[WrongValues]:
    """All of them. Raises OSError, and KeyError for one that lacks a word."""
    text = (references_folder() / "wrong_values.yaml").read_text(encoding="utf-8")
    for row in yaml.safe_load(text):
        yield WrongValues(row["scenario"], tuple(row["set"]), tuple(row["says"]))


def refusal(wrong: WrongValues, roles: Sequence[str]) -> str:
    """What roles answer that are made of such values, as their nodes make them; empty where none refuses them."""
    try:
        scenario = load_scenario(wrong.scenario, wrong.values)
        for role in set(roles) - absent_roles(scenario).keys():
            APPS[role].of(scenario)
    except (ConfigError, MachineError) as error:
        return str(error)
    return ""


def not_refused(roles: Sequence[str]) -> list[str]:
    """Which of the wrong values roles take, or refuse in other words."""
    answers = ((wrong, refusal(wrong, roles)) for wrong in wrong_values())
    return [
        f"{wrong.name}: refused with {answer!r}, not {part!r}" if answer else f"{wrong.name}: not refused"
        for wrong, answer in answers
        for part in wrong.says
        if part not in answer
    ]
