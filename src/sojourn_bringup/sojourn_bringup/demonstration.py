"""A run under a progress bar, and its verdict in words, numbers and a picture: the work of scripts/demo."""

import argparse
import os
import shlex
from collections.abc import Sequence

from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar

from sojourn_bringup import start, start_run
from sojourn_bringup.demo import DEFAULT_SCENARIO, MACHINE_SCENARIO
from sojourn_bringup.health import Health, Progress
from sojourn_bringup.outcome import FAILED, INTERRUPTED, SUCCEEDED, Outcome
from sojourn_bringup.plan import RunPlan
from sojourn_bringup.screen import PlainScreen, Screen
from sojourn_config.command_errors import CommandError
from sojourn_config.command_line import ONLY_OWNER
from sojourn_operator.scenario_steps import course_of


class BarScreen(Screen):
    """A progress bar over the steps of the operator, with simulation time, speed and distance to go.

    Within a drive the bar moves on with the distance.
    """

    def __init__(self, console: Console | None = None) -> None:
        super().__init__(console)
        self._bar = Bar(
            BarColumn(bar_width=20),
            TextColumn("{task.fields[steps]}"),
            TimeElapsedColumn(),
            TextColumn("{task.description}"),
            TextColumn("{task.fields[where]}"),
            console=self.console,
        )
        self._task = self._bar.add_task("starting", total=1, where="", steps="")
        self._farthest = (0, 0.0)
        """Step, and the largest distance to go seen in it [m]."""

    def show(self, nodes: Sequence[Health], progress: Progress) -> None:
        """Draw the bar again."""
        where = f"{progress.time_s:.0f} s simulated, {progress.speed:.1f}x" if progress.speed else ""
        if progress.to_go_m is not None:
            where += f", {progress.to_go_m:.1f} m to go"
        words = (progress.step.partition(": ")[2] or progress.step) if progress.stamp else "starting"
        self._bar.update(
            self._task,
            completed=progress.steps_done + self._part_of_step(progress),
            total=max(progress.steps, 1),
            description=words,
            where=where,
            steps=f"{progress.steps_done} of {progress.steps} steps" if progress.steps else "",
        )

    def _part_of_step(self, progress: Progress) -> float:
        """How much of the present step is done, 0 to 1, as far as the drive tells."""
        if progress.to_go_m is None:
            return 0.0
        step, farthest = self._farthest
        farthest = max(farthest, progress.to_go_m) if step == progress.steps_done else progress.to_go_m
        self._farthest = (progress.steps_done, farthest)
        return 1.0 - progress.to_go_m / farthest if farthest else 0.0

    def __enter__(self) -> "BarScreen":
        self._bar.start()
        return self

    def __exit__(self, *_error: object) -> None:
        self._bar.stop()


def scenario_of(scenario: str | None, machine: str | None) -> str:
    """The scenario that was named, or that which shows a machine, or the default."""
    if scenario is not None or machine is None:
        return scenario or DEFAULT_SCENARIO
    return course_of(machine, MACHINE_SCENARIO)


def start_arguments(given: argparse.Namespace) -> list[str]:
    """The same wishes as options of scripts/start.py."""
    arguments = [
        scenario_of(given.scenario, given.machine),
        "--domain",
        str(given.domain),
        "--namespace",
        given.namespace,
        "--lockstep-timeout",
        str(given.lockstep_timeout),
        "--start-timeout",
        str(given.start_timeout),
    ]
    for name in ("machine", "seed", "run_dir"):
        value = getattr(given, name)
        if value is not None:
            arguments += [f"--{name.replace('_', '-')}", value]
    for text in given.set:
        arguments += ["--set", text]
    arguments += ["--console"] if given.console else []
    return [*arguments, "--direct"] if given.direct else arguments


def evaluate(plan: RunPlan, outcome: Outcome, screen: Screen) -> bool:
    """Write summary.json and report.png into the run's folder and print the verdict.

    Returns whether all goals were met and the record is complete. Raises CommandError if the bag cannot be judged.
    """
    # here and not above: with its plots it takes a second to load, and nobody waits for it at the end
    from sojourn_bags.errors import BagsError

    try:
        return _judge(plan, outcome, screen)
    except BagsError as error:
        raise CommandError(str(error)) from error


def _judge(plan: RunPlan, outcome: Outcome, screen: Screen) -> bool:
    from sojourn_bags.reading import read_bag
    from sojourn_bags.report import write_report
    from sojourn_bags.summary import goal_lines, summarise, write_summary

    bag = read_bag(plan.bag())
    summary = summarise(bag, wall_time_s=outcome.wall_time_s or None)
    write_summary(summary, plan.run_dir / "summary.json")
    write_report(bag, plan.run_dir / "report.png", summary=summary)
    screen.say(str(summary["verdict"]))
    for line in goal_lines(summary):
        screen.say(line)
    factor = summary["real_time_factor"]
    speed = f", {factor:.1f} times real time" if factor else ""
    screen.say(f"{summary['sim_time_s']:.0f} s simulated in {outcome.wall_time_s:.0f} s{speed}")
    screen.say(f"bag, summary.json and report.png are in {plan.run_dir}")
    if plan.loaded is not None and plan.loaded.config.activities:
        changed = "".join(f" --set {shlex.quote(text)}" for text in plan.overrides)
        screen.say(f"what is planned for the days around it: scripts/power_plan {plan.scenario}{changed}")
    return bool(summary["all_met"] and summary["complete"])


def run(given: argparse.Namespace) -> int:
    """Run the demonstration; 0 only if every goal was met and the record is complete."""
    os.umask(ONLY_OWNER)
    console = Console(highlight=False, soft_wrap=True)
    screen = BarScreen(console) if console.is_terminal else PlainScreen(console)
    plan = start_run.make_plan(start.parser("demo").parse_args(start_arguments(given)), screen)
    layout: start_run.Layout = "direct" if given.direct else "processes" if given.processes else "composed"
    outcome = start_run.run_plan(plan, layout, screen, given.console)
    if outcome.status != SUCCEEDED:
        screen.say(outcome.message)
    if outcome.status == INTERRUPTED or not plan.bag().exists():
        return outcome.status
    met = evaluate(plan, outcome, screen)
    return SUCCEEDED if met and outcome.status == SUCCEEDED else FAILED
