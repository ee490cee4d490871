"""A run checked, started and told of: the work of scripts/start.py."""

import argparse
import math
import os
from collections.abc import Sequence
from contextlib import nullcontext
from typing import TYPE_CHECKING, Literal

from sojourn_bringup.console_child import ConsoleChild
from sojourn_bringup.ending import last_words
from sojourn_bringup.forked import fork_server_for
from sojourn_bringup.instance import RoleTokens
from sojourn_bringup.outcome import Outcome
from sojourn_bringup.plan import RunPlan, check_lockstep, replacement_of
from sojourn_bringup.process_table import PROCESSES, ROLE_NAMES, check_roles, process
from sojourn_bringup.run_folder import make_run_folder
from sojourn_bringup.screen import Screen, default_screen
from sojourn_bringup.secure import check_secure, make_keystore
from sojourn_config.command_errors import UsageError
from sojourn_config.command_line import ONLY_OWNER
from sojourn_config.expected_light import lies_in_the_dark
from sojourn_config.resolved import resolved_text
from sojourn_config.ros_environment import what_the_network_opens
from sojourn_config.scenario import LoadedScenario, load_scenario
from sojourn_config.shared_memory import remove_tracing_files
from sojourn_contract.run_table import table_of
from sojourn_operator.scenario_steps import absent_roles, needed_roles, prepare_scenario

if TYPE_CHECKING:
    from sojourn_bringup.checkpoints import Resumption


def make_plan(given: argparse.Namespace, screen: Screen) -> RunPlan:
    """Check all that was asked for and make the run's folder. Nothing has started then.

    Raises:
        UsageError, ConfigError: what was asked for cannot be. DomainInUseError: another run has the domain.
    """
    replacements = _commands(given.replace, "--replace")
    shadows = _commands(given.shadow, "--shadow")
    _check_checkpoints(given)
    if given.secure:
        if layout_of(given) != "processes" or given.shadow or given.only or given.console:
            reason = "each role has keys of its own: it goes with all roles as processes here"
            others = "--composed, --direct, --resume, --from, --shadow, --only or --console"
            raise UsageError(f"--secure does not go with {others}: {reason}")
        check_secure()
    resumed = _resumed(given)
    if resumed is None:
        scenario = prepare_scenario(given.scenario, overrides_of(given))
        participants = _participants(given, scenario.loaded, screen)
        if lies_in_the_dark(scenario.loaded):
            config = scenario.loaded.config
            day = f"in the solar day from its start on the Sun does not rise at the site on {config.body}"
            screen.say(f"note: {day}: {config.machine} has what is in its stores")
        if short := scenario.loaded.power.lasting_shortfall():
            screen.say(f"note: {short}")
    else:
        scenario, participants = resumed.scenario, resumed.participants
    started = tuple(role for role in participants if not given.only or role in given.only)
    machine = scenario.loaded.config.machine
    for role, reason in absent_roles(scenario.loaded).items():
        if role in {*given.only, *replacements, *shadows}:
            raise UsageError(f"the machine {machine} {reason}: there is no role {role} in its runs")
    for role in given.only:
        if role in given.without:
            raise UsageError(f"--only and --without both name {role}")
    for role in replacements:
        if role not in started:
            raise UsageError(f"--replace names {role}, which is not started here")
    for role in shadows:
        if not process(role).can_be_shadowed:
            allowed = ", ".join(row.role for row in PROCESSES if row.can_be_shadowed)
            raise UsageError(f"--shadow names {role}, allowed is one of {allowed}")
        if role not in participants:
            raise UsageError(f"--shadow names {role}, which does not take part: there is nothing to compare with")
    layout = layout_of(given)
    if layout != "processes" and (replacements or shadows or len(started) < len(participants)):
        option = f"--{layout}"
        raise UsageError(f"{option} runs every role in one process: it does not go with --replace, --shadow or --only")
    if resumed is not None:
        from sojourn_bringup.checkpoints import what_keeps_from_resuming  # not above: it needs all roles

        if reason := what_keeps_from_resuming(resumed.state, replacements):
            raise UsageError(f"{given.resume or given.from_bag}: {reason}")
    if given.console and layout == "direct":
        raise UsageError(
            "--console listens to topics, and a run without middleware has none: not with --direct, --resume, --from"
        )
    if given.direct and given.realtime:
        raise UsageError("--direct runs as fast as it can: it does not go with --realtime")
    if "plant" not in participants:
        raise UsageError("nothing moves without plant: to start it elsewhere, name here what to start with --only")
    if given.realtime and scenario.loaded.leaps is not None:
        raise UsageError(
            f"--realtime goes by the wall's clock, and that of {scenario.name} leaps: put leaps=null over it"
        )
    if not given.realtime:
        check_lockstep(participants, table_of(scenario.loaded))
    # before a folder is made for a run that cannot be
    with nullcontext() if layout == "direct" else RoleTokens(given.domain, given.namespace, started):
        run_dir = make_run_folder(given.run_dir)
    return RunPlan(
        scenario=scenario.name,
        overrides=scenario.overrides,
        run_dir=run_dir,
        participants=participants,
        started=started,
        replacements=replacements,
        shadows=shadows,
        realtime=given.realtime,
        domain=given.domain,
        namespace=given.namespace,
        on_network=given.network,
        lockstep_timeout_s=given.lockstep_timeout,
        start_timeout_s=given.start_timeout,
        loaded=scenario.loaded,
        begin=None if resumed is None else resumed.state,
        checkpoint_every_s=given.checkpoint_every,
        secure=given.secure,
    )


