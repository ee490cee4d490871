"""The steps of a scenario as the scripted operator carries them out, and the check of a scenario before a run."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from sojourn_config.errors import MISSING, ConfigError, Problem, single
from sojourn_config.paths import available, resolve
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_config.yaml_file import KeyPath
from sojourn_contract.errors import LinkError, UnfitRunError
from sojourn_contract.link_topics import PLACE
from sojourn_contract.linked_table import telemetry
from sojourn_contract.run_table import table_of
from sojourn_contract.topic_table import TopicTable
from sojourn_machine.names import names_text
from sojourn_operator.steps.step import OperatorStep

STATUS = "diagnostic_msgs/DiagnosticArray"
MACHINE_SCENARIO = "flat_drive"
"""Around a machine that is named alone: any rover can drive it."""


@dataclass(frozen=True)
class PreparedScenario:
    """A scenario that has been checked.

    Args:
        name: as the nodes load it: a name in config/scenarios, or an absolute path.
        overrides: KEY=VALUE texts that every node puts over the files. loaded: all of it.
    """

    name: str
    overrides: tuple[str, ...]
    loaded: LoadedScenario


def prepare_scenario(name: str, overrides: Sequence[str] = ()) -> PreparedScenario:
    """Load and check everything that a scenario names. Raises ConfigError with every problem found."""
    loaded = load_scenario(name, overrides)
    try:
        table = table_of(loaded)
    except UnfitRunError as error:
        file = next(iter(loaded.files))
        raise single(file, f"{error.key}: {error.what}", MISSING, f"allowed is {error.allowed}") from error
    except LinkError as error:
        at: KeyPath = ("link", *error.key)
        raise ConfigError([loaded.documents["scenario"].problem(at, error.value, error.allowed)]) from error
    problems = [*_expectation_problems(loaded, table), *_sight_problems(loaded, table)]
    if problems:
        raise ConfigError(problems)
    path = resolve("scenarios", name, ("command line", "scenario"))
    known = name if Path(name).stem == name else str(path.resolve())
    return PreparedScenario(known, tuple(overrides), loaded)


def _expectation_problems(loaded: LoadedScenario, table: TopicTable) -> Iterator[Problem]:
    """A fault is expected to show in a status that the run has."""
    rows = [row for row in table if row.type == STATUS and not row.is_event]
    names = [row.name for row in rows if row.publisher not in absent_roles(loaded)]
    for index, fault in enumerate(loaded.config.faults):
        if fault.expect is not None and fault.expect.topic not in names:
            allowed = f"is no status of this run: {names_text(fault.expect.topic, names)}"
            path: KeyPath = ("faults", index, "expect", "topic")
            yield loaded.documents["scenario"].problem(path, fault.expect.topic, allowed)


def _sight_problems(loaded: LoadedScenario, table: TopicTable) -> Iterator[Problem]:
    """Who looks at the ground from Earth goes by what comes down of where the machine stands."""
    if loaded.link is None or PLACE in [row.name for row, _ in telemetry(table, loaded.link)]:
        return
    for index, (step, _) in enumerate(script_steps(loaded)):
        if step.looks_at_ground:
            allowed = (
                f"looks at the ground, over a link by the {PLACE} that has come down: allowed with it in link.telemetry"
            )
            yield loaded.documents["scenario"].problem(("steps", index), step.describe(), allowed)


def script_steps(scenario: LoadedScenario) -> list[tuple[OperatorStep, float | None]]:
    """Steps of a scenario, each with its limit [s] or None."""
    return [(step.action, step.timeout_s) for step in scenario.config.steps]


def needed_roles(scenario: LoadedScenario) -> tuple[str, ...]:
    """Roles that carry out the steps of a scenario."""
    roles = {step.role for step, _ in script_steps(scenario)}
    return tuple(role for role in ("drive", "arm") if role in roles)


def course_of(rover: str, otherwise: str) -> str:
    """The scenario made for a rover, ROVER_course, if there is one."""
    own = f"{Path(rover).stem}_course"
    return own if own in available("scenarios") else otherwise


def named_scenario(scenario: str | None, machine: str | None, otherwise: str) -> LoadedScenario:
    """The scenario that a command line names, with its machine; where it names neither, another. Raises ConfigError."""
    if machine is None:
        return load_scenario(scenario or otherwise)
    return load_scenario(scenario or course_of(machine, MACHINE_SCENARIO), [f"machine={machine}"])


def absent_roles(scenario: LoadedScenario) -> dict[str, str]:
    """Roles that this machine has no use for, and why."""
    reasons = {}
    if scenario.arm is None:
        reasons["arm"] = "has no arm"
    if scenario.driving is None:
        reasons["drive"] = scenario.machine.why_it_stays.replace(":", ",")
    return reasons
