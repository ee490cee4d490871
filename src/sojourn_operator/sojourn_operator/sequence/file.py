"""The file of a sequence: the steps of a scenario, each with what it waits for and what its failure means.

description: Drive to the rock and look
steps:
  - drive_to: {x: 2.0, y: 0.5}
    timeout_s: 200.0
  - arm_joints: {name: unfold}
    when: /battery_state.percentage > 0.4 and /drive/status.state == reached
    after_s: 5.0
    on_failure: skip
  - hold: true                     # until an operator says resume
    wait_s: 0.0
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import yaml
from pydantic import Field

from sojourn_config.errors import MISSING, ConfigError, Problem
from sojourn_config.extends import read_document
from sojourn_config.load import validate
from sojourn_config.scenario import LoadedScenario
from sojourn_config.scenario_checks import scenario_problems
from sojourn_config.steps import LONGEST, StepConfig
from sojourn_config.yaml_file import YamlDocument
from sojourn_contract.errors import UnknownFieldNameError
from sojourn_contract.topic_table import TopicTable
from sojourn_machine.params import Params
from sojourn_operator.sequence.condition import conditions

OWN = ("when", "after_s", "within_s", "hold", "on_failure")
"""Words of a step that a scenario's has not."""


class SequenceStep(StepConfig):
    """One step: that of a scenario, and these."""

    when: str | None = Field(default=None, min_length=1, description="comparisons that have to hold before it begins")
    after_s: float = Field(default=0.0, ge=0.0, le=LONGEST, description="so long after the step before it ended [s]")
    within_s: float | None = Field(
        default=None,
        gt=0.0,
        le=LONGEST,
        description="it has failed if it could not begin in this time; none: it waits [s]",
    )
    hold: bool = Field(default=False, description="it waits until an operator says resume")
    on_failure: Literal["hold", "skip", "abort"] = Field(
        default="hold",
        description="wait for an operator before the next step, go on with it, or stop the machine and end",
    )


class SequenceConfig(Params):
    """A sequence."""

    description: str = Field(default="", description="what it does, in one sentence")
    steps: tuple[SequenceStep, ...] = Field(min_length=1, max_length=10000, description="in order")


def read_sequence(file: Path, scenario: LoadedScenario, table: TopicTable) -> SequenceConfig:
    """The sequence of a file, checked against a machine, its ground and the topics of the run.

    Raises:
        ConfigError: with every problem of it: words, roles, places, fields.
    """
    return checked_sequence(read_document(file, "scenarios"), scenario, table)


def checked_sequence(document: YamlDocument, scenario: LoadedScenario, table: TopicTable) -> SequenceConfig:
    """As `read_sequence`, of a document that has been read."""
    config = validate(document, SequenceConfig)
    as_scenario = scenario.config.model_copy(update={"steps": config.steps})
    problems = [*_condition_problems(config, table, document), *scenario_problems(as_scenario, scenario, document)]
    if problems:
        raise ConfigError(problems)
    return config


def scenario_text(config: SequenceConfig) -> str:
    """The steps as a scenario has them: what they wait for is left out."""
    steps = [{key: value for key, value in _plain(step).items() if key not in OWN} for step in config.steps]
    return yaml.safe_dump({"steps": steps}, sort_keys=False)


def sequence_text(scenario: LoadedScenario) -> str:
    """The steps of a scenario as a sequence, which stops the machine where a step fails, as the scenario ends there."""
    steps = [{**_plain(step), "on_failure": "abort"} for step in scenario.config.steps]
    return yaml.safe_dump({"description": scenario.config.description, "steps": steps}, sort_keys=False)


def _plain(step: StepConfig) -> dict[str, Any]:
    """As a file has it, without what is left out."""
    data: dict[str, Any] = step.model_dump(mode="json", exclude_none=True)
    kind = data.pop(step.kind)
    words = {key: value for key, value in kind.items() if value is not None} if isinstance(kind, dict) else kind
    return {step.kind: words, **data}


def _condition_problems(config: SequenceConfig, table: TopicTable, document: YamlDocument) -> Iterator[Problem]:
    for index, step in enumerate(config.steps):
        if step.when is None:
            continue
        try:
            conditions(step.when, table)
        except UnknownFieldNameError as error:
            yield document.problem(("steps", index, "when"), MISSING, str(error))