def _resumed(given: argparse.Namespace) -> "Resumption | None":
    """The run that is to go on, None where one is to begin. Raises UsageError, ConfigError."""
    if not _goes_on(given):
        return None
    from sojourn_bringup.checkpoints import last_before, resume  # not above: it needs all roles, which start elsewhere

    file = given.resume or last_before(given.from_bag, math.inf if given.at is None else given.at)
    return resume(file, overrides_of(given))


def _goes_on(given: argparse.Namespace) -> bool:
    """Whether a run goes on, in place of one that begins."""
    return given.resume is not None or given.from_bag is not None


def _check_checkpoints(given: argparse.Namespace) -> None:
    """Raise UsageError for options that do not go together."""
    if given.checkpoint_every is not None:
        if given.realtime:
            reason = "in real time no two nodes stand at the same period: there is no state to go on from"
            raise UsageError(f"--checkpoint-every does not go with --realtime: {reason}")
        _refuse(given, "--checkpoint-every", ("only", "shadow", "secure"), "every node is to hand over its state")
    if _goes_on(given):
        option = "--resume" if given.resume is not None else "--from"
        reason = "a checkpoint goes on in lock-step, with the machine and the roles that it has"
        _refuse(given, option, ("realtime", "without", "only", "shadow", "machine", "secure"), reason)


def _refuse(given: argparse.Namespace, option: str, others: Sequence[str], reason: str) -> None:
    """Raise UsageError if some of the other options are given too."""
    wrong = [f"--{name}" for name in others if getattr(given, name)]
    if wrong:
        raise UsageError(f"{option} does not go with {' and '.join(wrong)}: {reason}")


def overrides_of(given: argparse.Namespace) -> list[str]:
    """All that goes over the files, as KEY=VALUE."""
    chosen = {key: getattr(given, key) for key in ("machine", "seed")}
    return [*given.set, *(f"{key}={value}" for key, value in chosen.items() if value is not None)]


def _commands(texts: Sequence[str], option: str) -> dict[str, str]:
    """Command by role. Raises UsageError for an unknown role, for no command, and for a role named twice."""
    found: dict[str, str] = {}
    for text in texts:
        role, command = replacement_of(text, option)
        check_roles((role,), option)
        if role in found:
            raise UsageError(f"{option} names {role} twice: {found[role]} and {command}")
        found[role] = command
    return found


def _participants(given: argparse.Namespace, scenario: LoadedScenario, screen: Screen) -> tuple[str, ...]:
    """Roles that take part: all but those left out, and no scripted operator where it could not do its steps."""
    without = {*given.without, *absent_roles(scenario)}
    if "operator" not in without:
        needed = needed_roles(scenario)
        lacking = [role for role in needed if role in without]
        if not scenario.config.steps and scenario.link is None and not scenario.config.faults:
            alone = (
                f"without middleware nobody is heard, it ends at its limit of {scenario.config.duration_limit_s:g} s"
            )
            goals = alone if layout_of(given) == "direct" else "send goals with scripts/goal, end with Ctrl-C"
            screen.say(f"the scenario has no steps: {goals}")
            without.add("operator")
        elif lacking:
            screen.say(f"the operator is left out too: its steps need {' and '.join(lacking)}")
            without.add("operator")
    if "operator" in without and scenario.link is not None:
        raise UsageError("the link to Earth is carried by the role operator, left out here: put link=null over it")
    if "operator" in without and scenario.config.faults:
        raise UsageError("the faults are sent by the role operator, left out here: put faults=[] over them")
    return tuple(role for role in ROLE_NAMES if role not in without)


Layout = Literal["processes", "composed", "direct"]
"""The three ways to run one graph."""


def layout_of(given: argparse.Namespace) -> Layout:
    """Which way was asked for."""
    if given.composed:
        return "composed"
    return "direct" if given.direct or (_goes_on(given) and not given.processes) else "processes"


def run_plan(plan: RunPlan, layout: Layout, screen: Screen, with_console: bool = False) -> Outcome:
    """Run to the end, in one process or in many; nothing is left behind. with_console: beside it."""
    # here and not above, because the libraries read the environment when they are loaded
    try:
        if layout == "direct":  # it meets nobody on any domain
            from sojourn_bringup.direct import DirectRun

            with screen:
                return DirectRun(plan, screen).run()
        console = ConsoleChild(plan, screen) if with_console else nullcontext()
        # first of all: it is a copy of this process, and is to hold nothing of what is opened here
        copies = fork_server_for(plan) if layout == "processes" else nullcontext()
        with copies as server, RoleTokens(plan.domain, plan.namespace, plan.started), screen, console:
            if layout == "composed":
                from sojourn_bringup.composed import ComposedRun

                return ComposedRun(plan, screen).run()
            from sojourn_bringup.supervisor import Supervisor

            security = make_keystore(plan, table_of(plan.loaded)) if plan.secure and plan.loaded is not None else {}
            return Supervisor(plan, screen, server, security).run()
    finally:
        remove_tracing_files()


def run(given: argparse.Namespace) -> int:
    """Start a run and return its status: 0 done, 1 failed, 2 bad usage or configuration, 130 interrupted."""
    if given.resolved:
        resumed = _resumed(given)
        loaded = load_scenario(given.scenario, overrides_of(given)) if resumed is None else resumed.scenario.loaded
        print(resolved_text(loaded.documents), end="")
        return 0
    os.umask(ONLY_OWNER)
    screen = default_screen()
    plan = make_plan(given, screen)
    screen.say(f"run {plan.run_dir}, domain {plan.domain}{', namespace ' + plan.namespace if plan.namespace else ''}")
    if plan.on_network and not plan.secure:
        screen.say(what_the_network_opens(plan.domain))
    outcome = run_plan(plan, layout_of(given), screen, given.console)
    for line in last_words(plan, outcome):
        screen.say(line)
    return outcome.status
